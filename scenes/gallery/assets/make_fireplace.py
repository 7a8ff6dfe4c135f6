"""Writes the meshes and pictures of fireplace.json beside itself: python3 make_fireplace.py (needs numpy, Pillow)."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from mesh import Mesh, about

HERE = Path(__file__).parent
RANDOM = np.random.default_rng(8)
HALF, SPRING, RISE = 0.8, 0.8, 0.38  # the opening: half its width, where its arch begins, how far that rises
FRONT, BACK, HIGH = 0.35, -0.5, 2.6  # the chimney breast
BREAST = 1.25


def arch(x, more=0.0):
    """Height of the arch, or of a curve around it, at x."""
    x = np.clip(np.abs(x) / (HALF + more), 0, 1)
    return SPRING + (RISE + more) * np.sqrt(1 - x * x)


def breast():
    """The wall around the opening: its front, the soffit, the jambs."""
    mesh = Mesh()
    xs = HALF * np.cos(np.linspace(np.pi, 0, 25))
    for a, b in zip(xs, xs[1:]):
        p, q = (a, arch(a)), (b, arch(b))
        mesh.face((*p, FRONT), (*q, FRONT), (b, HIGH, FRONT), (a, HIGH, FRONT))
        mesh.face((*p, BACK), (*q, BACK), (*q, FRONT), (*p, FRONT))
    for side in (-1, 1):
        inner, outer = side * HALF, side * BREAST
        mesh.box((min(inner, outer), 0, BACK), (max(inner, outer), HIGH, FRONT))
    return mesh


def stones():
    """Courses of rubble before the breast, and wedges around the arch."""
    mesh, y = Mesh(), 0.0
    while y < HIGH - 0.05:
        height = min(RANDOM.uniform(0.1, 0.17), HIGH - y)
        x = -BREAST - 0.02
        while x < BREAST:
            width = RANDOM.uniform(0.14, 0.34)
            stone(mesh, x, y, min(x + width, BREAST + 0.02), y + height)
            x += width
        y += height
    for angle in np.linspace(6, 174, 15):
        wedge(mesh, np.radians(angle), 0.5 * np.radians(12))
    return mesh


def stone(mesh, x0, y0, x1, y1):
    """One stone with joints around it, cut away by the arch and its wedges."""
    middle, joint = (x0 + x1) / 2, 0.008
    top = SPRING if abs(middle) > HALF + 0.19 else arch(middle, 0.19)
    if abs(middle) < HALF + 0.19 and y0 < top:
        if x0 < -HALF < x1 and y1 < SPRING:
            x1 = -HALF + 0.01
        elif x0 < HALF < x1 and y1 < SPRING:
            x0 = HALF - 0.01
        elif abs(middle) < HALF or y1 > SPRING:
            return
    depth = RANDOM.uniform(0.008, 0.035)
    turn = about((0, 0, 1), RANDOM.normal(0, 0.7)) @ about((0, 1, 0), RANDOM.normal(0, 1.2))
    mesh.box((x0 + joint, y0 + joint, FRONT - 0.05), (x1 - joint, y1 - joint, FRONT + depth), turn, "z")


def wedge(mesh, angle, half):
    """One wedge of the arch."""
    corner = lambda a, more, z: ((HALF + more) * np.cos(a), SPRING + (RISE + more) * np.sin(a), z)
    a, b, near, far = angle - 0.94 * half, angle + 0.94 * half, FRONT + 0.04, FRONT - 0.1
    inner, outer = -0.008, RANDOM.uniform(0.16, 0.19)
    ring = [corner(a, inner, near), corner(a, outer, near), corner(b, outer, near), corner(b, inner, near)]
    back = [(x, y, far) for x, y, _ in ring]
    mesh.face(*ring)
    for i in range(4):
        j = (i + 1) % 4
        mesh.face(ring[j], ring[i], back[i], back[j])


def wood():
    """The mantel, beams of the ceiling, the window's frame, a stool."""
    mesh = Mesh()
    mesh.box((-1.24, 1.43, FRONT - 0.05), (1.24, 1.54, 0.6))
    for x in (-1.12, 1.02):
        mesh.box((x, 1.23, FRONT), (x + 0.1, 1.43, 0.54))
    for x in (-2.1, -1.26, -0.42, 0.42, 1.26, 2.1):
        mesh.box((x - 0.075, 2.42, 0), (x + 0.075, 2.61, 5.2))
    window(mesh)
    return mesh


def window(mesh):
    """A frame of two by three panes."""
    left, right, low, high = -2.3, -1.64, 0.95, 2.1
    for x in (left, (left + right) / 2, right):
        mesh.box((x - 0.025, low - 0.03, 0), (x + 0.025, high + 0.03, 0.05))
    for y in np.linspace(low, high, 4):
        mesh.box((left - 0.03, y - 0.02, 0), (right + 0.03, y + 0.02, 0.045))
    mesh.box((left - 0.1, low - 0.09, 0), (right + 0.1, low - 0.03, 0.16))


def chair():
    """A wing chair with its back to the viewer's right, facing the fire."""
    mesh, turn = Mesh(), about((0, 1, 0), 28)
    for low, high in [
        ((-0.36, 0.18, -0.4), (0.36, 0.46, 0.36)),
        ((-0.36, 0.18, 0.3), (0.36, 1.12, 0.44)),
        ((-0.46, 0.18, -0.4), (-0.33, 0.66, 0.44)),
        ((0.33, 0.18, -0.4), (0.46, 0.66, 0.44)),
        ((-0.43, 0.6, 0.12), (-0.34, 1.08, 0.42)),
        ((0.34, 0.6, 0.12), (0.43, 1.08, 0.42)),
    ]:
        cushion(mesh, low, high)
    for x, z in [(-0.4, -0.34), (0.4, -0.34), (-0.4, 0.38), (0.4, 0.38)]:
        mesh.tube([(x, 0, z), (x, 0.2, z)], [0.018, 0.03])
    mesh.points = [points @ turn.T + (1.5, 0, 1.6) for points in mesh.points]
    return mesh


def cushion(mesh, low, high, power=0.22, n=12):
    """A box with round edges: a superellipsoid."""
    low, high = np.array(low), np.array(high)
    bent = lambda t: np.sign(t) * np.abs(t) ** power
    v, u = np.meshgrid(np.linspace(-np.pi / 2, np.pi / 2, n), np.linspace(0, 2 * np.pi, 2 * n, endpoint=False), indexing="ij")
    unit = np.stack([bent(np.cos(v)) * bent(np.cos(u)), bent(np.sin(v)), -bent(np.cos(v)) * bent(np.sin(u))], -1)
    mesh.grid((low + high) / 2 + unit * (high - low) / 2, closed=True)


def brass():
    """Candlesticks on the mantel, and the fire's andirons."""
    mesh = Mesh()
    stick = [(0.06, 0), (0.055, 0.012), (0.015, 0.03), (0.012, 0.1), (0.022, 0.12), (0.012, 0.14), (0.012, 0.22)]
    stick += [(0.035, 0.24), (0.03, 0.25), (0, 0.25)]
    for x in (-1.08, -0.9, 1.08):
        mesh.lathe(stick, (x, 1.54, 0.48))
    for x in (-0.34, 0.34):
        knob = [(0.03, 0), (0.014, 0.03), (0.014, 0.3), (0.035, 0.33), (0.038, 0.36), (0.02, 0.39), (0, 0.4)]
        mesh.lathe(knob, (x, 0, 0.34))
        mesh.tube([(x, 0.12, 0.34), (x, 0.12, -0.15)], 0.014)
    return mesh


def candles():
    """Unlit."""
    mesh = Mesh()
    for x, height in [(-1.08, 0.2), (-0.9, 0.14), (1.08, 0.17)]:
        mesh.lathe([(0.017, 0), (0.017, height), (0.004, height + 0.004), (0.002, height + 0.02), (0, height + 0.02)], (x, 1.79, 0.48), 12)
    return mesh


def logs():
    """Those that burn, and a pile beside the breast."""
    mesh = Mesh()
    rod = lambda a, b, r: mesh.tube([a, np.add(a, b) / 2 + RANDOM.normal(0, 0.008, 3), b], [r, r * 1.05, r * 0.95], 12, caps=True)
    rod((-0.42, 0.19, 0.1), (0.44, 0.19, 0.15), 0.06)
    rod((-0.4, 0.18, -0.05), (0.38, 0.2, -0.09), 0.065)
    rod((-0.3, 0.3, -0.05), (0.36, 0.27, 0.13), 0.05)
    rod((-0.12, 0.33, 0.17), (0.14, 0.36, -0.07), 0.042)
    for row, count in enumerate((5, 4, 3)):
        for i in range(count):
            x = -1.9 + 0.135 * (i - count / 2) + RANDOM.normal(0, 0.006)
            rod((x, 0.075 + 0.115 * row, 0.45 + RANDOM.normal(0, 0.02)), (x, 0.075 + 0.115 * row, 0.1), RANDOM.uniform(0.055, 0.066))
    return mesh


def boards():
    """A floor of planks."""
    size, rows = 512, 20
    image = Image.new("RGB", (size, size))
    draw = ImageDraw.Draw(image)
    for row in range(rows):
        x, top = -RANDOM.integers(0, 160), row * size // rows
        while x < size:
            length = int(RANDOM.integers(130, 260))
            tone = np.array([118, 74, 42]) * RANDOM.uniform(0.72, 1.1)
            draw.rectangle([x, top, x + length, top + size // rows], tuple(int(c) for c in tone), (46, 28, 17))
            for _ in range(9):
                y = top + 2 + RANDOM.integers(0, size // rows - 3)
                draw.line([x + 2, y, x + length - 2, y + RANDOM.integers(-1, 2)], tuple(int(c * RANDOM.uniform(0.86, 1.06)) for c in tone))
            x += length
    image.filter(ImageFilter.GaussianBlur(0.6)).quantize(64).save(HERE / "fireplace_boards.png", optimize=True)


def painting():
    """Hills under an evening sky, for the wall above the mantel."""
    width, height = 240, 160
    y, x = np.mgrid[0:height, 0:width]
    sky = np.array([[120, 150, 190]]) + (np.array([[255, 225, 170]]) - np.array([[120, 150, 190]])) * (y / height)[..., None] ** 1.3
    for level, colour, wave, bump in [(0.55, (150, 160, 165), 35, 8), (0.66, (118, 140, 112), 50, 12), (0.8, (92, 108, 66), 70, 9)]:
        edge = height * level + bump * np.sin(x / wave + level * 20) + 0.4 * bump * np.sin(x / wave * 2.7)
        sky[y > edge] = colour
    noise = RANDOM.normal(0, 5, (height, width, 1))
    Image.fromarray(np.clip(sky + noise, 0, 255).astype(np.uint8)).quantize(64).save(HERE / "fireplace_painting.png", optimize=True)


if __name__ == "__main__":
    for make in (breast, stones, wood, chair, brass, candles, logs):
        make().write(HERE / f"fireplace_{make.__name__}.ply")
    boards()
    painting()
