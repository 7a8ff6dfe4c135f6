"""Dictionaries of `mitsuba.load_dict` in our spelling."""

import json
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import pytest

from tyndall import exr
from tyndall.failure import Failure
from tyndall.load_dict import transform
from tyndall.spelling import spelled


@pytest.fixture(autouse=True, params=["scalar_rgb", "numpy only"])
def variant(request: pytest.FixtureRequest) -> str:
    """Values of Mitsuba's and of numpy's types."""
    mi.set_variant("scalar_rgb")
    return str(request.param)


def test_our_own_spelling_stays_as_it_is(tmp_path: Path) -> None:
    tree = {"type": "scene", "a": {"type": "sphere", "center": [1, 2.5, -3], "flip_normals": True, "r": {"type": "ref", "id": "x"}}}
    assert spelled(tree, tmp_path) == tree


def test_transforms_become_their_matrices(tmp_path: Path, variant: str) -> None:
    matrix = np.array([[0, 0, 2, 1], [0, 3, 0, 2], [-4, 0, 0, 3], [0, 0, 0, 1]], float)
    given = mi.ScalarTransform4f(matrix) if variant == "scalar_rgb" else matrix
    found = spelled({"type": "cube", "to_world": given}, tmp_path)["to_world"]
    assert found == [{"type": "matrix", "value": matrix.ravel().tolist()}]
    assert np.array(transform(found).matrix) == pytest.approx(matrix)


def test_transforms_of_texture_coordinates_keep_what_they_add(tmp_path: Path, variant: str) -> None:
    matrix = np.array([[2, 0, 0.25], [0, 3, 0.5], [0, 0, 1]])
    given: Any = mi.ScalarTransform3f(matrix) if variant == "scalar_rgb" else matrix
    [step] = spelled({"type": "bitmap", "filename": "a.png", "to_uv": given}, tmp_path)["to_uv"]
    assert np.reshape(step["value"], (4, 4))[:2, [0, 1, 3]] == pytest.approx(matrix[:2])


def test_numbers_and_points_become_jsons(tmp_path: Path, variant: str) -> None:
    point: Any = mi.ScalarPoint3f(1, 2, 3) if variant == "scalar_rgb" else np.array([1.0, 2, 3])
    values = {"center": point, "radius": np.float32(0.5), "tuple": (1, 2), "flag": np.bool_(True), "whole": np.int64(7), "path": Path("a.ply")}
    found = spelled({"type": "sphere", **values}, tmp_path)
    assert json.loads(json.dumps(found)) == {
        "type": "sphere", "center": [1, 2, 3], "radius": 0.5, "tuple": [1, 2], "flag": True, "whole": 7, "path": "a.ply",
    }  # fmt: skip


def test_colours_become_rgb(tmp_path: Path) -> None:
    found = spelled({"type": "diffuse", "reflectance": mi.ScalarColor3f(0.25, 0.5, 1)}, tmp_path)
    assert found["reflectance"] == {"type": "rgb", "value": [0.25, 0.5, 1]}
    wide = spelled({"type": "diffuse", "reflectance": {"type": "rgb", "value": np.array([0.1, 0.2, 0.3])}}, tmp_path)
    assert wide["reflectance"] == {"type": "rgb", "value": [0.1, 0.2, 0.3]}


def test_colours_are_known_by_either_name(tmp_path: Path) -> None:
    """Once `llvm_ad_rgb` has been chosen, `scalar_rgb` calls its colours ScalarColor3f."""
    channels = np.array([0.25, 0.5, 1])
    for name in ("Color3f", "ScalarColor3f"):
        colour: Any = channels.view(type(name, (np.ndarray,), {}))
        assert spelled({"type": "diffuse", "reflectance": colour}, tmp_path)["reflectance"] == {"type": "rgb", "value": [0.25, 0.5, 1]}


def test_arrays_become_the_files_that_mitsuba_reads_alike(tmp_path: Path, variant: str) -> None:
    voxels = np.random.default_rng(8).uniform(0, 1, (3, 4, 5, 1)).astype(np.float32)
    picture = np.random.default_rng(9).uniform(0, 2, (4, 6, 3)).astype(np.float32)
    theirs = variant == "scalar_rgb"
    tree = {
        "type": "scene",
        "smoke": {"type": "gridvolume", "data": mi.TensorXf(voxels) if theirs else voxels},
        "grid": {"type": "gridvolume", "grid": mi.VolumeGrid(voxels) if theirs else voxels[..., 0]},
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(picture) if theirs else picture},
        "wall": {"type": "bitmap", "data": mi.TensorXf(picture) if theirs else picture, "raw": True},
    }
    found = spelled(tree, tmp_path)
    for name in ("smoke", "grid"):
        assert set(found[name]) == {"type", "filename"}
        assert np.array(mi.VolumeGrid(found[name]["filename"])).ravel() == pytest.approx(voxels.ravel())
    for name in ("sky", "wall"):
        assert (exr.read_image(found[name]["filename"]) == picture).all()
    assert len(list(tmp_path.iterdir())) == 4


def test_pictures_of_bytes_stay_srgb(tmp_path: Path) -> None:
    pixels = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    path = spelled({"type": "bitmap", "bitmap": mi.Bitmap(pixels)}, tmp_path)["filename"]
    again = mi.Bitmap(path)
    assert again.component_format() == mi.Struct.Type.UInt8 and (np.array(again) == pixels).all()


def test_what_cannot_be_written_is_refused_by_its_place(tmp_path: Path) -> None:
    loaded = mi.load_dict({"type": "diffuse"})
    with pytest.raises(Failure, match=r"\$\.wall\.bsdf: a BSDF(?s:.*)give the dictionary") as caught:
        spelled({"type": "scene", "wall": {"type": "rectangle", "bsdf": loaded}}, tmp_path)
    assert "remedy" in str(caught.value)
    with pytest.raises(Failure, match=r"\$\.to_world: an array of shape \(2, 4\)"):
        spelled({"type": "cube", "to_world": np.ones((2, 4))}, tmp_path)
    with pytest.raises(Failure, match="load_dict empties"):
        spelled({"type": "bitmap", "data": np.zeros((0,))}, tmp_path)
