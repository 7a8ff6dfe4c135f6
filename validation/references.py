"""Mitsuba's batches of a scene, kept under target/ so that a second run costs nothing."""

from collections.abc import Callable

import numpy as np

from validation.compare import Effort, mitsuba_renderer, render_batches
from validation.places import CACHE
from validation.scene import Scene


def cached(scene: Scene, size=None, variant: str = "scalar_rgb") -> Callable[[Effort], np.ndarray]:
    """Reference batches by effort; rendered where they are not kept."""

    def batches(effort: Effort) -> np.ndarray:
        shape = "" if size is None else f"-{size[0]}x{size[1]}"
        shape += "" if variant == "scalar_rgb" else f"-{variant}"
        name = f"{scene.name}-{scene.key()}{shape}-{effort.batches}x{effort.spp}-{effort.seed}.npy"
        path = CACHE / name
        if path.is_file():
            return np.load(path)
        rendered = render_batches(mitsuba_renderer(scene, variant, size), effort)
        keep(path, rendered)
        return rendered

    return batches


def keep(path, batches: np.ndarray) -> None:
    """Writes so that no other process sees half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path.with_suffix(f".{np.random.default_rng().integers(1 << 40)}.partial"), "wb") as file:
        np.save(file, batches.astype(np.float32))
    file_path = path.parent / file.name
    file_path.replace(path)
