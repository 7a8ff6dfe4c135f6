"""Mitsuba's images of scenes, as means and errors: kept under target/ so that a second run costs nothing and, of the scenes
that every test run compares, in the repository so that it needs no Mitsuba."""

import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from tyndall.failure import Failure
from tyndall.judging import Measured
from tyndall.scene import Scene
from validation import mitsuba
from validation.compare import Effort, Renderer, Size, mitsuba_renderer
from validation.places import CACHE, RECORDED
from tyndall.statistics import Estimate


@dataclass
class Cached:
    """Mitsuba's images of a scene by effort; rendered where they are not kept."""

    scene: Scene
    size: Size = None
    variant: str = "scalar_rgb"
    seconds: float | None = None
    """That the last images took when they were rendered."""

    def __call__(self, effort: Effort) -> Measured:
        path = self.path(effort)
        with mitsuba.ALONE:  # who waited finds what was rendered meanwhile
            if not path.is_file():
                start = time.perf_counter()
                measured = mitsuba_renderer(self.scene, self.variant, self.size)(effort)
                keep(path, measured, seconds=np.array(time.perf_counter() - start))
        with np.load(path) as kept:
            self.seconds = float(kept["seconds"])
            return measured_of(kept, effort)

    def path(self, effort: Effort) -> Path:
        """The file that keeps them."""
        shape = "" if self.size is None else f"-{self.size[0]}x{self.size[1]}"
        shape += "" if self.variant == "scalar_rgb" else f"-{self.variant}"
        return CACHE / f"{self.scene.name}-{self.scene.key()}{shape}-{effort.batches}x{effort.spp}-{effort.seed}.npz"


def cached(scene: Scene, size: Size = None, variant: str = "scalar_rgb") -> Cached:
    """Mitsuba's images of a scene, rendered at most once."""
    return Cached(scene, size, variant)


def recorded(scene: Scene, effort: Effort, variant: str = "scalar_rgb") -> Renderer:
    """What the repository keeps of the scene, rendered with `effort` whatever is asked for."""
    return lambda _: read(scene, effort, variant)


def read(scene: Scene, effort: Effort, variant: str) -> Measured:
    """An image of the repository, if it is of this very scene."""
    path = RECORDED / f"{scene.name}.npz"
    remedy = f"run python3 -m validation matrix --record --only {scene.name}"
    if not path.is_file():
        raise Failure(f"{path}: Mitsuba's image of the scene was expected and is not there", remedy)
    with np.load(path) as kept:
        if str(kept["key"]) != key_of(scene, effort, variant):
            raise Failure(f"{path} is of other files of this scene, of another Mitsuba or of another effort", remedy)
        return measured_of(kept, effort)


def record(scene: Scene, effort: Effort, variant: str = "scalar_rgb") -> None:
    """Renders what `recorded` reads."""
    keep(RECORDED / f"{scene.name}.npz", cached(scene, variant=variant)(effort), key=np.array(key_of(scene, effort, variant)))


def key_of(scene: Scene, effort: Effort, variant: str) -> str:
    """Changes whenever Mitsuba's images would."""
    return f"{scene.key()} {effort.batches}x{effort.spp}-{effort.seed} {variant} {version('mitsuba')}"


PARTS = ("pixels", "tiles", "whole")


def keep(path: Path, measured: Measured, **more: np.ndarray) -> None:
    """Writes so that no other process sees half a file."""
    parts = {name: getattr(measured, name) for name in PARTS}
    arrays = {name: part.mean for name, part in parts.items()} | {f"{name}_error": part.error for name, part in parts.items()}
    content: dict[str, Any] = {name: values.astype(np.float32) for name, values in arrays.items()} | more
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{np.random.default_rng().integers(1 << 40)}.partial")
    with partial.open("wb") as file:
        np.savez_compressed(file, **content)
    partial.replace(path)


def measured_of(kept: np.lib.npyio.NpzFile, effort: Effort) -> Measured:
    """What `keep` wrote."""
    of = lambda name: Estimate(kept[name].astype(float), kept[f"{name}_error"].astype(float) ** 2, effort.batches - 1)
    return Measured(*map(of, PARTS))
