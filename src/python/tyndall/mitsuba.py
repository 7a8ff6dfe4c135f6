"""Mitsuba 3 as a renderer of our scenes: images in linear RGB, (height, width, 3)."""

import os
from collections.abc import Callable
from functools import cache
from glob import glob
from pathlib import Path
from threading import RLock
from typing import Any

import numpy as np

from tyndall.failure import Failure
from tyndall.load_dict import to_mitsuba
from tyndall.scene import Scene, changed

Prepared = Callable[[Scene], Scene]

ALONE = RLock()
"""Held by whoever loads and renders: the variant is Mitsuba's, not a scene's, and it uses all processors by itself."""
LLVM_PLACES = (
    "/usr/lib/*/libLLVM.so.19*",
    "/usr/lib/*/libLLVM-19.so*",
    "/usr/lib/llvm-19/lib/libLLVM*.so*",
    "/usr/lib64/libLLVM.so.19*",
    "/usr/lib64/llvm19/lib/libLLVM*.so*",
    "/opt/homebrew/opt/llvm@19/lib/libLLVM.dylib",
)


@cache
def libllvm() -> str | None:
    """Where LLVM 19 is; None where it is not."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    return named or next((path for place in LLVM_PLACES for path in sorted(glob(place))), None)


def package() -> Any:
    """The package `mitsuba`, imported once it is needed."""
    try:
        import mitsuba as mi
    except ImportError as error:
        raise Failure(f"Mitsuba is not there: {error}", "pip install mitsuba==3.9.1 scipy, or tyndall[compare] in place of tyndall") from None
    return mi


def use(variant: str) -> None:
    """Chooses `scalar_rgb` or `llvm_ad_rgb` (which needs LLVM 19)."""
    if variant.startswith("llvm"):
        path = libllvm()
        if path is None:
            raise Failure("LLVM 19 was not found", "install it (Debian: libllvm19) or set DRJIT_LIBLLVM_PATH to its library")
        os.environ["DRJIT_LIBLLVM_PATH"] = path
    mi = package()
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)  # what it rounds and clamps is not what the table is about


def load(scene: Scene, variant: str = "scalar_rgb", size: tuple[int, int] | None = None, prepared: Prepared = lambda scene: scene) -> Any:
    """The scene as a Mitsuba object, its variant made the current one. A scene in JSON is `prepared` first: for plugins that
    Mitsuba has not."""
    use(variant)
    try:
        if scene.is_xml:
            loaded = load_file(scene)
            return loaded if size is None else with_size(loaded, size)
        tree = to_mitsuba(prepared(scene))
        return package().load_dict(changed(tree, lambda o: sized(o, size)))
    except (RuntimeError, TypeError, ValueError) as error:
        problem = f"Mitsuba cannot load {scene.name} ({variant}): {error}"
        raise Failure(problem, "name a scene that Mitsuba has all plugins of, or contenders without Mitsuba")


def image(loaded: Any, spp: int, seed: int, integrator: Any = None) -> np.ndarray:
    """One image of a loaded scene, by its own integrator or another one that is loaded."""
    return np.array(package().render(loaded, integrator=integrator, spp=spp, seed=seed), dtype=np.float64)[:, :, :3]


def load_file(scene: Scene) -> Any:
    """An XML scene with its parameters."""
    parameters: dict[str, Any] = dict(scene.parameters)
    return package().load_file(str(scene.source), **parameters)


def with_size(loaded: Any, size: tuple[int, int]) -> Any:
    """Changes the film of a loaded scene."""
    parameters = package().traverse(loaded.sensors()[0])
    parameters["film.size"] = list(size)
    parameters.update()
    return loaded


def sized(o: dict, size: tuple[int, int] | None) -> dict:
    """A film of that size, if it is one."""
    return {**o, "width": size[0], "height": size[1]} if size and o["type"] == "hdrfilm" else o
