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
    to_world = [{"type": "lookat", "origin": list(origin), "target": list(target), "up": list(up)}]
    return {"type": "perspective", "fov": fov, "to_world": to_world, "film": film(SIZE, SIZE), "sampler": {"type": "independent"}, **more}


def orthographic(origin: Sequence[float], target: Sequence[float], half_width: float) -> dict[str, Any]:
    """The same by parallel rays."""
    view = camera(origin, target, 1)
    step = {"type": "scale", "value": [half_width, half_width, 1]}
    return {**{k: v for k, v in view.items() if k != "fov"}, "type": "orthographic", "to_world": [step, *view["to_world"]]}


def film(width: int, height: int) -> dict[str, Any]:
    """Pixels that hold what falls into them."""
    return {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb", "rfilter": {"type": "box"}}


def rgb(*value: float) -> dict[str, Any]:
    """A colour, grey if one number is given."""
    return {"type": "rgb", "value": [float(v) for v in (value if len(value) == 3 else 3 * value)]}


def diffuse(*reflectance: float) -> dict[str, Any]:
    """A matt surface."""
    return {"type": "diffuse", "reflectance": rgb(*reflectance)}


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


SKY = {"type": "constant", "radiance": rgb(1)}
BLACK = diffuse(0)
NULL = {"type": "null"}
ISOTROPIC = {"type": "isotropic"}
