"""Smoke in Mitsuba: the cube and the grid that the program makes of a file."""

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyndall
from tyndall.failure import Failure
from tyndall.scene import Scene
from tyndall.volume_file import vol
from validation import bake, mitsuba
from validation.places import ROOT

SAMPLES = ROOT / "src" / "volume" / "files" / "samples"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two volume files and what is baked."""
    monkeypatch.setattr(bake, "FOLDER", tmp_path / "baked")
    for name in ("blender_fluids.vdb", "houdini.vdb"):
        (tmp_path / name).write_bytes(gzip.decompress((SAMPLES / f"{name}.gz").read_bytes()))
    voxels = np.random.default_rng(5).uniform(0, 1, (3, 4, 5)) * np.linspace(0.2, 3, 5)
    (tmp_path / "ramp.vol").write_bytes(vol(voxels, (0, 0, 0, 1.5, 0.5, 1)))
    return tmp_path


def scene(folder: Path, camera: dict[str, Any] | None = None, **smoke: dict[str, Any]) -> Scene:
    """Smoke in the sun, under an even sky."""
    film = {"type": "hdrfilm", "width": 24, "height": 16, "rfilter": {"type": "box"}}
    look = [{"type": "lookat", "origin": [0, 0.5, 5], "target": [0, 0, 0], "up": [0, 1, 0]}]
    sensor = {"type": "perspective", "fov": 40, "film": film, "to_world": look, **(camera or {})}
    sky = {"type": "constant", "radiance": {"type": "rgb", "value": [2, 1, 1]}}
    sun = {"type": "directional", "direction": [0.5, -0.2, 1], "irradiance": 3}
    return Scene({"type": "scene", "integrator": {"type": "bdpt"}, "sensor": sensor, "sky": sky, "sun": sun, **smoke}, "smoke", {}, folder)


def test_both_renderers_see_the_same_smoke(folder: Path) -> None:
    move = [{"type": "rotate", "axis": [0, 1, 0], "angle": 30}, {"type": "translate", "value": [-1.9, -0.5, -0.5]}]
    ramp = {"type": "smoke", "filename": "ramp.vol", "up": "z", "scale": 1.2, "density_scale": 3, "to_world": move, "p": {"type": "hg", "g": 0.5}}
    blender = {"type": "smoke", "filename": "blender_fluids.vdb", "emission_scale": 0, "density_scale": 20, "albedo": {"type": "rgb", "value": [0.9, 0.6, 0.1]}}
    both = scene(folder, ramp=ramp, blender=blender)
    theirs, ours = mitsuba.render(both, 256), tyndall.render(both, spp=256)
    blocks = [image.reshape(2, 8, 3, 8, 3).mean(axis=(1, 3)) for image in (theirs, ours)]
    assert ours.std(axis=(0, 1)).min() > 0.1, "the smoke is seen"
    assert blocks[0] == pytest.approx(blocks[1], rel=0.02)  # noise: below 0.5 %


WRONG: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "light": ({"filename": "houdini.vdb"}, {}, "light from its file(?s:.*)emission_scale"),
    "colours": ({"filename": "houdini.vdb", "emission_scale": 0}, {}, "colours from its file(?s:.*)color_grid"),
    "motion": ({"filename": "ramp.vol"}, {"shutter_close": 0.1}, "motion while(?s:.*)velocity_grid"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_mitsuba_has_not_is_refused_by_its_remedy(what: str, folder: Path) -> None:
    smoke, camera, said = WRONG[what]
    with pytest.raises(Failure, match=f"the smoke plume: found {said}"):
        mitsuba.load(scene(folder, camera, plume={"type": "smoke", **smoke}))
