"""What Mitsuba gets in place of what it has not: tables that are Tyndall's phase functions, and grids that are its volumes."""

import gzip
import json
import re
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import pytest

from tyndall import program
from tyndall.failure import Failure
from validation import bake, mitsuba, phases
from validation.places import ROOT

PHASES: list[dict[str, Any]] = [
    {"type": "schlick", "k": 0.8},
    {"type": "schlick", "k": -0.35},
    {"type": "two_term_schlick", "r": 0.19, "g1": -0.65, "g2": 0.91},
    {"type": "two_term_hg", "r": 0.3, "g1": 0.8, "g2": -0.5},
    {"type": "cornette_shanks"},
    {"type": "cornette_shanks", "u": -0.6},
    {"type": "linear", "g": 0.7},
    {"type": "mie", "m": 20, "n": 30},
    {"type": "mie_hazy"},
    {"type": "mie_murky"},
    {"type": "mie_murky", "form": "blasi"},
    {"type": "mie_reflecting"},
    {"type": "sakas", "n": 3},
    {"type": "gaussian", "gamma": 3},
    {"type": "diffuse_sphere"},
]
SPARSE = ROOT / "src" / "volume" / "files" / "samples"


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own for what is baked."""
    monkeypatch.setattr(bake, "FOLDER", tmp_path / "baked")
    mitsuba.use("scalar_rgb")
    return tmp_path / "baked"


def drawn(phase: dict[str, Any], folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Cosines and values of a phase function as Tyndall draws it: points of a mesh, as far away as the value there."""
    given = [f"{key}={value}" for key, value in phase.items() if key != "type"]
    program.call([str(program.binary()), "phase", phase["type"], *given, "--samples", "10000", "--significance", "1e-9", "-o", str(folder)])
    header, points = (folder / f"{phase['type']}.ply").read_text().split("end_header\n")
    count = int(re.findall(r"element vertex (\d+)", header)[0])
    at = np.array([line.split() for line in points.splitlines()[:count]], dtype=float)
    values = np.linalg.norm(at, axis=1)
    return at[values > 0, 2] / values[values > 0], values[values > 0]


@pytest.mark.parametrize("phase", PHASES, ids=str)
def test_a_table_is_the_function_that_tyndall_draws(phase: dict[str, Any], tmp_path: Path) -> None:
    table = phases.tabulated(phase)
    heights = np.array(table["values"].split(","), dtype=float)
    steps = np.linspace(-1, 1, len(heights))
    cosines, values = drawn(phase, tmp_path)
    mean = 1 / (4 * np.pi)
    expected = np.interp(cosines, steps, heights) * mean / (np.trapezoid(heights, steps) / 2)
    assert np.all(np.abs(expected - values) < 2e-3 * np.maximum(mean, values))
    assert mi.load_dict(table) is not None


def test_every_phase_function_that_mitsuba_has_not_has_a_table() -> None:
    listed = program.call([str(program.binary()), "phase", "--list"]).stdout
    ours = set(re.findall(r"^(\w+)\*$", listed, re.MULTILINE))
    assert ours - {"specular_sphere"} == set(phases.FUNCTIONS) == {phase["type"] for phase in PHASES}


def test_what_is_too_narrow_is_refused() -> None:
    with pytest.raises(Failure, match="too narrow"):
        phases.tabulated({"type": "schlick", "k": 0.9999999})


def test_phase_functions_are_found_where_they_stand_and_filters_stay() -> None:
    schlick = {"type": "schlick", "k": 0.5}
    film = {"type": "hdrfilm", "rfilter": {"type": "gaussian"}}
    fog = {"type": "homogeneous", "phase": {"type": "blendphase", "weight": 0.5, "a": schlick, "b": {"type": "hg", "g": 0.1}}}
    done = bake.baked({"type": "scene", "film": film, "fog": fog}, Path())
    assert done["film"] == film and done["fog"]["phase"]["a"] == phases.tabulated(schlick) and done["fog"]["phase"]["b"] == {"type": "hg", "g": 0.1}


@pytest.mark.parametrize(("name", "grid"), [("houdini.vdb", "burn"), ("houdini.vdb", None), ("dense_half.vdb", None), ("blosc.nvdb", None)])
def test_a_sparse_grid_is_mitsubas_own(name: str, grid: str | None, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(gzip.decompress((SPARSE / f"{name}.gz").read_bytes()))
    named = {} if grid is None else {"grid": grid}
    volume = bake.baked({"type": "scene", "v": {"type": "gridvolume", "filename": name, **named, "use_grid_bbox": True}}, tmp_path)["v"]
    assert volume.keys() == {"type", "filename", "use_grid_bbox"}
    theirs = mi.load_dict(volume)
    told = told_of(tmp_path / name, grid)
    values = np.array(mi.VolumeGrid(volume["filename"]))
    assert (values.min(), values.max()) == pytest.approx((min(0, told["least"][0]), told["greatest"][0]))
    around = np.array(told["world"]) + np.array([[-1], [1]]) * np.array(told["voxel_size"])
    assert np.array([theirs.bbox().min, theirs.bbox().max]) == pytest.approx(around, rel=1e-6)


def told_of(path: Path, grid: str | None) -> dict[str, Any]:
    """What `tyndall info` says of a grid."""
    grids = json.loads(program.call([str(program.binary()), "info", "--json", str(path)]).stdout)["grids"]
    return next(one for one in grids if grid is None or one["name"] == grid)


def test_a_function_gets_the_voxels_it_needs() -> None:
    box = np.array([[0.0, 0, 0], [4, 1, 1]])
    even: dict[str, Any] = {"type": "polynomial", "x": "1"}
    wave = {"type": "cosine", "w": {"type": "wave", "vector": [6, 0, 0], "amplitude": 0.5}}
    assert bake.voxels(even, box, 0) == 3 * [bake.FEWEST]
    x, y, z = bake.voxels(wave, box, 0)
    # Lines between voxels are h^2 / 8 times the second derivative off: 0.5 * 36 * 2 / pi of a mean of 1.
    needed = 4 * np.sqrt(0.5 * 36 * 2 / np.pi / 8 / bake.ERROR)
    assert needed <= x < 2 * needed and (y, z) == (bake.FEWEST, bake.FEWEST)
    jump = {"type": "polynomial", "x": "1, 1", "half_width": 0.5}
    assert np.prod(bake.voxels({**jump, "y": "0, 1"}, box, 0)) == bake.MOST


def test_a_function_that_numpy_has_not_is_refused() -> None:
    fog = {"type": "heterogeneous", "sigma_t": {"type": "product", "a": {"type": "exponential"}, "b": {"type": "noise"}}}
    with pytest.raises(Failure, match="noise in a density(?s:.*)without Mitsuba"):
        bake.baked({"type": "scene", "box": {"type": "cube", "interior": fog}}, Path())
