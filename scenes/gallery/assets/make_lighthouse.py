"""Sea, rocks, tower and sky of ../lighthouse.json. Run it in any folder; it needs numpy."""

import numpy as np

from files import hdr, joined, lattice, noise, ply, turned


def sea() -> tuple[np.ndarray, np.ndarray]:
    """Waves, their lattice finer near the camera."""
    row, column = np.mgrid[0:1:120j, -1:1:90j]
    depth = 2 + 220 * row**2.2
    x, z = CAMERA[0] + column * (4 + 0.75 * depth), CAMERA[1] - depth
    at = np.stack([x, z], -1)
    height = 0.16 * noise(at * 0.5, 1, 2) + 0.10 * noise(at * [1.1, 2.4], 2, 3)
    return np.stack([x, height * np.exp(-depth / 90), z], -1).reshape(-1, 3), lattice(*row.shape)


def rock(centre: tuple[float, float], size: tuple[float, float, float], seed: int, steps: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """A crag: a dome broken into steps by noise."""
    z, x = np.mgrid[-1:1:steps * 1j, -1:1:steps * 1j]
    at = np.stack([x, z], -1) * np.array([size[0], size[2]])
    bent = at + 0.8 * np.stack([noise(at * 0.5, seed + 5), noise(at * 0.5, seed + 6)], -1)
    dome = 1 - np.hypot(*np.moveaxis(bent / [size[0], size[2]], -1, 0)) ** 1.6
    height = size[1] * (dome + 0.22 * (1 - np.abs(noise(bent * 0.8, seed))) - 0.12) + 0.25 * noise(at * 2.2, seed + 1, 4)
    height = np.where(height > -1, 0.6 * height + 0.4 * np.round(height / 0.9) * 0.9, -1)
    return np.stack([centre[0] + at[..., 0], height, centre[1] + at[..., 1]], -1).reshape(-1, 3), lattice(*x.shape)


def tower(base: float, low: float, high: float) -> np.ndarray:
    """The profile of a part of the tower: it narrows upwards."""
    height = np.linspace(low, high, 5)
    radius = 1.35 + 1.0 * (1 - height / 15) ** 1.6
    return np.stack([radius, base + height], -1)


def cottage(x: float, y: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """A house with a gable to the front, its walls without a floor."""
    outline = np.array([[-2.2, -3], [2.2, -3], [2.2, 2.2], [0, 4], [-2.2, 2.2]])
    front, back = (np.insert(outline, 2, depth, axis=1) for depth in (3.0, -3.0))
    sides = [[i, j, i + 5] for i, j in zip(range(5), [1, 2, 3, 4, 0])] + [[j, j + 5, i + 5] for i, j in zip(range(5), [1, 2, 3, 4, 0])]
    return 0.72 * np.concatenate([front, back]) + [x, y, z], np.array([[0, 1, 2], [0, 2, 4], [2, 3, 4], [5, 7, 6], [5, 9, 7], [7, 9, 8], *sides])


def sky() -> np.ndarray:
    """Dusk, some minutes after sunset behind the lighthouse, to the left: an orange band under a blue that deepens upwards."""
    height, width = 64, 128
    elevation = np.pi / 2 - np.pi * (np.arange(height) + 0.5)[:, None, None] / height
    around = 2 * np.pi * (np.arange(width) + 0.5)[None, :, None] / width
    glow = (0.5 + 0.5 * np.cos(around - AFTERGLOW)) ** 2
    up = np.maximum(elevation, 0)
    blue = np.array([0.020, 0.045, 0.115]) * (0.55 + 0.45 * np.exp(-up / 0.6))
    orange = np.array([1.5, 0.50, 0.10]) * glow**6 * np.exp(-up / 0.10)
    rose = np.array([0.11, 0.055, 0.06]) * (0.15 + 0.85 * glow**2) * np.exp(-up / 0.3)
    return np.where(elevation > -0.02, blue + orange + rose, np.array([0.004, 0.008, 0.014]))


AFTERGLOW = 2 * np.pi * 0.03
"""Where the sun went down, around the horizon."""
CAMERA = (-14.0, 46.0)
"""x and z."""
BASE = 4.2
COTTAGE = (6.2, 4.4, 0.5)

ply("lighthouse_sea.ply", *sea())
ply("lighthouse_rocks.ply", *joined(rock((0, 0), (13, 4.6, 9), 3, 80), rock((-13, 5), (4, 1.6, 3), 13, 32), rock((-19, 1.5), (2.4, 1.1, 2), 23, 24), rock((12, 8), (5, 2.2, 3.5), 33, 36)))
bands = np.linspace(0, 15, 6)
parts = [turned(tower(BASE, low, high), 40) for low, high in zip(bands, bands[1:])]
ply("lighthouse_red.ply", *joined(*parts[1::2], turned(np.array([[1.75, 21.6], [1.7, 21.75], [0.9, 22.7], [0.25, 23.2], [0.25, 23.5], [0.01, 23.7]]), 40)))
balcony = np.array([[1.3, 18.4], [2.2, 19.0], [2.2, 19.25], [1.5, 19.25], [1.5, 19.6], [0.01, 19.6]])
ply("lighthouse_white.ply", *joined(*parts[0::2], turned(balcony, 40), cottage(*COTTAGE)))
hdr("lighthouse_sky.hdr", sky())
