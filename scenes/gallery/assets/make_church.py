"""Writes the meshes and the window of church.json beside itself: python3 make_church.py (needs numpy, Pillow).

A nave of four bays along -z: clustered columns, pointed arches to the aisles, a vault of ribs; above the arches of
the south side, at +x, windows with tracery."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from mesh import Mesh

HERE = Path(__file__).parent
BAY, BAYS = 4.0, 4  # length and number of the bays; the first begins at z = 0
HALF, SPRING, CROWN = 3.0, 5.6, 8.6  # half the width of the nave; where the vault springs, its highest point
AISLE = 6.0  # the outer walls of the aisles are at +-AISLE
ARCH_SPRING, ARCH_TOP = 3.1, 4.9  # the arches between nave and aisles
SILL, HEAD, TOP, WIDE = 5.3, 6.8, 7.95, 0.72  # a window: sill, spring of its arch, its top, half its width
THICK = 0.5  # of the walls of the nave


def pointed(half, spring, top, n=9):
    """A pointed arch of two circular arcs over [-half, half], left to right."""
    rise = top - spring
    radius = (half * half + rise * rise) / (2 * half)
    t = np.linspace(0, np.arctan2(rise, radius - half), n)
    right = np.stack([half - radius + radius * np.cos(t), spring + radius * np.sin(t)], -1)
    return np.concatenate([right * (-1, 1), right[::-1][1:]])


def height(t):
    """Height of the vault at t from -1 to 1 across a bay or the nave."""
    arch = pointed(1, SPRING, CROWN, 24)
    return np.interp(t, arch[:, 0], arch[:, 1])


def vault():
    """Groin vault: over each point the lower of the two barrels that cross is open, so the higher one is."""
    mesh, n = Mesh(), 24
    for bay in range(BAYS):
        u, v = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
        y = np.maximum(height(u), height(v))
        points = np.stack([HALF * u, y, -BAY * (bay + 0.5 + v / 2)], -1)
        mesh.grid(points[::-1])
    return mesh


def ribs():
    """Mouldings of the vault: across, along the groins, along the ridge, over the walls."""
    mesh, t = Mesh(), np.linspace(-1, 1, 25)
    for bay in range(BAYS + 1):
        mesh.tube(np.stack([HALF * t, height(t) - 0.05, np.full(25, -BAY * bay)], -1), 0.13, 8)
    for bay in range(BAYS):
        middle = -BAY * (bay + 0.5)
        for side in (-1, 1):
            mesh.tube(np.stack([HALF * t, height(t) - 0.03, middle + side * BAY / 2 * t], -1), 0.085, 6)
            mesh.tube(np.stack([np.full(25, side * (HALF - 0.02)), height(t), middle + BAY / 2 * t], -1), 0.08, 6)
    boss = [(0.0, -0.2), (0.16, -0.14), (0.2, -0.02), (0.16, 0.1)]
    for bay in range(BAYS):
        mesh.lathe(boss, (0, CROWN - 0.06, -BAY * (bay + 0.5)), 16)
    return mesh


def columns():
    """Clusters of four shafts around a core, on bases, with capitals; thin shafts from them to the vault."""
    mesh = Mesh()
    base = [(0.62, 0), (0.62, 0.14), (0.56, 0.2), (0.58, 0.28), (0.5, 0.36), (0.42, 0.4)]
    capital = [(0.4, 2.6), (0.42, 2.66), (0.38, 2.7), (0.42, 2.82), (0.56, 3.0), (0.6, 3.04), (0.6, 3.12), (0.0, 3.12)]
    for side in (-1, 1):
        for bay in range(BAYS + 1):
            at = (side * (HALF + 0.35), 0, -BAY * bay)
            mesh.lathe(base, at, 24).lathe([(0.36, 0.36), (0.36, 2.64)], at, 20).lathe(capital, at, 24)
            for dx, dz in ((0.33, 0), (-0.33, 0), (0, 0.33), (0, -0.33)):
                mesh.lathe([(0.13, 0.36), (0.13, 2.66)], (at[0] + dx, 0, at[2] + dz), 12)
            mesh.lathe([(0.14, 3.1), (0.14, SPRING - 0.25), (0.24, SPRING - 0.05), (0.24, SPRING)], (side * (HALF - 0.0), 0, -BAY * bay), 12)
    return mesh


def arcade():
    """The walls above the arches between nave and aisles."""
    mesh = Mesh()
    arch = pointed(BAY / 2 - 0.45, ARCH_SPRING, ARCH_TOP)
    for side in (-1, 1):
        for bay in range(BAYS):
            middle = -BAY * (bay + 0.5)
            pierced(mesh, side * HALF, side * (HALF + THICK), middle, arch, BAY / 2, SILL if side > 0 else CROWN)
            for inset in (0, THICK):
                mesh.tube([(side * (HALF + inset), y, middle + z) for z, y in arch], 0.1, 6)
            if side > 0:
                window(mesh, HALF, HALF + THICK, middle)
    return mesh


def window(mesh, near, far, middle):
    """The wall around a window, from its sill to the vault."""
    for z0, z1 in ((-BAY / 2, -WIDE), (WIDE, BAY / 2)):
        for x in (near, far):
            mesh.face((x, SILL, middle + z0), (x, SILL, middle + z1), (x, HEAD, middle + z1), (x, HEAD, middle + z0))
    for z in (-WIDE, WIDE):
        mesh.face((near, SILL, middle + z), (far, SILL, middle + z), (far, HEAD, middle + z), (near, HEAD, middle + z))
    mesh.face((near, SILL, middle - WIDE), (near, SILL, middle + WIDE), (far, SILL, middle + WIDE), (far, SILL, middle - WIDE))
    pierced(mesh, near, far, middle, pointed(WIDE, HEAD, TOP), BAY / 2, CROWN)


def pierced(mesh, near, far, middle, arch, half, top):
    """A wall between the planes x = near and far, above an arch given as (z, y) about z = middle."""
    arch = [(-half, arch[0][1])] + [tuple(p) for p in arch] + [(half, arch[-1][1])]
    for (z0, y0), (z1, y1) in zip(arch, arch[1:]):
        for x in (near, far):
            mesh.face((x, y0, middle + z0), (x, y1, middle + z1), (x, top, middle + z1), (x, top, middle + z0))
        mesh.face((near, y0, middle + z0), (near, y1, middle + z1), (far, y1, middle + z1), (far, y0, middle + z0))


def walls():
    """The outer walls of the aisles and their roofs; the west and east walls."""
    mesh, end = Mesh(), -BAY * BAYS
    for side in (-1, 1):
        out, top = side * AISLE, 5.2
        mesh.face((out, 0, 0), (out, 0, end), (out, top, end), (out, top, 0))
        mesh.face((side * HALF, top, 0), (out, top, 0), (out, top, end), (side * HALF, top, end))
    for z in (0.02, end - 0.02):
        mesh.face((-AISLE, 0, z), (AISLE, 0, z), (AISLE, CROWN + 0.3, z), (-AISLE, CROWN + 0.3, z))
    return mesh


def tracery():
    """In each window: a mullion, two small arches, a ring above them."""
    mesh, x = Mesh(), HALF + 0.3
    small = pointed(WIDE / 2, HEAD - 0.25, HEAD + 0.3, 6)
    for bay in range(BAYS):
        middle = -BAY * (bay + 0.5)
        bar = lambda points, r: mesh.tube([(x, y, middle + z) for z, y in points], r, 6)
        bar([(0, SILL), (0, HEAD - 0.2)], 0.045)
        for side in (-1, 1):
            bar([(z + side * WIDE / 2, y) for z, y in small], 0.04)
            bar([(side * WIDE, SILL), (side * WIDE, HEAD)], 0.05)
        bar(pointed(WIDE, HEAD, TOP), 0.05)
        turn = np.linspace(0, 2 * np.pi, 17)
        bar([(0.24 * np.sin(t), HEAD + 0.55 + 0.24 * np.cos(t)) for t in turn], 0.035)
        for y in np.arange(SILL + 0.4, HEAD, 0.4):
            bar([(-WIDE, y), (WIDE, y)], 0.012)
    return mesh


def pews():
    """Two rows of benches with carved ends."""
    mesh = Mesh()
    for row in range(11):
        z = -3.2 - 0.95 * row
        for side in (-1, 1):
            x0, x1 = sorted((side * 0.75, side * 2.45))
            mesh.box((x0, 0.4, z - 0.2), (x1, 0.45, z + 0.2)).box((x0, 0.45, z + 0.18), (x1, 0.9, z + 0.22))
            mesh.box((x0, 0.06, z + 0.1), (x1, 0.12, z + 0.14))
            for x in (x0, x1):
                outline = [(-0.26, 0), (-0.26, 0.5), (-0.12, 0.62), (0.1, 0.72), (0.16, 0.98), (0.25, 1.02), (0.28, 0.9), (0.28, 0)]
                bench_end(mesh, x, z, outline)
    return mesh


def bench_end(mesh, x, z, outline):
    """A board 6 cm thick of an outline given as (z, y)."""
    for dx in (-0.03, 0.03):
        middle = (x + dx, 0.4, z + 0.05)
        for (a, b), (c, d) in zip(outline, outline[1:] + outline[:1]):
            mesh.face(middle, (x + dx, b, z + a), (x + dx, d, z + c))
    for (a, b), (c, d) in zip(outline, outline[1:] + outline[:1]):
        mesh.face((x - 0.03, b, z + a), (x + 0.03, b, z + a), (x + 0.03, d, z + c), (x - 0.03, d, z + c))


def altar():
    """A table with a cross and two candlesticks, on steps."""
    mesh = Mesh()
    for i in range(3):
        mesh.box((-2.4 + 0.3 * i, 0.16 * i, -16), (2.4 - 0.3 * i, 0.16 * (i + 1), -13.4 - 0.4 * i))
    mesh.box((-1.0, 0.48, -15.5), (1.0, 1.4, -14.9)).box((-1.12, 1.4, -15.6), (1.12, 1.5, -14.8))
    return mesh


def glass():
    """The picture of a window: coloured panes between leads, v up the unit square."""
    wide, high = 124, 336
    random, image = np.random.default_rng(3), Image.new("RGB", (wide * 2, high * 2))
    draw = ImageDraw.Draw(image)
    hues = [(96, 128, 214), (206, 84, 76), (240, 196, 96), (120, 176, 140), (160, 120, 196), (196, 220, 240), (248, 238, 200)]
    columns, rows = 8, 21
    point = lambda i, j: (i * wide * 2 / columns + (0 < i < columns) * random.uniform(-7, 7), j * high * 2 / rows + random.uniform(-7, 7))
    corners = [[point(i, j) for i in range(columns + 1)] for j in range(rows + 1)]
    for j in range(rows):
        for i in range(columns):
            border = i in (0, columns - 1)
            hue = hues[[0, 1][j % 2]] if border else hues[random.choice(7, p=[0.14, 0.1, 0.18, 0.06, 0.04, 0.22, 0.26])]
            quad = [corners[j][i], corners[j][i + 1], corners[j + 1][i + 1], corners[j + 1][i]]
            draw.polygon(quad, hue)
            draw.line(quad + quad[:1], (12, 12, 14), 3)
    image.quantize(32).save(HERE / "church_window.png", optimize=True)


def rose():
    """The picture of a rose window: petals around a middle, dark stone between and around them."""
    size, random = 256, np.random.default_rng(6)
    y, x = (np.mgrid[0:size, 0:size] + 0.5) / size * 2 - 1
    r, turn = np.hypot(x, y), np.arctan2(y, x) / (2 * np.pi) % 1
    image = np.zeros((size, size, 3))
    for inner, outer, count, hues in ((0.0, 0.2, 1, [3]), (0.25, 0.56, 8, [0, 1]), (0.61, 0.93, 16, [2, 0, 4, 0])):
        petal = (turn * count).astype(int) % count
        edge = np.abs(turn * count % 1 - 0.5) * 2 * np.pi * r / count
        open_ = (r > inner) & (r < outer) & ((count == 1) | (edge < np.pi * r / count - 0.035))
        colours = np.array([(84, 124, 255), (255, 84, 70), (110, 210, 160), (255, 235, 160), (220, 110, 210)])[np.array(hues)[petal % len(hues)]]
        image = np.where(open_[..., None], colours, image)
    glints = np.kron(random.uniform(0.6, 1.25, (32, 32)), np.ones((8, 8)))
    Image.fromarray(np.clip(image * glints[..., None], 0, 255).astype(np.uint8)).quantize(48).save(HERE / "church_rose.png", optimize=True)


if __name__ == "__main__":
    for make in (vault, ribs, columns, arcade, walls, tracery, pews, altar):
        make().write(HERE / f"church_{make.__name__}.ply")
    glass()
    rose()
