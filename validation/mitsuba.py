"""Mitsuba 3 as a renderer of our scenes: images in linear RGB, (height, width, 3)."""

import os
from functools import cache
from glob import glob
from pathlib import Path
from threading import RLock
from typing import Any

import mitsuba as mi
import numpy as np

from tyndall.failure import Failure
from tyndall.scene import Scene, changed

TRANSFORM_STEPS = ("scale", "rotate", "translate", "lookat", "matrix")
OUR_INTEGRATORS = ("bdpt", "pt", "lt")
ROULETTE = {True: 24, False: 1000}
"""From which depth Mitsuba ends paths at random, for unlimited and for limited depth. Its default, 5, makes much
noise; without any, paths of unlimited depth in a closed room would go on until their weight underflows."""
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


def use(variant: str) -> None:
    """Chooses `scalar_rgb` or `llvm_ad_rgb` (which needs LLVM 19)."""
    if variant.startswith("llvm"):
        path = libllvm()
        if path is None:
            raise Failure("LLVM 19 was not found", "install it (Debian: libllvm19) or set DRJIT_LIBLLVM_PATH to its library")
        os.environ["DRJIT_LIBLLVM_PATH"] = path
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)  # what it rounds and clamps is not what the table is about


def load(scene: Scene, variant: str = "scalar_rgb", size: tuple[int, int] | None = None) -> Any:
    """The scene as a Mitsuba object, its variant made the current one."""
    from validation import bake  # it needs this module

    use(variant)
    try:
        if scene.is_xml:
            loaded = load_file(scene)
            return loaded if size is None else with_size(loaded, size)
        tree = changed(bake.baked(scene.dictionary()), lambda o: translate_object(o, scene.folder, size))
        return mi.load_dict(tree)
    except (RuntimeError, TypeError, ValueError) as error:
        problem = f"Mitsuba cannot load {scene.name} ({variant}): {error}"
        raise Failure(problem, "name a scene that Mitsuba has all plugins of, or contenders without Mitsuba")


def render(scene: Scene, spp: int, seed: int = 0, variant: str = "scalar_rgb", size: tuple[int, int] | None = None) -> np.ndarray:
    """One image. To render several, `load` once and call `image`."""
    return image(load(scene, variant, size), spp, seed)


def image(loaded: Any, spp: int, seed: int, integrator: Any = None) -> np.ndarray:
    """One image of a loaded scene, by its own integrator or another one that is loaded."""
    return np.array(mi.render(loaded, integrator=integrator, spp=spp, seed=seed), dtype=np.float64)[:, :, :3]


def load_file(scene: Scene) -> Any:
    """An XML scene with its parameters."""
    parameters: dict[str, Any] = dict(scene.parameters)
    return mi.load_file(str(scene.source), **parameters)


def with_size(loaded: Any, size: tuple[int, int]) -> Any:
    """Changes the film of a loaded scene."""
    parameters = mi.traverse(loaded.sensors()[0])
    parameters["film.size"] = list(size)
    parameters.update()
    return loaded


def translate_object(o: dict, folder: Path, size: tuple[int, int] | None) -> dict:
    """What `mitsuba.load_dict` needs otherwise than our JSON spells it."""
    out = {key: transform(value) if is_transform(value) else value for key, value in o.items()}
    if o["type"] in OUR_INTEGRATORS:
        kept = {key: o[key] for key in ("max_depth", "rr_depth", "hide_emitters") if key in o}
        return {"type": "volpath", "rr_depth": ROULETTE[o.get("max_depth", -1) < 0], **kept}
    if o["type"] == "scene":
        out.pop("time", None)
    if o["type"] == "heterogeneous":
        for ours in ("tracker", "step", "march_error"):
            out.pop(ours, None)  # Mitsuba has only one way
    if "filename" in o:
        out["filename"] = str(folder / o["filename"])  # an absolute name stays itself
    if size and o["type"] == "hdrfilm":
        out["width"], out["height"] = size
    return out


def is_transform(value: Any) -> bool:
    """A transform is a list of steps."""
    return isinstance(value, list) and all(isinstance(s, dict) and s.get("type") in TRANSFORM_STEPS for s in value)


def transform(steps: list[dict]) -> Any:
    """The product of all steps, the first applied first."""
    product = mi.ScalarTransform4f()
    for s in steps:
        product = step(s) @ product
    return product


def step(s: dict) -> Any:
    """One step of a transform."""
    identity = mi.ScalarTransform4f()
    match s["type"]:
        case "scale":
            return identity.scale(s["value"])
        case "rotate":
            return identity.rotate(s["axis"], s["angle"])
        case "translate":
            return identity.translate(s["value"])
        case "lookat":
            return identity.look_at(s["origin"], s["target"], s["up"])
        case "matrix":
            return mi.ScalarTransform4f(np.reshape(s["value"], (4, 4)))
