"""Surface, sand, rock and fish of ../under_water.json. Run it in any folder; it needs numpy."""

import numpy as np

from files import joined, lattice, noise, ply


HOLE = np.array([0.3, -3.2])
"""x and z of the middle of the opening."""


def waves() -> tuple[np.ndarray, np.ndarray]:
    """The surface of the water in the opening: peaked ripples, which focus the sun."""
    z, x = np.mgrid[-1:1:100j, -1:1:100j]
    at = 2.0 * np.stack([x, z], -1)
    bent = at + 0.12 * np.stack([noise(at * 2.0, 5, 1), noise(at * 2.0, 6, 1)], -1)
    height = 0.055 * noise(bent * 6.0, 7, 1) * (1 - np.abs(x) ** 12) * (1 - np.abs(z) ** 12)  # flat where the rock begins
    return np.stack([HOLE[0] + at[..., 0], 4 + height, HOLE[1] + at[..., 1]], -1).reshape(-1, 3), lattice(*x.shape)


def bed() -> tuple[np.ndarray, np.ndarray]:
    """Sand in ripples, which rises towards the walls."""
    z, x = np.mgrid[-1:1:64j, -1:1:64j]
    x, z = 5.5 * x, 5.5 * z - 2.5
    at = np.stack([x, z], -1)
    height = 0.12 * noise(at * 0.6, 3, 3) + 0.03 * np.sin(6 * (z + 0.4 * noise(at * 0.7, 4, 3))) + 0.8 * np.clip(np.hypot(x, (z + 3.2) * 0.8) / 4.5, 0, 2) ** 4
    return np.stack([x, height - 0.05, z], -1).reshape(-1, 3), lattice(*x.shape)


def roof() -> tuple[np.ndarray, np.ndarray]:
    """The rock above, with a ragged opening."""
    z, x = np.mgrid[-1:1:70j, -1:1:70j]
    at = np.stack([5.5 * x, 5.5 * z - 2.5], -1)
    off = at - HOLE
    edge = np.hypot(*np.moveaxis(off, -1, 0)) - 0.95 - 0.22 * noise(at * 2.1, 31, 4)
    bent = at + 0.3 * np.stack([noise(at, 21, 3), noise(at, 22, 3)], -1)
    height = 3.75 - 0.55 * (1 - np.abs(noise(bent * 1.1, 23, 4))) - 0.25 * np.clip(edge, 0, 2) + 0.5 * np.exp(-np.maximum(edge, 0) / 0.2)
    points, triangles = np.stack([at[..., 0], height, at[..., 1]], -1).reshape(-1, 3), lattice(*x.shape)
    return points, triangles[(edge.reshape(-1)[triangles] > 0).any(axis=1)]


def wall() -> tuple[np.ndarray, np.ndarray]:
    """The rock behind and to both sides, in folds."""
    y, around = np.mgrid[-0.5:4.2:32j, -1:1:84j]
    angle = 1.25 * np.pi / 2 * around
    at = np.stack([4.2 * angle, 1.3 * y], -1)
    radius = 4.7 + 0.5 * noise(at * 0.8, 41, 5) + 0.35 * np.abs(noise(at * 1.3, 42, 3)) - 0.6 * (y / 4) ** 2
    return np.stack([radius * np.sin(angle), y, -2.2 - radius * np.cos(angle) * 0.95], -1).reshape(-1, 3), lattice(*y.shape)


def boulder(centre: tuple[float, float, float], size: tuple[float, float, float], seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A ball, dented by noise."""
    polar, around = np.mgrid[0.02 : np.pi - 0.02 : 20j, 0 : 2 * np.pi * (1 - 1 / 32) : 32j]
    ball = np.stack([np.sin(polar) * np.cos(around), np.cos(polar), np.sin(polar) * np.sin(around)], -1)
    dents = 1 + 0.14 * noise(1.6 * ball[..., :2] + 1.1 * ball[..., 2:], seed, 4)
    return (ball * dents[..., None] * size + centre).reshape(-1, 3), lattice(*polar.shape, around=True)[:, ::-1]


def fish(at: np.ndarray, length: float, heading: float, bend: float) -> tuple[np.ndarray, np.ndarray]:
    """A slender body with a forked tail, turned about the vertical."""
    along = np.linspace(0, 1, 9)[:, None]
    around = 2 * np.pi * np.arange(10) / 10
    thick = 0.16 * np.sin(np.pi * along**0.75) ** 0.8 * (1 - 0.25 * along) + 0.012
    body = np.stack([along - 0.5 + 0 * around, thick * np.sin(around), 0.5 * thick * np.cos(around)], -1).reshape(-1, 3)
    tail = np.array([[0.46, 0.02, 0], [0.46, -0.02, 0], [0.72, 0.17, 0], [0.62, 0, 0], [0.72, -0.17, 0]])
    points = np.concatenate([body, tail])
    points[:, 2] += bend * (points[:, 0] + 0.2) ** 2 * (points[:, 0] > -0.2)
    turn = np.array([[np.cos(heading), 0, np.sin(heading)], [0, 1, 0], [-np.sin(heading), 0, np.cos(heading)]])
    triangles = np.concatenate([lattice(9, 10, around=True), len(body) + np.array([[0, 3, 2], [0, 1, 3], [1, 4, 3]])])
    return length * points @ turn.T + at, triangles


def school(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Fish that swim together."""
    random = np.random.default_rng(12)
    places = random.uniform(-1, 1, (count, 3)) ** 3 * [1.3, 0.5, 0.9] + random.uniform(-1, 1, (count, 3)) * [0.7, 0.3, 0.6] + [0.4, 1.75, -2.9]
    return joined(*(fish(at, random.uniform(0.17, 0.26), 0.35 + random.uniform(-0.25, 0.25), random.uniform(-0.4, 0.4)) for at in places))


ply("under_water_fish.ply", *school(26))
ply("under_water_waves.ply", *waves())
ply("under_water_bed.ply", *bed())
ply("under_water_cave.ply", *joined(
    roof(), wall(), boulder((-2.0, 0.3, -4.6), (0.9, 0.8, 0.8), 1), boulder((-2.9, 0.2, -3.4), (0.7, 0.55, 0.6), 2),
    boulder((2.3, 0.3, -4.4), (0.7, 0.7, 0.6), 4), boulder((1.5, 0.12, -2.4), (0.4, 0.3, 0.35), 5),
))  # fmt: skip
