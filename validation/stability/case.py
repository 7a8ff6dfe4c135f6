"""One line of the stability table, and the scenes that its groups share."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyndall.scene import Scene, derived
from validation.closed_forms.case import BLACK, ISOTROPIC, NULL, SIZE, camera, medium, orthographic, rgb, scene

@dataclass(frozen=True)
class Sampled:
    """A truth with an error of its own: independent batches, each of which broadcasts to height x width x 3."""

    batches: np.ndarray


Known = float | np.ndarray | Sampled
"""Anything that broadcasts to height x width x 3."""
Truth = Known | Callable[[], Known]
"""What is known, or what makes it: for truths that take time."""

EYE = ("pt", "bdpt")
"""Methods for scenes that light tracing sees next to nothing of: a view as narrow as a beam."""
ALL = ("pt", "bdpt", "lt")
AIM, LIGHT_AIM = 0.02, 0.06
"""The relative error that a line is rendered to see, as far as its time allows; light tracing is several times as noisy."""
TRACKERS = ("exact", "march", "null_collision", "residual_ratio")
"""Of grids."""


def same(images: np.ndarray) -> np.ndarray:
    """Images as they are."""
    return images


def mean(images: np.ndarray) -> np.ndarray:
    """Of each image its mean, everywhere: for truths that are one."""
    return np.broadcast_to(images.mean(axis=(1, 2), keepdims=True), (len(images), SIZE, SIZE, images.shape[-1]))


@dataclass(frozen=True)
class Case:
    """A scene, its truth and how it is rendered."""

    row: str
    """The row of the table, in validation.md's words."""
    name: str
    scene: Scene
    truth: Truth
    methods: tuple[str, ...]
    """As `compare.options_of` reads them."""
    source: str
    """Where the truth comes from."""
    seen: Callable[[np.ndarray], np.ndarray] = same
    """What is made of images (batches, height, width, 3) before they are judged."""
    sensors: int = 1
    """All of the scene's, their images side by side."""

    flaw: str = ""
    """Why the renderer is known to be off here; the line is told as a known flaw as long as it is off by no more than:"""
    flawed_by: float = 0

    def expected(self) -> np.ndarray:
        """The truth as images: independent batches, or one without error."""
        known = self.truth() if callable(self.truth) else self.truth
        batches = known.batches if isinstance(known, Sampled) else np.asarray(known, dtype=float)[None]
        batches = batches.reshape(len(batches), *(1,) * (4 - batches.ndim), *batches.shape[1:])
        return np.broadcast_to(batches, (len(batches), SIZE, SIZE, 3))


def named(source: Scene, name: str) -> Scene:
    """The scene under a name that can be a file's."""
    return Scene(source.source, "".join(c if c.isalnum() or c in "-+." else " " for c in name), {}, source.base)


def lamp(radiance: float) -> dict:
    """An area light."""
    return {"type": "area", "radiance": rgb(radiance)}


OVEN_RADIUS = 3.0


def oven(name: str, radiance: float = 1, sides: dict = BLACK, **inside: Any) -> Scene:
    """A hollow sphere that shines inwards, seen from within: whatever absorbs nothing inside shows the radiance of the
    wall. Unlike the sky's, this furnace is one that light tracing can heat."""
    wall = {"type": "sphere", "radius": OVEN_RADIUS, "flip_normals": True, "bsdf": sides, "emitter": lamp(radiance)}
    return scene(name, sensor=camera((0, 0, 2.5), (0, 0, 0), 50), wall=wall, **inside)


def ball(interior: dict, bsdf: dict = NULL) -> dict:
    """A unit sphere of medium."""
    return {"type": "sphere", "bsdf": bsdf, "interior": interior}


def fog(sigma_t: float | tuple[float, ...], albedo: float, g: float = 0) -> dict:
    """A homogeneous medium."""
    return medium(sigma_t, albedo, {"type": "hg", "g": g} if g else ISOTROPIC)


def parallel(half_width: float) -> dict:
    """An orthographic view from z = 3 along -z."""
    return orthographic((0, 0, 3), (0, 0, 0), half_width)


SHAPES = ("sphere", "rectangle", "cube", "disk", "cylinder", "obj", "ply")
VOLUMES = ("gridvolume", "constvolume")
MEDIA = ("homogeneous", "heterogeneous")


def scaled(source: Scene, size: float) -> Scene:
    """The scene so many times as large, extinctions as many times smaller: the same image."""

    def larger(o: dict) -> dict:
        kind = o["type"]
        if kind in SHAPES or kind in VOLUMES:
            return {**o, "to_world": [*o.get("to_world", []), {"type": "scale", "value": size}]}
        if kind == "perspective":
            return {**o, "near_clip": size * o.get("near_clip", 0.01), "far_clip": size * o.get("far_clip", 1e4)}
        if kind == "lookat":
            return {**o, "origin": times(o["origin"], size), "target": times(o["target"], size)}
        if kind == "point":
            return {**o, "position": times(o["position"], size), "intensity": rgb(*times(o["intensity"]["value"], size**2))}
        return {**o, "scale": o.get("scale", 1) / size} if kind in MEDIA else o

    return named(derived(source, larger), f"{source.name} x {size:g}")


def moved(source: Scene, by: tuple[float, ...]) -> Scene:
    """The scene elsewhere."""
    step = {"type": "translate", "value": list(by)}

    def elsewhere(o: dict) -> dict:
        if o["type"] in (*SHAPES, *VOLUMES, "perspective", "orthographic"):
            return {**o, "to_world": [*o.get("to_world", []), step]}
        if o["type"] == "point":
            return {**o, "position": [a + b for a, b in zip(o["position"], by)]}
        return o

    return named(derived(source, elsewhere), f"{source.name} moved")


def times(values: list[float], factor: float) -> list[float]:
    """Each of them times the factor."""
    return [factor * v for v in values]


def with_object(source: Scene, name: str, **changes: object) -> Scene:
    """The scene with one of its objects changed."""
    tree = source.dictionary()
    return Scene({**tree, name: {**tree[name], **changes}}, source.name, {}, source.base)
