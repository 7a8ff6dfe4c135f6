"""Meshes of ../street.json, and its lamps, which it writes into that file: python3 make_street.py (needs numpy)."""

import json
from pathlib import Path

import numpy as np

from mesh import Mesh, about

HERE = Path(__file__).parent
SCENE = HERE.parent / "street.json"
RANDOM = np.random.default_rng(7)
LAMPS, APART, FIRST = 10, 11.0, -4.0
"""Lamps on each side, the way between them along -z, and where the first ones stand (m)."""
KERB, FRONT, PAVED = 3.6, 6.6, 0.14
"""Half the width of the road, of the street between its fronts, and how high the pavement is (m)."""


def bend(z):
    """How far the street has turned to the left, by z (m)."""
    return -0.0016 * np.minimum(z + 8, 0) ** 2


def at(x, y, z):
    """A point of the straight street in the one that bends."""
    return np.array([x + bend(z), y, z])


def facade(mesh, lit, dark, side, z0, z1, height, floors):
    """The front of a house between z1 and z0, its windows set back: some lit, most dark."""
    x, deep = side * FRONT, side * 0.16
    count = max(2, round((z0 - z1) / 2.1))
    zs = np.linspace(z0, z1, 2 * count + 1)
    storey = height / floors
    for floor in range(floors):
        low, sill, head, high = floor * storey, (floor + 0.32) * storey, (floor + 0.8) * storey, (floor + 1) * storey
        for y0, y1 in ((low, sill), (head, high)):
            panel(mesh, side, x, z0, z1, y0, y1)
        for i in range(2 * count):
            a, b = zs[i], zs[i + 1]
            if i % 2 == 0:
                panel(mesh, side, x, a, b, sill, head)
                continue
            glass = lit if RANDOM.random() < 0.3 else dark
            panel(glass, side, x + deep, a, b, sill, head)
            for y, flip in ((sill, 1), (head, -1)):
                ledge = [at(x, y, a), at(x, y, b), at(x + deep, y, b), at(x + deep, y, a)]
                mesh.face(*ledge[:: flip * side])
            for z in (a, b):
                mesh.face(at(x, sill, z), at(x + deep, sill, z), at(x + deep, head, z), at(x, head, z))
        for z in zs[1::2]:
            cross(mesh, side, x + 0.6 * deep, (z + zs[list(zs).index(z) + 1]) / 2, sill, head)


def panel(mesh, side, x, z0, z1, y0, y1):
    """A rectangle along the street, facing its middle."""
    mesh.face(*[at(x, y0, z0), at(x, y0, z1), at(x, y1, z1), at(x, y1, z0)][::-side])


def cross(mesh, side, x, z, sill, head):
    """The bars of a window."""
    mesh.box(at(x, sill, z) - (0.03, 0, 0.03), at(x, head, z) + (0.03, 0, 0.03), without="yY")
    y = sill + 0.66 * (head - sill)
    mesh.box(at(x, y, z) - (0.03, 0.03, 0.5), at(x, y, z) + (0.03, 0.03, 0.5), without="zZ")


def houses():
    """Rows of houses of different widths and heights on both sides, their roofs and chimneys."""
    walls, roofs, lit, dark = Mesh(), Mesh(), Mesh(), Mesh()
    for side in (-1, 1):
        z = 10.0 + (side > 0) * 3
        while z > -125:
            width, floors = RANDOM.uniform(6, 11), RANDOM.integers(2, 5)
            height = 3.1 * floors + RANDOM.uniform(-0.2, 0.5)
            facade(walls, lit, dark, side, z, z - width, height, floors)
            roof(walls, roofs, side, z, z - width, height, RANDOM.uniform(2.2, 3.6))
            z -= width
    return walls, roofs, lit, dark


def roof(walls, roofs, side, z0, z1, eaves, rise):
    """A ridge along the street, the walls below its ends, and a chimney."""
    front, ridge, back = side * (FRONT - 0.35), side * (FRONT + 4), side * (FRONT + 8)
    roofs.face(*[at(front, eaves - 0.2, z0), at(front, eaves - 0.2, z1), at(ridge, eaves + rise, z1), at(ridge, eaves + rise, z0)][::side])
    roofs.face(*[at(ridge, eaves + rise, z0), at(ridge, eaves + rise, z1), at(back, eaves, z1), at(back, eaves, z0)][::side])
    roofs.face(*[at(front, eaves - 0.2, z1), at(front, eaves - 0.2, z0), at(side * FRONT, eaves, z0), at(side * FRONT, eaves, z1)][::side])
    for z in (z0, z1):
        walls.face(at(side * FRONT, 0, z), at(back, 0, z), at(back, eaves, z), at(ridge, eaves + rise, z), at(side * FRONT, eaves, z))
    middle = at(side * (FRONT + 2.8), eaves + 0.8 * rise, z1 + 1.2)
    walls.box(middle - (0.35, 1.2, 0.5), middle + (0.35, 1.1, 0.5), without="y")


def strip(half, x_edges, heights):
    """A surface along the whole street, across it through points (x, height)."""
    zs = np.linspace(14, -130, 97)
    return Mesh().grid([[at(x, y, z) for x, y in zip(x_edges, heights)] for z in zs[::-1]][:: -1 if half < 0 else 1])


def lamp():
    """An iron post of 4.2 m with a lantern's frame and hat; its light is at a height of 4.45 m."""
    mesh = Mesh()
    mesh.lathe([(0.17, 0), (0.17, 0.12), (0.11, 0.25), (0.11, 0.7), (0.06, 0.95), (0.045, 4.0), (0.09, 4.06), (0.09, 4.12), (0.02, 4.16), (0.14, 4.2), (0.0, 4.2)], sides=14)
    for turn in range(4):
        way = about((0, 1, 0), 90 * turn + 45)
        mesh.tube([way @ np.array([0.15, 4.2, 0]), way @ np.array([0.23, 4.72, 0])], 0.012, 4)
    mesh.lathe([(0.26, 4.72), (0.27, 4.74), (0.1, 4.92), (0.03, 4.96), (0.03, 5.04), (0.0, 5.06)], sides=4)
    return mesh.tube([(-0.35, 3.75, 0), (0.35, 3.75, 0)], 0.02, 6, caps=True)


def stroller():
    """A walker in a long coat and a hat under an umbrella, seen from behind, 1.8 m tall."""
    mesh = Mesh()
    mesh.lathe([(0.30, 0.42), (0.27, 0.7), (0.21, 1.05), (0.24, 1.3), (0.21, 1.42), (0.09, 1.5), (0.07, 1.55)], sides=20)
    mesh.lathe([(0.0, 1.5), (0.085, 1.56), (0.1, 1.66), (0.085, 1.76), (0.0, 1.79)], sides=16)
    mesh.lathe([(0.19, 1.70), (0.19, 1.715), (0.115, 1.73), (0.105, 1.84), (0.0, 1.85)], sides=20)
    for x, z in ((-0.1, 0.16), (0.1, -0.14)):
        mesh.tube([(x, 0.05, z), (x * 0.9, 0.5, 0)], 0.075, 9, caps=True)
        mesh.box((x - 0.055, 0, z - 0.17), (x + 0.055, 0.1, z + 0.09))
    mesh.tube([(0.22, 1.38, 0), (0.36, 1.1, -0.06), (0.3, 1.2, -0.24)], [0.075, 0.065, 0.05], 9, caps=True)
    mesh.tube([(-0.22, 1.38, 0), (-0.31, 1.05, 0.02), (-0.3, 0.78, -0.05)], [0.075, 0.065, 0.05], 9, caps=True)
    mesh.tube([(0.29, 1.12, -0.25), (0.22, 2.2, -0.12)], 0.012, 5)
    dome = [(0.62 * np.cos(a), 1.98 + 0.3 * np.sin(a)) for a in np.linspace(0, np.pi / 2, 7)]
    return mesh.lathe(dome, at=(0.22, -0.03, -0.12), sides=8)


def lights():
    """Posts and their lights on both kerbs, by name."""
    named = {}
    for i in range(LAMPS):
        for name, side in (("left", -1), ("right", 1)):
            place = at(side * (KERB + 0.45), PAVED, FIRST - APART * (i + 0.5 * (side > 0)))
            steps = [{"type": "translate", "value": [round(float(v), 3) for v in place]}]
            named[f"post_{name}_{i}"] = {"type": "instance", "of": {"type": "ref", "id": "lamp"}, "to_world": steps}
            light = {"type": "area", "radiance": {"type": "rgb", "value": ["$red", "$green", "$blue"]}}
            centre = [round(float(v), 3) for v in place + (0, 4.45, 0)]
            named[f"light_{name}_{i}"] = {"type": "sphere", "radius": 0.11, "center": centre, "emitter": light}
    return named


def rewrite():
    """Puts the lamps into the scene, in place of those that it had."""
    scene = {name: value for name, value in json.loads(SCENE.read_text()).items() if not name.startswith(("post_", "light_"))}
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in {**scene, **lights()}.items()]
    SCENE.write_text("{" + ",\n ".join(lines) + "}\n")


if __name__ == "__main__":
    walls, roofs, lit, dark = houses()
    meshes = dict(walls=walls, roofs=roofs, lit=lit, dark=dark, lamp=lamp(), stroller=stroller())
    meshes["road"] = strip(1, np.linspace(-KERB, KERB, 9), 0.06 * (1 - np.linspace(-1, 1, 9) ** 2))
    meshes["pavement"] = Mesh()
    for side in (-1, 1):
        edges = sorted((side * KERB, side * (KERB + 1e-3), side * FRONT))
        heights = [0.0, PAVED, PAVED] if side > 0 else [PAVED, PAVED, 0.0]
        strip_mesh = strip(1, edges, heights)
        meshes["pavement"].add(strip_mesh.points[0], strip_mesh.faces[0])
    for name, mesh in meshes.items():
        mesh.write(HERE / f"street_{name}.ply")
    rewrite()
