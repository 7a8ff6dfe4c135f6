"""Single scattering from a point light in an infinite homogeneous medium: one integral along each camera ray."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import quad

from tyndall.scene import Scene
from validation.closed_forms.case import BLACK, Case, camera, medium, rgb, scene
from validation.closed_forms.view import View, pixel_means

SIGMA_T = (0.2, 0.5, 1.0)
ALBEDO = 0.8
INTENSITY = 10.0
FOV = 40.0
NEAR = 0.01
"""Camera rays start on the near clipping plane: the fog before it does not count."""
LIGHT = np.array([0.0, 1.6, -3.0])
"""Outside of the view, so that the image has no peak; the camera stands at the origin and looks along -z."""
VIEW = View((0, 0, 0), (0, 0, -1), FOV, nodes=3)

Phase = Callable[[float], float]
"""Per steradian, by the cosine; 1 is forward."""
PHASES: dict[str, tuple[dict[str, Any], Phase]] = {
    "isotropic": ({"type": "isotropic"}, lambda c: 1 / (4 * np.pi)),
    "hg 0.7": ({"type": "hg", "g": 0.7}, lambda c: henyey_greenstein(c, 0.7)),
    "rayleigh": ({"type": "rayleigh"}, lambda c: 3 / (16 * np.pi) * (1 + c * c)),
}


def cases() -> list[Case]:
    """One scene for each phase function."""
    return [Case(lit(name, plugin), image(phase)) for name, (plugin, phase) in PHASES.items()]


def lit(name: str, phase: dict) -> Scene:
    """Fog everywhere, a point light, and behind the camera a speck that gives the scene a size."""
    fog = {"type": "ref", "id": "fog"}
    return scene(
        f"point light {name}",
        max_depth=2,
        fog=medium(SIGMA_T, ALBEDO, phase),
        sensor=camera((0, 0, 0), (0, 0, -1), FOV, medium=fog, near_clip=NEAR),
        light={"type": "point", "position": LIGHT.tolist(), "intensity": rgb(INTENSITY), "medium": fog},
        speck={"type": "sphere", "center": [0, 0, 4], "radius": 0.01, "bsdf": BLACK},
    )


def henyey_greenstein(cosine: float, g: float) -> float:
    """Per steradian; cosine 1 is forward."""
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * cosine) ** 1.5)


def image(phase: Phase) -> np.ndarray:
    """Every pixel: the mean over its area, by Gauss-Legendre quadrature."""
    directions = VIEW.directions()
    seen = np.array([[radiance(direction, s, phase) for s in SIGMA_T] for direction in directions.reshape(-1, 3)])
    return np.concatenate([pixel_means(channel.reshape(directions.shape[:-1])) for channel in seen.T], axis=-1)


def radiance(direction: np.ndarray, sigma_t: float, phase: Phase) -> float:
    """Light scattered once into the camera ray."""

    start = NEAR / -direction[2]

    def source(t: float) -> float:
        to_point = t * direction - LIGHT
        distance = float(np.linalg.norm(to_point))
        cosine = float(-to_point @ direction) / distance
        return np.exp(-sigma_t * (t - start + distance)) * phase(cosine) / distance**2

    nearest = float(LIGHT @ direction)
    parts = (start, nearest - 1, nearest, nearest + 1, nearest + 5, nearest + 60 / sigma_t)
    total = sum(quad(source, low, high, epsrel=1e-8)[0] for low, high in zip(parts, parts[1:]))
    return INTENSITY * ALBEDO * sigma_t * total
