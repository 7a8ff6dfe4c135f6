"""Mitsuba's batches of a scene, kept under target/ so that a second run costs nothing."""

import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.compare import Effort, Size, mitsuba_renderer, render_batches
from validation.places import CACHE
from validation.scene import Scene


@dataclass
class Cached:
    """Reference batches by effort; rendered where they are not kept."""

    scene: Scene
    size: Size = None
    variant: str = "scalar_rgb"
    seconds: float | None = None
    """That the last batches took when they were rendered; None if not known."""

    def __call__(self, effort: Effort) -> np.ndarray:
        path = self.path(effort)
        told = path.with_suffix(".json")
        if path.is_file():
            self.seconds = json.loads(told.read_text()) if told.is_file() else None
            return np.load(path)
        start = time.perf_counter()
        rendered = render_batches(mitsuba_renderer(self.scene, self.variant, self.size), effort)
        self.seconds = time.perf_counter() - start
        keep(told, json.dumps(self.seconds))
        keep(path, rendered)
        return rendered

    def path(self, effort: Effort) -> Path:
        """The file of batches."""
        shape = "" if self.size is None else f"-{self.size[0]}x{self.size[1]}"
        shape += "" if self.variant == "scalar_rgb" else f"-{self.variant}"
        return CACHE / f"{self.scene.name}-{self.scene.key()}{shape}-{effort.batches}x{effort.spp}-{effort.seed}.npy"


def cached(scene: Scene, size: Size = None, variant: str = "scalar_rgb") -> Cached:
    """The reference batches of a scene."""
    return Cached(scene, size, variant)


def keep(path: Path, content: np.ndarray | str) -> None:
    """Writes so that no other process sees half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(f".{np.random.default_rng().integers(1 << 40)}.partial")
    if isinstance(content, str):
        partial.write_text(content)
    else:
        with partial.open("wb") as file:
            np.save(file, content.astype(np.float32))
    partial.replace(path)
