"""Density functions as grids: what Mitsuba gets in their place. A grid covers the box of the shape that holds the medium,
fine enough that what it smooths away is far below what a comparison resolves."""

import hashlib
import json
from typing import Any

import numpy as np

from tyndall.failure import Failure
from tyndall.load_dict import translated
from tyndall.scene import changed
from tyndall.volume_file import vol
from validation import densities
from validation.places import TARGET

FOLDER = TARGET / "validation-baked"
RESOLUTION = 64
"""Voxels a side."""


def baked(tree: dict) -> dict:
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
    key = json.dumps([function, box.tolist(), time, RESOLUTION], sort_keys=True)
    path = FOLDER / f"{hashlib.sha256(key.encode()).hexdigest()[:20]}.vol"
    steps = (np.arange(RESOLUTION) + 0.5) / RESOLUTION
    z, y, x = np.meshgrid(steps, steps, steps, indexing="ij")
    values = densities.value(function, box[0] + np.stack([x, y, z], axis=-1) * (box[1] - box[0]), time)
    if values.min() < 0:
        raise Failure(f"the density {function['type']} is negative at some places", "raise its constant")
    path.write_bytes(vol(values))
    to_world = [{"type": "scale", "value": (box[1] - box[0]).tolist()}, {"type": "translate", "value": box[0].tolist()}]
    return {"type": "gridvolume", "filename": str(path), "to_world": to_world}
