"""Scenes as dictionaries of `mitsuba.load_dict`, and back. Mitsuba is only needed for what becomes its objects."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import schema
from tyndall.failure import Failure
from tyndall.scene import AnyScene, changed, integrator, load
from tyndall.spelling import Speller, files

TRANSFORM_STEPS = ("scale", "rotate", "translate", "lookat", "matrix")
OUR_INTEGRATORS = ("bdpt", "pt", "lt")
OURS = {"scene": ("time",), "heterogeneous": ("tracker", "step", "march_error")}
"""Parameters that Mitsuba has not, and whose absence changes no image: it knows one time and one way."""
ROULETTE = {True: 24, False: 1000}
"""From which depth Mitsuba ends paths at random, for unlimited and for limited depth. Its default, 5, makes much
noise; without any, paths of unlimited depth in a closed room would go on until their weight underflows."""


def from_mitsuba(tree: Mapping[str, Any], folder: str | Path | None = None) -> dict[str, Any]:
    """The dictionary of a scene for `mitsuba.load_dict` in our spelling, of plain values only: numbers and points of numpy and
    Dr.Jit become JSON's, transforms lists of steps. Arrays that stand for a file become files in `folder`, so that the
    whole can be written by `json.dump`; without one they stay, as numpy arrays. (`tyndall.render` takes Mitsuba's dictionaries as they are.)"""
    if folder is not None:
        Path(folder).mkdir(parents=True, exist_ok=True)
    return Speller(None if folder is None else Path(folder).resolve()).object(tree, "$")


def to_mitsuba(scene: AnyScene, parameters: Mapping[str, object] | None = None) -> dict[str, Any]:
    """The scene as `mitsuba.load_dict` takes it; a variant of Mitsuba must have been set. Lists of steps and matrices become
    transforms, arrays bitmaps and grids, names of files whole; whole numbers become floats where any number may stand, and colours
    of media above 1 volumes; `bdpt`, `pt` and `lt`, and no integrator at all, become `volpath`, which estimates the same image.
    Plugins that Mitsuba has not remain, and it will refuse them."""
    tree = load(scene, parameters)
    own = {} if integrator(tree) else {"integrator": {"type": "bdpt"}}
    return changed({**tree, **own}, translated)


def translated(o: dict[str, Any]) -> dict[str, Any]:
    """What `mitsuba.load_dict` needs otherwise than our JSON spells it."""
    kind = o["type"]
    if kind in OUR_INTEGRATORS:
        kept: dict[str, Any] = {key: o[key] for key in ("max_depth", "min_depth", "rr_depth", "hide_emitters") if key in o}
        return {"type": "volpath", "rr_depth": ROULETTE[o.get("max_depth", -1) < 0], **kept}
    out = {key: typed(parameter(key, value), schema.row(kind, key)) for key, value in o.items() if key not in OURS.get(kind, ()) and key not in files(o)}
    return out | {HOLDERS[name]: holder(name, o[key]) for key, name in files(o).items()}


def typed(value: Any, row: dict[str, Any]) -> Any:
    """The value as Mitsuba takes it for the parameter that the row of the schema describes. It refuses a whole number where any may
    stand, and takes a colour in place of a volume for a reflectance: above 1 it has to be a `constvolume`."""
    if type(value) is int and schema.is_real(row):
        return float(value)
    return {"type": "constvolume", "value": value} if schema.is_volume(row) and exceeds_one(value) else value


def exceeds_one(value: Any) -> bool:
    """True for a colour with a channel above 1."""
    channels = value.get("value") if isinstance(value, dict) and value.get("type") == "rgb" else None
    return isinstance(channels, (int, float, list)) and bool(np.max(channels) > 1)


HOLDERS = {"picture": "bitmap", "voxels": "grid"}
"""The parameters that hold Mitsuba's objects for files; its tensors, in `data`, are empty once they have been loaded."""


def holder(name: str, value: Any) -> Any:
    """The object for an array that stands for a file; one of Mitsuba's own stays."""
    if hasattr(value, "write"):
        return value
    kind = mitsuba().Bitmap if name == "picture" else mitsuba().VolumeGrid
    return kind(np.ascontiguousarray(np.array(value), dtype=np.float32))


def parameter(key: str, value: Any) -> Any:
    """One value."""
    if isinstance(value, np.generic):
        return value.item()
    if is_transform(value):
        return transform(value)
    return array(key, value) if isinstance(value, np.ndarray) else value


def array(key: str, value: np.ndarray) -> Any:
    """A matrix as a transform, other numbers as a list."""
    kinds = {(4, 4): "ScalarTransform4f", (3, 3): "ScalarTransform3f"} if key.startswith("to_") else {}
    return getattr(mitsuba(), kinds[value.shape])(value.tolist()) if value.shape in kinds else value.tolist()


def mitsuba() -> Any:
    """The package, with a variant."""
    try:
        import mitsuba as mi
    except ImportError:
        raise Failure("Mitsuba is not installed", "pip install mitsuba") from None
    if mi.variant() is None:
        raise Failure("Mitsuba has no variant yet", 'call mitsuba.set_variant("scalar_rgb") first')
    return mi


def is_transform(value: Any) -> bool:
    """A transform is a list of steps."""
    return isinstance(value, list) and all(isinstance(s, dict) and s.get("type") in TRANSFORM_STEPS for s in value)


def transform(steps: list[dict[str, Any]]) -> Any:
    """The product of all steps, the first applied first."""
    product = mitsuba().ScalarTransform4f()
    for s in steps:
        product = step(s) @ product
    return product


def step(s: dict[str, Any]) -> Any:
    """One step of a transform."""
    identity = mitsuba().ScalarTransform4f()
    match s["type"]:
        case "scale":
            return identity.scale(s["value"])
        case "rotate":
            axis = np.broadcast_to(np.asarray(s["axis"], dtype=float), 3)
            # Mitsuba 3.9.1 rotates about unit vectors only; by others it shears.
            return identity.rotate(axis / np.linalg.norm(axis), s["angle"])
        case "translate":
            return identity.translate(s["value"])
        case "lookat":
            return identity.look_at(s["origin"], s["target"], s["up"])
        case "matrix":
            return mitsuba().ScalarTransform4f(np.reshape(s["value"], (4, 4)))
