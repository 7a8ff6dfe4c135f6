"""One scene with its truth, and the parts that these scenes share."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from tyndall.scene import Scene

SIZE = 8
"""Pixels a side: the truth is smooth, so few pixels with many samples tell most."""


@dataclass(frozen=True)
class Case:
    """A scene, the truth (anything that broadcasts to height x width x 3), its methods, its relative effort, and by method
    what part of that the quick level takes, if not all: 0 leaves to the full level what costs much and other cases show."""

    scene: Scene
    truth: np.ndarray | float
    methods: tuple[str, ...] = ("pt", "bdpt")
    effort: float = 1
    quick: Mapping[str, float] = field(default_factory=lambda: {"pt:march": 0.5})

    def image(self) -> np.ndarray:
        """The truth as an image."""
        return np.broadcast_to(np.asarray(self.truth, dtype=float), (SIZE, SIZE, 3))


def scene(name: str, max_depth: int = -1, **objects: Any) -> Scene:
    """A scene from its parts."""
    # Where Mitsuba stands in as the renderer, a late roulette keeps the noise low.
    integrator = {"type": "volpath", "max_depth": max_depth, "rr_depth": 200}
    return Scene({"type": "scene", "integrator": integrator, **objects}, name)


def camera(origin: Sequence[float], target: Sequence[float], fov: float, up: Sequence[float] = (0, 1, 0), **more: Any) -> dict[str, Any]:
    """A small square image, box filter."""
    return {
        "type": "perspective",
        "fov": fov,
        "to_world": [{"type": "lookat", "origin": list(origin), "target": list(target), "up": list(up)}],
        "film": {
            "type": "hdrfilm",
            "width": SIZE,
            "height": SIZE,
            "pixel_format": "rgb",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
        **more,
    }


def medium(sigma_t: npt.ArrayLike, albedo: Any, phase: dict) -> dict:
    """A homogeneous medium; its extinction as a colour within Mitsuba's range, times a scale."""
    colour = np.broadcast_to(np.asarray(sigma_t, dtype=float), 3)
    scale = float(colour.max())
    return {
        "type": "homogeneous",
        "sigma_t": {"type": "rgb", "value": [float(c) / scale for c in colour]},
        "scale": scale,
        "albedo": float(albedo),
        "phase": phase,
    }


SKY = {"type": "constant", "radiance": {"type": "rgb", "value": [1, 1, 1]}}
