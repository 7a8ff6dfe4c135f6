"""Roof, panes and barrel of ../attic.json. Run it in any folder; it needs numpy."""

import numpy as np

from files import joined, ply, turned

EAVES, RIDGE, HALF = 0.7, 3.5, 2.8
"""Heights of the roof's edges, and half the width of the room; it is 7 m long, from z = -3.5 on."""
HOLES = [(1.25, 2.15, 2.35, 3.15), (1.45, 2.05, 0.75, 1.25), (2.9, 2.93, 3.6, 3.9), (0.9, 0.925, 4.2, 4.5), (3.1, 3.125, 1.6, 1.75), (0.6, 0.62, 1.75, 1.95)]
"""A roof light, a smaller one, and what slates that slipped leave open: along the right slope, from the eaves, and along z."""


def cells() -> list[tuple[float, float, float, float]]:
    """The slope cut at every edge of a hole."""
    length = float(np.hypot(RIDGE - EAVES, HALF))
    along = sorted({0.0, length, *(edge for hole in HOLES for edge in hole[:2])})
    across = sorted({0.0, 7.0, *(edge for hole in HOLES for edge in hole[2:])})
    return [(a, b, c, d) for a, b in zip(along, along[1:]) for c, d in zip(across, across[1:])]


def is_open(cell: tuple[float, float, float, float]) -> bool:
    a, b, c, d = cell
    return any(hole[0] <= a and b <= hole[1] and hole[2] <= c and d <= hole[3] for hole in HOLES)


def slope(pieces: list[tuple[float, float, float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Rectangles of the right slope, facing outwards."""
    down = np.array([HALF, EAVES - RIDGE]) / np.hypot(HALF, RIDGE - EAVES)

    def at(along: float, z: float) -> list[float]:
        return [HALF - along * down[0], EAVES - along * down[1], z - 3.5]

    corners = [[at(a, c), at(b, c), at(b, d), at(a, d)] for a, b, c, d in pieces]
    return joined(*((np.array(four), np.array([[0, 1, 2], [0, 2, 3]])) for four in corners))


ply("attic_roof.ply", *slope([cell for cell in cells() if not is_open(cell)]))
ply("attic_panes.ply", *slope([cell for cell in cells() if is_open(cell)]))
height = np.linspace(0, 0.86, 15)
staves = np.stack([0.235 + 0.055 * np.sin(np.pi * height / 0.86), height], -1)
ply("attic_barrel.ply", *turned(np.concatenate([staves, [[0.21, 0.86], [0.21, 0.81], [0.001, 0.81]]]), 36))
hoops = [np.array([[r, y], [r + 0.006, y], [r + 0.006, y + 0.035], [r, y + 0.035]]) for y, r in ((0.06, 0.248), (0.22, 0.277), (0.60, 0.277), (0.76, 0.256))]
ply("attic_hoops.ply", *joined(*(turned(hoop, 36) for hoop in hoops)))
