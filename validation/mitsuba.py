"""Mitsuba 3 as a renderer of our scenes, what it has not being baked: images in linear RGB, (height, width, 3)."""

from typing import Any

import numpy as np

from tyndall import mitsuba
from tyndall.mitsuba import ALONE as ALONE
from tyndall.mitsuba import LLVM_PLACES as LLVM_PLACES
from tyndall.mitsuba import image as image
from tyndall.mitsuba import libllvm as libllvm
from tyndall.mitsuba import package as package
from tyndall.mitsuba import use as use
from tyndall.scene import Scene


def load(scene: Scene, variant: str = "scalar_rgb", size: tuple[int, int] | None = None) -> Any:
    """The scene as a Mitsuba object, its variant made the current one."""
    return mitsuba.load(scene, variant, size, baked)


def baked(scene: Scene) -> Scene:
    """The scene as Mitsuba knows all of it."""
    from validation import bake, smoke  # they need Mitsuba's package

    return Scene(bake.baked(smoke.unfolded(scene), scene.folder), scene.name, {}, scene.folder)


def render(scene: Scene, spp: int, seed: int = 0, variant: str = "scalar_rgb", size: tuple[int, int] | None = None) -> np.ndarray:
    """One image. To render several, `load` once and call `image`."""
    return image(load(scene, variant, size), spp, seed)
