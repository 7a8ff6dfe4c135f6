"""Writes the meshes and pictures of road.json beside itself: python3 make_road.py (needs numpy, Pillow).

The car looks along +x. A headlight is an optical set-up of its own at the origin: a paraboloid of revolution whose
focus is the place of the bulb, and a lens of glass that closes it."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mesh import Mesh, about

HERE = Path(__file__).parent
RANDOM = np.random.default_rng(7)
FOCUS, RIM = 0.035, 0.11  # focal length and radius of the mirror
DEPTH = RIM**2 / (4 * FOCUS)


def turned(mesh, profile, sides=48):
    """A profile of (x, radius) turned about the x axis: its front is outside where x increases."""
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    ring = np.stack([np.zeros(sides), np.cos(angle), np.sin(angle)], -1)
    return mesh.grid([r * ring + (x, 0, 0) for x, r in profile], closed=True)


def mirror():
    """x = r^2 / (4 f)."""
    return turned(Mesh(), [(r * r / (4 * FOCUS), r) for r in np.linspace(0, RIM, 30)])


def lens():
    """Flat behind, curved before."""
    back, edge, bulge = DEPTH + 0.003, DEPTH + 0.008, 0.012
    mesh = turned(Mesh(), [(back, 0), (back, RIM)])
    turned(mesh, [(back, RIM), (edge, RIM)])
    return turned(mesh, [(edge + bulge * (1 - (r / RIM) ** 2), r) for r in np.linspace(RIM, 0, 12)])


def shell():
    """The pod around the mirror, and the rim that holds the lens."""
    outer = lambda r: (r * r / (4 * FOCUS) - 0.05, r + 0.012)
    mesh = turned(Mesh(), [(-0.06, 0)] + [outer(r) for r in np.linspace(0.02, RIM, 14)] + [(DEPTH, RIM + 0.012)])
    front = DEPTH + 0.012
    turned(mesh, [(DEPTH, RIM + 0.012), (front, RIM + 0.012)])
    turned(mesh, [(front, RIM + 0.012), (front, RIM + 0.001), (DEPTH, RIM + 0.001)])
    return mesh


BODY = [  # x, bottom, top, half width
    (-2.12, 0.42, 0.5, 0.3), (-2.05, 0.36, 0.72, 0.5), (-1.85, 0.33, 0.98, 0.62), (-1.5, 0.32, 1.28, 0.68), (-1.1, 0.32, 1.45, 0.71),
    (-0.6, 0.32, 1.53, 0.72), (-0.1, 0.32, 1.53, 0.72), (0.2, 0.32, 1.48, 0.71), (0.42, 0.32, 1.33, 0.69), (0.62, 0.32, 1.08, 0.64),
    (0.75, 0.33, 0.99, 0.56), (0.9, 0.34, 0.97, 0.47), (1.3, 0.36, 0.95, 0.39), (1.62, 0.38, 0.92, 0.33), (1.72, 0.4, 0.88, 0.3),
]  # fmt: skip


def section(x, angles, more=0.0):
    """Points of the body's section at x: angle 0 is up, pi / 2 to the right."""
    stations = np.array(BODY)
    low, high, half = (np.interp(x, stations[:, 0], stations[:, i]) for i in (1, 2, 3))
    bent = lambda t: np.sign(t) * np.abs(t) ** 0.45
    tumble = 1 - 0.16 * np.clip(np.cos(angles) - 0.1, 0, 1)
    y = (low + high) / 2 + (high - low) / 2 * bent(np.cos(angles)) + more * np.cos(angles)
    z = half * bent(np.sin(angles)) * tumble + more * np.sin(angles)
    return np.stack([np.full_like(y, x), y, z], -1)


def body():
    """The coach: bonnet, cabin, boot, in one piece; wings around the wheels, running boards."""
    mesh = Mesh()
    angles = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    ends = [b[0] for b in BODY]
    xs = np.interp(np.linspace(0, len(ends) - 1, 43), np.arange(len(ends)), ends)
    mesh.grid([section(x, angles) for x in xs], closed=True)
    for x in (xs[0], xs[-1]):
        ring = section(x, angles)
        mesh.grid([ring.mean(0) + t * (ring - ring.mean(0)) for t in (0, 1)], closed=True)
    for side in (-1, 1):
        for x in (1.3, -1.3):
            wing(mesh, x, side)
        mesh.box((-0.85, 0.3, side * 0.7 - 0.12), (0.85, 0.35, side * 0.7 + 0.12))
    return mesh


def wing(mesh, x, side):
    """A wing over the wheel at x: an arch with round shoulders."""
    turns, across = np.linspace(-0.25, np.pi * 0.98, 26), np.linspace(-np.pi / 2, np.pi / 2, 11)
    rows = []
    for turn in turns:
        reach = 0.43 + 0.05 * np.sign(x) * max(0, np.cos(turn)) ** 2 + 0.05 * np.cos(across)
        rows.append(np.stack([x + reach * np.cos(turn), 0.34 + reach * np.sin(turn), side * 0.66 + 0.14 * np.sin(across)], -1))
    mesh.grid(rows)


def windows():
    """Dark glass a hair above the body: the sides, the windscreen."""
    mesh = Mesh()
    for x0, x1 in [(-1.42, -0.82), (-0.74, -0.12), (-0.04, 0.36)]:
        for side in (1, -1):
            angles = side * np.linspace(0.42, 1.36, 8)
            mesh.grid([section(x, angles, 0.006) for x in np.linspace(x0, x1, 8)])
    angles = np.linspace(-0.62, 0.62, 9)
    return mesh.grid([section(x, angles, 0.008) for x in np.linspace(0.27, 0.6, 6)])


def wheels():
    """Four tyres."""
    return wheel_parts([(0.2, -0.06), (0.27, -0.075), (0.32, -0.06), (0.335, -0.03), (0.335, 0.03), (0.32, 0.06), (0.27, 0.075), (0.2, 0.06)])


def chrome():
    """Hub caps, the grille's shell, bumpers, the bar of the headlights."""
    mesh = wheel_parts([(0.0, -0.075), (0.1, -0.07), (0.19, -0.055), (0.205, 0.0), (0.19, 0.055), (0.1, 0.07), (0.0, 0.075)])
    mesh.tube([(1.98, 0.4, z) for z in (-0.78, -0.4, 0, 0.4, 0.78)], 0.035)
    mesh.tube([(-2.22, 0.42, z) for z in (-0.74, -0.4, 0, 0.4, 0.74)], 0.035)
    mesh.tube([(1.6, 0.72, z) for z in (-0.5, 0, 0.5)], 0.014)
    angles = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    mesh.grid([section(1.715, angles, m) + (dx, 0, 0) for dx, m in [(-0.05, 0.004), (0.0, 0.015), (0.03, 0.004), (0.03, -0.03)]], closed=True)
    return mesh


def wheel_parts(profile):
    """A profile of (radius, z), turned about the axles."""
    mesh = Mesh()
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(32)], -1)
    for x in (1.3, -1.3):
        for z in (-0.66, 0.66):
            mesh.grid([r * ring + (x, 0.335, z + dz) for r, dz in profile], closed=True)
    return mesh


def lamp():
    """The street lamp's post, arm and shade; its light is at (0, 5, 0) under the shade."""
    mesh = Mesh()
    curve = [(0, 4.6 + 0.75 * np.sin(t), -1.7 + 0.85 * (1 - np.cos(t))) for t in np.linspace(0, np.pi / 2, 10)]
    bow = [*curve, (0, 5.34, -0.4), (0, 5.3, 0)]
    mesh.tube([(0, 0, -1.7), (0, 2.5, -1.7)], [0.075, 0.06]).tube([(0, 2.5, -1.7), (0, 4.6, -1.7)], [0.05, 0.045]).tube(bow, 0.035)
    mesh.lathe([(0.12, 0), (0.12, 0.5), (0.08, 0.56)], (0, 0, -1.7), 16)
    mesh.lathe([(0.3, 4.96), (0.29, 5.0), (0.2, 5.08), (0.08, 5.14), (0.07, 5.32), (0, 5.34)])
    return mesh


def wall():
    """A wall of stones along the far side of the road."""
    mesh, y = Mesh(), 0.0
    for height in (0.26, 0.22, 0.2, 0.17, 0.09):
        x = -12.0
        while x < 13:
            width = RANDOM.uniform(0.3, 0.75) if height > 0.1 else 0.6
            depth = RANDOM.uniform(0, 0.04) + 0.06 * (height < 0.1)
            mesh.box((x + 0.012, y + 0.01, -0.25), (x + width - 0.012, y + height - 0.008, depth), about((0, 0, 1), RANDOM.normal(0, 0.8)), "z")
            x += width
        y += height
    return mesh


def tree():
    """A bare tree: every branch forks until it is thin."""
    mesh = Mesh()
    branch(mesh, np.array([0.0, 0, 0]), np.array([0.05, 1, 0]), 1.7, 0.17, 6)
    return mesh


def branch(mesh, start, along, length, radius, depth):
    """One branch, bent a little, and those that leave it."""
    bend = RANDOM.normal(0, 0.12, 3)
    middle, end = start + along * length * 0.5 + bend * length * 0.3, start + along * length
    mesh.tube([start, middle, end], [radius, radius * 0.85, radius * 0.72], 6 if depth > 3 else 3)
    if depth == 0:
        return
    for _ in range(2 + (RANDOM.random() < 0.35)):
        way = along + RANDOM.normal(0, 0.48, 3) + (0, 0.1, 0)
        branch(mesh, end, way / np.linalg.norm(way), length * RANDOM.uniform(0.62, 0.85), radius * RANDOM.uniform(0.55, 0.72), depth - 1)


def sign():
    """A triangle of warning, a plate below it, and where they are."""
    size = 256
    image, mask = Image.new("RGB", (size, size + 96), (225, 225, 220)), Image.new("L", (size, size + 96), 0)
    draw, cut = ImageDraw.Draw(image), ImageDraw.Draw(mask)
    corners = lambda more: [(size / 2, 12 + 2 * more), (size - 6 - 1.73 * more, size - 26 - more), (6 + 1.73 * more, size - 26 - more)]
    draw.polygon(corners(0), (190, 18, 22))
    draw.polygon(corners(20), (235, 233, 226))
    draw.rectangle([size / 2 - 11, 96, size / 2 + 11, 166], (20, 20, 22))
    draw.ellipse([size / 2 - 13, 176, size / 2 + 13, 202], (20, 20, 22))
    plate = [size / 2 - 78, size - 4, size / 2 + 78, size + 82]
    draw.rectangle(plate, (235, 233, 226), (20, 20, 22), 5)
    draw.text((size / 2, size + 38), "FOG", (20, 20, 22), ImageFont.load_default(56), anchor="mm", stroke_width=2)
    cut.polygon(corners(0), 255)
    cut.rectangle(plate, 255)
    image.quantize(32).save(HERE / "road_sign.png", optimize=True)
    mask.quantize(8).save(HERE / "road_sign_cut.png", optimize=True)


def puddles():
    """Where water stands on the road: black, elsewhere white."""
    size, total = 256, np.zeros((256, 256))
    for cells in (5, 9, 18, 36):
        grain = RANDOM.random((cells, cells // 2))
        total += np.asarray(Image.fromarray(grain.astype("f4")).resize((size, size), Image.BICUBIC)) / cells**0.8
    rank = total.argsort(axis=None).argsort().reshape(size, size) / size**2
    rough = np.clip((rank - 0.28) / 0.12, 0, 1)
    picture = Image.fromarray((255 * rough).astype(np.uint8))
    picture.quantize(16).save(HERE / "road_puddles.png", optimize=True)


if __name__ == "__main__":
    for make in (mirror, lens, shell, body, windows, wheels, chrome, lamp, wall, tree):
        make().write(HERE / f"road_{make.__name__}.ply")
    sign()
    puddles()
