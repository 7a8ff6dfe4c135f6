"""Writes the meshes of countryside.json beside itself: python3 make_countryside.py (needs numpy)."""

from pathlib import Path

import numpy as np

from mesh import Mesh, about

HERE = Path(__file__).parent
RANDOM = np.random.default_rng(5)


def river(z):
    """Where the middle of the river is, by z."""
    return 2.2 * np.sin(z / 11) + 0.02 * z


def ground(x, z):
    """Height of the land: meadows, hills far off, the bed of the river."""
    bank = np.abs(x - river(z))
    hills = 7 * np.exp(-(((z + 70) / 26) ** 2)) * (1 + 0.5 * np.sin(x / 17 + 1))
    hills += 3.5 * np.exp(-(((x - 42) / 16) ** 2)) + 4 * np.exp(-(((x + 44) / 15) ** 2))
    rough = 0.35 * np.sin(x / 4.1 + 1) * np.cos(z / 5.3) + 0.15 * np.sin(x / 1.7 + z / 2.3)
    meadow = np.clip((bank - 4.5) / 8, 0, 1) * (0.5 + rough) + hills
    ramp = 1.15 * np.exp(-(((z + 6) / 2.4) ** 4)) * np.clip((np.abs(x + 1.6) - 6.5) / 2.5, 0, 1) * np.exp(-(((x + 1.6) / 22) ** 4))
    return np.maximum(meadow, ramp * np.clip((bank - 5) / 1.5, 0, 1)) - 1.7 * np.clip((5.2 - bank) / 2.6, 0, 1)


def land():
    """A grid, finer near the river."""
    xs = np.concatenate([np.linspace(-60, -12, 14)[:-1], np.linspace(-12, 12, 45), np.linspace(12, 60, 14)[1:]])
    zs = np.concatenate([np.linspace(22, -30, 44)[:-1], np.linspace(-30, -90, 20)])
    z, x = np.meshgrid(zs, xs, indexing="ij")
    return Mesh().grid(np.stack([x, ground(x, z), z], -1)[::-1])


SPANS = [(-4.6, 1.55, 0.6), (0.0, 2.3, 1.15), (4.6, 1.55, 0.6)]  # of the bridge: middle, half width, rise


def deck(x):
    """Height of the road on the bridge."""
    return 1.05 + 1.15 * np.exp(-((x / 5.5) ** 2))


def underneath(x):
    """Height of the arch above x, or of the ground of a pier."""
    for middle, half, rise in SPANS:
        if abs(x - middle) < half:
            return -0.45 + (rise + 0.45) * np.sqrt(1 - ((x - middle) / half) ** 2)
    return -1.8


def bridge():
    """Three arches, a humped road, parapets; its road leads along x."""
    mesh, half = Mesh(), 1.5
    edges = [m + h * np.cos(t) for m, h, _ in SPANS for t in np.linspace(0, np.pi, 17)]
    xs = np.unique(np.round(np.concatenate([np.linspace(-11, 11, 45), edges]), 4))
    for a, b in zip(xs, xs[1:]):
        low = [underneath(a + 1e-4), underneath(b - 1e-4)]
        top = [deck(a) + 0.75, deck(b) + 0.75]
        for z, flip in ((half, 1), (-half, -1)):
            quad = [(a, low[0], z), (b, low[1], z), (b, top[1], z), (a, top[0], z)]
            mesh.face(*quad[::flip])
            inner = [(x, y, z - flip * 0.28) for x, y, _ in quad]
            mesh.face(*inner[:: -flip])
            rim = [quad[3], quad[2], inner[2], inner[3]]
            mesh.face(*rim[:: flip])
        mesh.face((a, low[0], -half), (b, low[1], -half), (b, low[1], half), (a, low[0], half))
        mesh.face((a, deck(a), half), (b, deck(b), half), (b, deck(b), -half), (a, deck(a), -half))
    for x in (-2.68, 2.68):
        for z in (-half, half):
            mesh.box((x - 0.42, -1.8, z - 0.4), (x + 0.42, 0.5, z + 0.4), without="y")
    return mesh


def house():
    """Walls of a house and of a byre beside it, two chimneys; its front looks along +z."""
    mesh = Mesh()
    for low, high, ridge in (((-5, -1, -2.6), (4, 3.3, 2.6), 5.9), ((4, -1, -2.2), (8, 2.3, 2.2), 4.3)):
        mesh.box(low, high, without="yY")
        for x, flip in ((low[0], 1), (high[0], -1)):
            gable = [(x, high[1], low[2]), (x, high[1], high[2]), (x, ridge, 0)]
            mesh.face(*gable[::flip])
    for x in (-4.4, 3.4):
        mesh.box((x - 0.45, 4.2, -0.4), (x + 0.45, 6.9, 0.4))
    return mesh


def roof():
    """The roofs, a hand's breadth thick."""
    mesh = Mesh()
    for x0, x1, half, eaves, ridge in ((-5.3, 4.3, 2.6, 3.3, 5.9), (4.3, 8.3, 2.2, 2.3, 4.3)):
        slope = (ridge - eaves) / half
        out = half + 0.35
        for side in (-1, 1):
            under = [(x0, eaves - 0.35 * slope, side * out), (x1, eaves - 0.35 * slope, side * out), (x1, ridge, 0), (x0, ridge, 0)]
            over = [(x, y + 0.16, z) for x, y, z in under]
            mesh.face(*over[::side]).face(*under[:: -side])
            mesh.face(*[under[0], under[1], over[1], over[0]][::side])
            for i, j in ((1, 2), (3, 0)):
                mesh.face(*[under[i], under[j], over[j], over[i]][::side])
    return mesh


def openings():
    """Dark windows and doors, a hair before the walls."""
    mesh = Mesh()
    for x, y, w, h in ((-3.6, 1.9, 0.45, 0.6), (-1.9, 1.9, 0.45, 0.6), (1.0, 1.9, 0.45, 0.6), (2.8, 1.9, 0.45, 0.6), (-0.45, 1.05, 0.5, 1.05)):
        mesh.face((x - w, y - h, 2.62), (x + w, y - h, 2.62), (x + w, y + h, 2.62), (x - w, y + h, 2.62))
    mesh.face((5.2, 0, 2.22), (7.0, 0, 2.22), (7.0, 1.75, 2.22), (5.2, 1.75, 2.22))
    for z in (-1.2, 1.2):
        mesh.face((-5.02, 1.3, z - 0.45), (-5.02, 1.3, z + 0.45), (-5.02, 2.5, z + 0.45), (-5.02, 2.5, z - 0.45))
    return mesh


def trunk():
    """The wood of a tree 8 m high, and where its twigs end."""
    mesh, tips = Mesh(), []
    grow(mesh, tips, np.array([0, -0.5, 0.0]), np.array([0.03, 1, 0.02]), 2.5, 0.3, 5)
    return mesh, np.array(tips)


def grow(mesh, tips, start, along, length, radius, depth):
    """A branch and those that leave it."""
    end = start + along * length
    if depth > 1:
        mesh.tube([start, (start + end) / 2 + RANDOM.normal(0, 0.06, 3), end], [radius, radius * 0.8, radius * 0.65], 6 if depth > 3 else 4)
    if depth < 3:
        tips.append(end)
    if depth == 0:
        return
    for i in range(3):
        turn = 2.4 * i + RANDOM.uniform(0, 2.4)
        way = along * 0.75 + 0.62 * np.array([np.cos(turn), RANDOM.normal(0.12, 0.25), np.sin(turn)])
        grow(mesh, tips, end, way / np.linalg.norm(way), length * RANDOM.uniform(0.55, 0.75), radius * 0.6, depth - 1)


def leaves(tips):
    """Tufts of small triangles around the ends of twigs."""
    mesh = Mesh()
    for tip in tips[RANDOM.permutation(len(tips))[:330]]:
        for _ in range(8):
            middle = tip + RANDOM.normal(0, 0.3, 3)
            a, b = RANDOM.normal(0, 0.17, (2, 3))
            mesh.face(middle, middle + a, middle + b)
    return mesh


def fence():
    """Posts and rails along the meadow."""
    mesh = Mesh()
    xs = np.arange(6.5, 24, 1.9)
    at = [(x, ground(x, 4 - 0.35 * (x - 6)), 4 - 0.35 * (x - 6)) for x in xs]
    for x, y, z in at:
        mesh.box((x - 0.07, y - 0.2, z - 0.07), (x + 0.07, y + 1.15, z + 0.07), without="y")
    for height in (0.5, 0.95):
        mesh.tube([(x, y + height, z) for x, y, z in at], 0.045, 4)
    return mesh


if __name__ == "__main__":
    wood, tips = trunk()
    meshes = dict(land=land(), bridge=bridge(), house=house(), roof=roof(), openings=openings(), trunk=wood, leaves=leaves(tips), fence=fence())
    for name, mesh in meshes.items():
        mesh.write(HERE / f"countryside_{name}.ply")
