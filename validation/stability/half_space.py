"""Half spaces that scatter isotropically: Chandrasekhar's H function (Radiative Transfer, 1950, ch. III and V)."""

from functools import cache

import numpy as np

NODES = 200
ITERATIONS = 2000
"""Near albedo 1 the iteration approaches its limit slowly."""


@cache
def table(albedo: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes mu in (0, 1), their weights, and H there.

    The form 1/H(mu) = sqrt(1 - a) + a/2 integral mu' H(mu') / (mu + mu') dmu' picks the right one of two solutions.
    """
    x, w = np.polynomial.legendre.leggauss(NODES)
    mu, w = (x + 1) ** 2 / 4, w * (x + 1) / 2  # quadratic: fine near 0, where H is steep
    kernel = albedo / 2 * w * mu / (mu[:, None] + mu)
    h = np.ones(NODES)
    for _ in range(ITERATIONS):
        h = (h + 1 / (np.sqrt(1 - albedo) + kernel @ h)) / 2
    return mu, w, h


def h_function(albedo: float, mu: float) -> float:
    """H at any mu."""
    nodes, weights, h = table(albedo)
    return float(1 / (np.sqrt(1 - albedo) + albedo / 2 * np.sum(weights * nodes * h / (mu + nodes))))


def reflectance(albedo: float, mu: float = 1) -> float:
    """The part of a beam falling in at the cosine mu that comes back: 1 - sqrt(1 - a) H(mu)."""
    return 1 - np.sqrt(1 - albedo) * h_function(albedo, mu)
