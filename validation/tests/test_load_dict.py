"""Scenes as Mitsuba takes them, and back."""

import json
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import pytest

import tyndall
from tyndall import load_dict
from tyndall.failure import Failure
from tyndall.scene import changed
from validation.places import CROSSCHECK, SCENES

STEPS: list[dict[str, Any]] = [{"type": "scale", "value": [2, 3, 4]}, {"type": "rotate", "axis": [0, 1, 0], "angle": 90}, {"type": "translate", "value": [5, 6, 7]}]


@pytest.fixture(autouse=True)
def variant() -> None:
    mi.set_variant("scalar_rgb")


def scene(**more: Any) -> dict[str, Any]:
    """A cloud under a sky, of every kind of value."""
    film = {"type": "hdrfilm", "width": np.int64(12), "height": 8}
    sensor = {"type": "perspective", "fov": np.float32(40), "film": film, "to_world": [{"type": "lookat", "origin": [0, 1, 5], "target": [0, 0, 0], "up": [0, 1, 0]}]}
    voxels = np.random.default_rng(3).uniform(0, 1, (3, 4, 5))
    smoke = {"type": "gridvolume", "data": voxels, "to_world": np.array([[2, 0, 0, -1], [0, 2, 0, -1], [0, 0, 2, -1], [0, 0, 0, 1.0]])}
    cloud = {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "heterogeneous", "albedo": 0.8, "sigma_t": smoke, "tracker": "exact"}}
    sky = {"type": "envmap", "bitmap": np.ones((4, 8, 3)), "to_world": STEPS[1:2]}
    return {"type": "scene", "integrator": {"type": "bdpt", "max_depth": 6}, "sensor": sensor, "cloud": cloud, "sky": sky, **more}


def test_every_kind_of_value_goes_both_ways() -> None:
    theirs = tyndall.to_mitsuba(scene())
    assert isinstance(theirs["sensor"]["to_world"], mi.ScalarTransform4f) and isinstance(theirs["sky"]["bitmap"], mi.Bitmap)
    assert isinstance(theirs["cloud"]["interior"]["sigma_t"]["grid"], mi.VolumeGrid) and theirs["integrator"]["type"] == "volpath"
    back = tyndall.from_mitsuba(theirs)
    options: dict[str, Any] = {"spp": 64, "integrator": "pt", "max_depth": 6, "tracker": "exact"}
    ours, again, direct = (tyndall.render(tree, **options) for tree in (scene(), back, theirs))
    assert (again == direct).all() and again.mean() == pytest.approx(ours.mean(), rel=1e-3)
    truth = np.array(mi.render(mi.load_dict(theirs), spp=512))[..., :3]
    assert truth.mean(axis=(0, 1)) == pytest.approx(ours.mean(axis=(0, 1)), rel=0.02)  # noise: some 0.5 %


def test_with_a_folder_all_of_it_is_json(tmp_path: Path) -> None:
    plain = tyndall.from_mitsuba(tyndall.to_mitsuba(scene()), tmp_path / "files")
    assert sorted(path.name for path in (tmp_path / "files").iterdir()) == ["cloud.interior.sigma_t.grid.vol", "sky.bitmap.exr"]
    (tmp_path / "scene.json").write_text(json.dumps(plain))
    assert tyndall.render(tmp_path / "scene.json", spp=1).shape == (8, 12, 3)


def test_steps_are_applied_first_to_last() -> None:
    expected = np.array([[0, 0, 4, 5], [0, 3, 0, 6], [-2, 0, 0, 7], [0, 0, 0, 1]])
    assert np.array(load_dict.transform(STEPS).matrix) == pytest.approx(expected, abs=1e-6)


def test_known_differences_of_mitsuba() -> None:
    """What scenes/manual/compare.md says of it, and that it gets true rotations from here."""
    of = lambda transform: np.linalg.det(np.array(transform.matrix))
    assert of(mi.ScalarTransform4f().rotate([0, 2, 0], 90)) == pytest.approx(16)
    assert of(load_dict.transform([{"type": "rotate", "axis": [0, 2, 0], "angle": 90}])) == pytest.approx(1)
    board, place = mi.load_dict({"type": "checkerboard", "color0": 0.1, "color1": 0.9}), mi.SurfaceInteraction3f()
    place.uv = mi.Point2f(0.25, 0.25)
    assert (board.eval(place)[0], board.eval_1(place)) == pytest.approx((0.1, 0.9))


def test_lamps_of_smooth_meshes_are_dark_at_their_edges_in_mitsuba(tmp_path: Path) -> None:
    """By the faces, all of a closed lamp shines; by interpolated normals, what faces away from the eye does not."""
    (tmp_path / "lamp.obj").write_text("v 0 0.5 0\nv 0.4 -0.3 0.3\nv -0.4 -0.3 0.3\nv 0 -0.3 -0.5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    lamp = {"type": "obj", "filename": str(tmp_path / "lamp.obj"), "face_normals": False, "emitter": {"type": "area", "radiance": 1.0}}
    film = {"type": "hdrfilm", "width": 32, "height": 32, "pixel_format": "luminance", "rfilter": {"type": "box"}}
    camera = {"type": "perspective", "fov": 30.0, "to_world": mi.ScalarTransform4f().look_at([0, 0.3, 3], [0, 0, 0], [0, 1, 0]), "film": film}
    there = {"type": "scene", "integrator": {"type": "path"}, "camera": camera, "lamp": lamp}
    ours = tyndall.render(tyndall.from_mitsuba(there), spp=16, integrator="pt")[..., 0]
    theirs = np.array(mi.render(mi.load_dict(there), spp=16))[..., 0]
    assert ours.max() == pytest.approx(1, rel=1e-5) and theirs.sum() < 0.99 * ours.sum()
    faceted = np.array(mi.render(mi.load_dict({**there, "lamp": {**lamp, "face_normals": True}}), spp=16))[..., 0]
    assert faceted.sum() == pytest.approx(ours.sum(), rel=0.02)


def test_files_go_too() -> None:
    theirs = tyndall.to_mitsuba(SCENES / "lampbox_up.xml", {"res": 8})
    assert tuple(mi.load_dict(theirs).sensors()[0].film().size()) == (8, 8)
    theirs = tyndall.to_mitsuba(CROSSCHECK / "grid_trilinear.json")
    assert mi.load_dict(theirs) is not None and tyndall.render(theirs, spp=1, size=(8, 8)).mean() > 0


COLOUR = {"type": "rgb", "value": [0.07, 0.4, 1.5]}
MEDIA: dict[str, tuple[dict[str, Any], list[float]]] = {
    "a colour above 1": ({"type": "homogeneous", "sigma_t": COLOUR}, [0.07, 0.4, 1.5]),
    "that of a varying medium": ({"type": "heterogeneous", "sigma_t": COLOUR, "scale": 2}, [0.14, 0.8, 3]),
    "one channel for all": ({"type": "homogeneous", "sigma_t": {"type": "rgb", "value": 3}}, [3, 3, 3]),
    "a whole number": ({"type": "homogeneous", "sigma_t": 9, "albedo": 1}, [9, 9, 9]),
    "numpy's": ({"type": "homogeneous", "sigma_t": np.int64(9)}, [9, 9, 9]),
    "a colour below 1": ({"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [0.1, 0.2, 1]}}, [0.1, 0.2, 1]),
}


@pytest.mark.parametrize("what", MEDIA)
def test_media_have_their_extinction(what: str) -> None:
    medium, expected = MEDIA[what]
    place = mi.MediumInteraction3f()
    place.p = mi.Point3f(0.5, 0.5, 0.5)
    loaded = mi.load_dict(changed(medium, load_dict.translated))
    _, _, extinction = loaded.get_scattering_coefficients(place, True)
    assert np.array(extinction) == pytest.approx(np.array(expected))


def test_numbers_are_real_where_any_may_stand() -> None:
    glass = load_dict.translated({"type": "dielectric", "int_ior": 2, "ext_ior": "air"})
    assert str(mi.load_dict(glass)).count("eta = 1.99") == 1
    film = load_dict.translated({"type": "hdrfilm", "width": 12, "height": 8, "sample_border": True})
    assert (film["width"], film["sample_border"]) == (12, True) and type(film["width"]) is int


def test_what_tyndall_has_not_stays_as_it_is() -> None:
    theirs = {"type": "hair", "scale_tilt": 2, "pigmentation": {"type": "rgb", "value": [2, 1, 1]}}
    assert changed(theirs, load_dict.translated) == theirs and type(load_dict.translated(theirs)["scale_tilt"]) is int


def test_without_a_variant_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mi, "variant", lambda: None)
    with pytest.raises(Failure, match="set_variant"):
        tyndall.to_mitsuba(scene())
