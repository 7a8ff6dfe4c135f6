"""Pictures: arrays that show themselves and know how they were made."""

import pickle
import re
import subprocess
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import pytest

import tyndall
from tyndall import display, program
from tyndall.failure import Failure
from validation.places import CROSSCHECK, SCENES

SCENE = CROSSCHECK / "cube_in_room.json"
LAYERED = CROSSCHECK / "integrator_aov.json"


def shown(png: bytes | None, folder: Path) -> np.ndarray:
    """The pixels of a PNG file, as Mitsuba reads it."""
    assert png
    (folder / "shown.png").write_bytes(png)
    mi.set_variant("scalar_rgb")
    return np.array(mi.Bitmap(str(folder / "shown.png")))


@pytest.mark.parametrize("scene", [SCENE, SCENES / "foggy_room.json"])
def test_it_is_shown_as_the_programs_png_shows_it(scene: Path, tmp_path: Path) -> None:
    subprocess.run([str(program.binary()), "--quiet", "render", str(scene), "-o", "image.exr", "--spp", "4", "--size", "64x48"], cwd=tmp_path, check=True)
    image = tyndall.read(tmp_path / "image.exr")
    expected = shown((tmp_path / "image.png").read_bytes(), tmp_path)
    assert (shown(image._repr_png_(), tmp_path) == expected).all()


def test_broken_and_bright_pixels_are_shown(tmp_path: Path) -> None:
    row = np.array([[[0.5] * 3] * 996 + [[np.nan] * 3, [np.inf] * 3, [-1.0] * 3, [0, 0, 1e30]]])
    pixels = shown(tyndall.Picture(row)._repr_png_(), tmp_path)
    assert (pixels[0, 0] == 188).all() and (pixels[0, 996:] == [[0] * 3, [255] * 3, [0] * 3, [255] * 3]).all()
    assert (shown(tyndall.Picture(np.zeros((2, 2, 3)))._repr_png_(), tmp_path) == 0).all()


def test_it_is_shown_by_the_view_and_exposure_it_was_rendered_with(tmp_path: Path) -> None:
    image = tyndall.render(SCENE, spp=1, size=(16, 16), view="agx", exposure="auto")
    assert image.display == display.Display("agx", image.report["exposure"]) and image.report["exposure"] != 0
    computed: Any = image * 1
    png = shown(computed._repr_png_(), tmp_path)
    assert (png == shown(image.shown("agx", "auto").save(tmp_path / "image.png").read_bytes(), tmp_path)).all()
    assert (png != shown(image.shown("standard", 0)._repr_png_(), tmp_path)).any()
    assert re.search(r"^view +agx$", tyndall.info(tmp_path / "image.png"), re.MULTILINE)
    with pytest.raises(Failure, match="agz"):
        image.shown("agz")._repr_png_()


def test_only_what_is_an_image_shows_itself() -> None:
    image = tyndall.Picture(np.ones((2, 3, 3)))
    shown: list[Any] = [image * 2, image - image, image[:, :, ::-1]]
    assert all(array._repr_png_() for array in shown)
    assert image[:0]._repr_png_() is None and image[..., 0]._repr_png_() is None  # type: ignore[attr-defined]
    assert type(image.mean()) is np.float64 and type(image.mean(axis=0)) is np.ndarray and type(image > 0) is not bool


def test_what_is_saved_is_what_is_read(tmp_path: Path) -> None:
    image = tyndall.render(LAYERED, spp=2)
    path = image.save(tmp_path / "sub" / "image.exr")
    again = tyndall.read(path)
    assert (again == image).all() and again.metadata == image.metadata and again.layers.keys() == image.layers.keys()
    assert all((again.layers[name] == layer).all() for name, layer in image.layers.items())
    assert (shown(image.save(tmp_path / "image.png").read_bytes(), tmp_path) == shown(image._repr_png_(), tmp_path)).all()
    assert "samples_per_pixel" in tyndall.info(path) and image.metadata["settings"]["seed"] == 0
    assert "tyndall-" not in str(image.metadata)  # the folder that the program wrote to
    for name in ("image.jpg", "image"):
        with pytest.raises(Failure, match="name an .exr or a .png"):
            image.save(tmp_path / name)
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(Failure, match="cannot be written"):
        image.save(tmp_path / "file" / "image.exr")


def test_variances_are_those_of_the_batches_or_of_the_scenes_own() -> None:
    image = tyndall.render(SCENE, spp=4, size=(8, 8), batches=6)
    assert image.batches is not None
    expected = image.batches.var(axis=0, ddof=1) / 6
    assert np.allclose(image.variance, expected, rtol=1e-3, atol=1e-9) and expected.max() > 0
    assert tyndall.render(CROSSCHECK / "integrator_moment.json", spp=4).variance.max() > 0
    with pytest.raises(Failure, match="batches=16"):
        _ = tyndall.render(SCENE, spp=1, size=(4, 4)).variance


def test_pictures_can_be_sent_to_other_processes() -> None:
    image = tyndall.render(SCENE, spp=1, size=(4, 4))
    again = pickle.loads(pickle.dumps(image))
    assert isinstance(again, tyndall.Picture) and (again == image).all() and again.metadata == image.metadata


def test_differences_are_measured() -> None:
    image = tyndall.render(SCENE, spp=1, size=(8, 8))
    assert tyndall.diff(image, image)["radiance"]["mse"] == 0
    found = tyndall.diff(image * 2, image)
    assert found["radiance"]["ratio"] == [2, 2, 2] and found["image"] == "image.exr"
    with pytest.raises(Failure, match="^image.exr: expected 8 x 4 pixels"):
        tyndall.diff(image, image[:4])
