"""Meshes of ../three_glasses.json: a tumbler and what it holds, in centimetres: python3 make_three_glasses.py (needs numpy)."""

import numpy as np

from files import ply, turned

LEVEL, BASE, HEIGHT, WALL = 8.2, 0.9, 10.4, 0.28
"""Heights of the liquid, of its bed and of the rim, and how thick the wall is (cm)."""
AROUND = 96


def outside(y: float) -> float:
    """Radius of the outer wall at a height: tumblers widen upwards."""
    return 2.9 + 0.085 * y


def inside(y: float) -> float:
    return outside(y) - WALL


def arc(middle: tuple[float, float], radius: float, start: float, end: float) -> list[tuple[float, float]]:
    """A rounded edge, from one angle to another (degrees)."""
    angles = np.radians(np.linspace(start, end, 9))
    return [(middle[0] + radius * np.cos(a), middle[1] + radius * np.sin(a)) for a in angles]


def tumbler() -> list[tuple[float, float]]:
    """Glass against air: foot, outer wall, rim, and the inner wall down to the liquid."""
    foot = [(0, 0), *((r, 0) for r in (0.8, 1.6, outside(0) - 0.4)), *arc((outside(0) - 0.3, 0.3), 0.3, -90, -3)]
    up = [(outside(y), y) for y in np.linspace(0.5, HEIGHT - WALL, 9)]
    rim = arc((outside(HEIGHT) - WALL / 2, HEIGHT - WALL / 2), WALL / 2, 5, 175)
    return [*foot, *up, *rim, *((inside(y), y) for y in np.linspace(HEIGHT - WALL, LEVEL, 6))]


def content() -> list[tuple[float, float]]:
    """The liquid against the glass: its bed and the wall up to its level."""
    edge = 0.5
    bed = [(0, BASE), *((r, BASE) for r in (0.8, 1.6, inside(BASE) - edge - 0.1)), *arc((inside(BASE) - edge, BASE + edge), edge, -90, -3)]
    return [*bed, *((inside(y), y) for y in np.linspace(BASE + edge + 0.1, LEVEL, 9))]


def level() -> list[tuple[float, float]]:
    """The liquid against the air, from its rim inwards."""
    return [(r, LEVEL) for r in (*np.linspace(inside(LEVEL), 0.5, 5), 0)]


for name, profile in dict(tumbler=tumbler(), content=content(), level=level()).items():
    points, triangles = turned(np.array(profile), AROUND)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    # Those at the axis are none.
    ply(f"three_glasses_{name}.ply", points, triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-9])
