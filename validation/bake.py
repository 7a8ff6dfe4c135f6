"""Substitutes for what Mitsuba lacks: density functions as grids, OpenVDB's grids as its own files, phase functions as tables. The
grid of a function covers the box of the shape that holds the medium. It is so fine that what it smooths away is far below what a
comparison resolves."""

import hashlib
import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import program
from tyndall.failure import Failure
from tyndall.load_dict import translated
from tyndall.scene import changed
from tyndall.volume_file import vol
from validation import densities, phases
from validation.places import TARGET

FOLDER = TARGET / "validation-baked"
FEWEST, MOST = 16, 2**22
"""Voxels along a side, and of a whole grid."""
ERROR = 1e-3
"""What lines between voxels may be off on average, over the mean; with MOST, where the function jumps, they are more."""
PLACES = 4096
"""Where that is looked at."""
SPARSE = (".vdb", ".nvdb")
"""Files of volumes that Mitsuba does not read."""


def baked(tree: dict, folder: Path) -> dict:
    """The scene as Mitsuba knows all of it; names of files in it start at `folder`."""
    return with_grids(changed(tree, lambda o: known(o, folder)))


def known(o: dict, folder: Path) -> dict:
    """An object by itself."""
    if phases.is_function(o):
        return phases.tabulated(o)
    is_sparse = o["type"] == "gridvolume" and Path(o.get("filename", "")).suffix.lower() in SPARSE
    return {**without(o, "grid"), "filename": str(dense(folder / o["filename"], o.get("grid")))} if is_sparse else o


def without(o: dict, key: str) -> dict:
    """All but one parameter."""
    return {name: value for name, value in o.items() if name != key}


def dense(path: Path, name: str | None) -> Path:
    """Mitsuba's file of a grid of an OpenVDB or NanoVDB file, the grid of that name; it is kept."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    key = hashlib.sha256(path.read_bytes() + repr(name).encode()).hexdigest()
    kept = FOLDER / f"{key[:20]}.vol"
    if not kept.is_file():
        program.call([str(program.binary()), "convert", *program.flags({"grid": name}), str(path), str(kept)])
    return kept


def with_grids(tree: dict) -> dict:
    """The scene with every density function in a medium baked to a grid."""
    media = {id(medium): medium for medium in (*tree.values(), *map(interior, tree.values())) if varies(medium)}
    grids = {key: grids_of(tree, medium) for key, medium in media.items()}
    return {name: replaced(child, grids) for name, child in tree.items()} if grids else tree


def interior(o: Any) -> Any:
    """What a shape holds."""
    return o.get("interior") if isinstance(o, dict) else None


def varies(o: Any) -> bool:
    """True for a medium with a density function in it."""
    return isinstance(o, dict) and o.get("type") == "heterogeneous" and any(map(densities.is_function, o.values()))


def replaced(child: Any, grids: dict) -> Any:
    """A child of the scene with its medium, or itself, as grids."""
    if id(child) in grids:
        return grids[id(child)]
    inner = interior(child)
    return {**child, "interior": grids[id(inner)]} if id(inner) in grids else child


def grids_of(tree: dict, medium: dict) -> dict:
    """The medium with grids for functions."""
    box = box_of(tree, medium)
    time = tree.get("time", 0.0)
    return {key: grid(o, box, time) if densities.is_function(o) else o for key, o in medium.items()}


def box_of(tree: dict, medium: dict) -> np.ndarray:
    """The box around the one shape that holds the medium: its two corners."""
    name = next((name for name, child in tree.items() if child is medium), None)
    held = lambda o: interior(o) is medium or (name and interior(o) == {"type": "ref", "id": name})
    shapes = [child for child in tree.values() if held(child)]
    if len(shapes) != 1:
        held_by = f"a density function in a medium that {len(shapes)} shapes hold"
        raise Failure(f"{held_by} cannot be baked", "let one shape hold it")
    kept = {k: v for k, v in shapes[0].items() if k not in ("bsdf", "interior", "exterior", "emitter")}
    import mitsuba as mi

    box = mi.load_dict(changed(kept, translated)).bbox()
    return np.array([box.min, box.max], dtype=float)


def grid(function: dict, box: np.ndarray, time: float) -> dict:
    """The function as a gridvolume on the box; its file is kept."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    key = json.dumps([function, box.tolist(), time, FEWEST, MOST, ERROR], sort_keys=True)
    path = FOLDER / f"{hashlib.sha256(key.encode()).hexdigest()[:20]}.vol"
    if not path.is_file():
        partial = path.with_suffix(f".{os.getpid()}")
        partial.write_bytes(vol(sampled(function, box, time)))
        partial.replace(path)
    to_world = [{"type": "scale", "value": (box[1] - box[0]).tolist()}, {"type": "translate", "value": box[0].tolist()}]
    return {"type": "gridvolume", "filename": str(path), "to_world": to_world}


def sampled(function: dict, box: np.ndarray, time: float) -> np.ndarray:
    """The function at the middles of voxels, (z, y, x) or (z, y, x, 3)."""
    counts = voxels(function, box, time)
    x, y, z = (corner + (np.arange(n) + 0.5) / n * side for n, corner, side in zip(counts, box[0], box[1] - box[0]))
    values = densities.value(function, np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).transpose(2, 1, 0, 3), time)
    if values.min() < 0:
        raise Failure(f"the density {function['type']} is negative at some places", "raise its constant")
    return values


def voxels(function: dict, box: np.ndarray, time: float) -> list[int]:
    """How many along x, y and z."""
    counts = [FEWEST] * 3
    while math.prod(counts) < MOST:
        errors = [smoothed(function, box, time, axis, counts[axis]) for axis in range(3)]
        worst = int(np.argmax(errors))
        if errors[worst] <= ERROR:
            break
        counts[worst] *= 2
    return counts


def smoothed(function: dict, box: np.ndarray, time: float, axis: int, count: int) -> float:
    """The error of linear interpolation between so many voxels along an axis, over the mean of the function: both at random places."""
    half = np.eye(3)[axis] * (box[1] - box[0]) / (2 * count)
    at = np.random.default_rng(0).uniform(box[0] + half, box[1] - half, (PLACES, 3))
    below, here, above = (densities.value(function, at + step, time) for step in (-half, 0, half))
    return float(np.abs((below + above) / 2 - here).mean() / max(here.mean(), np.finfo(float).tiny))
