"""Truth for slabs whose phase function is too sharp for adding-doubling (at g = 0.999 it has not converged with 64
quadrature points): photons in double precision, a few lines of numpy that share nothing with the renderer."""

import numpy as np

from validation.stability.case import Sampled
from validation.stability.kept import kept

PHOTONS = 100_000
BATCHES = 16


def totals(albedo: float, b: float, g: float) -> tuple[Sampled, Sampled]:
    """UR1 and UT1, the unscattered part included."""
    generator, told = np.random.default_rng(7), (albedo, b, g, PHOTONS, BATCHES)
    reflected, transmitted = kept("photons", told, lambda: np.array([batch(albedo, b, g, generator) for _ in range(BATCHES)])).T
    return Sampled(reflected), Sampled(transmitted)


def batch(albedo: float, b: float, g: float, generator: np.random.Generator) -> tuple[float, float]:
    """The parts of one batch of photons that leave above and below."""
    depth, direction = np.zeros(PHOTONS), np.tile([0.0, 0.0, 1.0], (PHOTONS, 1))
    above = below = 0
    while depth.size:
        depth = depth + direction[:, 2] * generator.exponential(size=depth.size)
        above, below = above + int((depth < 0).sum()), below + int((depth > b).sum())
        stays = (depth >= 0) & (depth <= b) & (generator.random(depth.size) < albedo)
        depth, direction = depth[stays], direction[stays]
        direction = turned(direction, cosines(g, generator.random(depth.size)), generator.random(depth.size))
    return above / PHOTONS, below / PHOTONS


def cosines(g: float, u: np.ndarray) -> np.ndarray:
    """Henyey-Greenstein's, by inversion."""
    s = (1 - g * g) / (1 - g + 2 * g * u)
    return (1 + g * g - s * s) / (2 * g)


def turned(direction: np.ndarray, cosine: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Directions at these cosines from the given ones, about which `turn` in [0, 1) goes round once."""
    aside = np.where(np.abs(direction[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]])
    across = np.cross(direction, aside)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    other = np.cross(direction, across)
    sine = np.sqrt(np.maximum(0, 1 - cosine**2))[:, None]
    angle = 2 * np.pi * turn[:, None]
    new = cosine[:, None] * direction + sine * (np.cos(angle) * across + np.sin(angle) * other)
    return new / np.linalg.norm(new, axis=1, keepdims=True)
