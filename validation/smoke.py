"""Smoke as Mitsuba knows it: a cube of `null` around a medium made of a grid. The program says which grid of which file it takes, and
which way is up."""

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import program
from tyndall.failure import Failure
from tyndall.scene import Scene, changed, scene_file
from validation import bake

Z_TO_Y = {"type": "rotate", "axis": [1, 0, 0], "angle": -90}


def unfolded(scene: Scene) -> dict[str, Any]:
    """The scene with a cube in place of each smoke; only of scenes in JSON."""
    tree = scene.dictionary()
    if '"type": "smoke"' not in json.dumps(tree):
        return tree
    told = iter(told_of(Scene(tree, scene.name, {}, scene.folder)))
    moves = any(isinstance(o, dict) and o.get("shutter_close", 0) > o.get("shutter_open", 0) for o in tree.values())
    return changed(tree, lambda o: container(o, next(told), moves) if o["type"] == "smoke" else o)


def told_of(scene: Scene) -> list[dict[str, Any]]:
    """What the program makes of each smoke, in the order of the scene."""
    with tempfile.TemporaryDirectory() as folder:
        path = scene_file(scene, Path(folder))
        found: list[dict[str, Any]] = json.loads(program.call([str(program.binary()), "info", "--json", str(path)]).stdout)["smoke"]
    return found


def container(o: dict[str, Any], told: dict[str, Any], moves: bool) -> dict[str, Any]:
    """The cube with the medium in it."""
    for found, remedy in foreign(o, told, moves):
        raise Failure(f"the smoke {told['name']}: found {found}, which Mitsuba's media have not", remedy)
    named = {"grid": told["density"]} if told["density"] else {}
    grid = bake.known({"type": "gridvolume", "filename": told["file"], "use_grid_bbox": True, **named}, Path.cwd())
    turn = [Z_TO_Y] if told["up"] == "z" else []
    to_world = [*turn, {"type": "scale", "value": o.get("scale", 1.0)}, *o.get("to_world", [])]
    around = {"exterior": o["exterior"]} if "exterior" in o else {}
    inside = medium(o, {**grid, "to_world": to_world})
    return {"type": "cube", "to_world": fit(grid["filename"]) + to_world, "bsdf": {"type": "null"}, "interior": inside, **around}


def foreign(o: dict[str, Any], told: dict[str, Any], moves: bool) -> Iterator[tuple[str, str]]:
    """What Mitsuba has not, and how the smoke can do without it."""
    if told["temperature"] is not None:
        yield "light from its file", 'remove it by "emission_scale": 0'
    if told["color"]:
        yield "colours from its file", 'remove them by "color_grid": ""'
    if o.get("level_set_to_fog"):
        yield "a level set that is filled", 'name a grid of densities by "density_grid"'
    if moves and o.get("velocity_grid") != "":
        yield "motion while the shutter is open", 'remove it by "velocity_grid": ""'


def medium(o: dict[str, Any], grid: dict[str, Any]) -> dict[str, Any]:
    """The smoke itself; a phase function may have any name."""
    phase = {key: child for key, child in o.items() if isinstance(child, dict) and key not in ("albedo", "exterior")}
    return {"type": "heterogeneous", "sigma_t": grid, "scale": o.get("density_scale", 1.0), "albedo": o.get("albedo", 0.75), **phase}


def fit(path: str) -> list[dict[str, Any]]:
    """From Mitsuba's cube, [-1, 1]^3, to the box that a .vol file names."""
    low, high = np.fromfile(path, dtype="<f4", count=6, offset=24).astype(float).reshape(2, 3)
    return [{"type": "scale", "value": ((high - low) / 2).tolist()}, {"type": "translate", "value": ((low + high) / 2).tolist()}]
