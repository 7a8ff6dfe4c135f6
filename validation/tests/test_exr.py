"""OpenEXR files, which Mitsuba must read as we do."""

from pathlib import Path

import mitsuba as mi
import numpy as np
import OpenEXR
import pytest

from tyndall import exr
from tyndall.failure import Failure
from validation import picture

RANDOM = np.random.default_rng(7)


def planes(names: str, kind: type = np.float32) -> dict[str, np.ndarray]:
    """Small channels of these names."""
    return {name: RANDOM.uniform(0, 1, (3, 4)).astype(kind) for name in names.split()}


def written(folder: Path, channels: dict[str, np.ndarray]) -> Path:
    """A file of these channels."""
    with OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, dict(channels)) as file:
        file.write(str(folder / "image.exr"))
    return folder / "image.exr"


@pytest.mark.parametrize("channels", [3, 4])
def test_what_is_written_is_what_mitsuba_reads(tmp_path: Path, channels: int) -> None:
    image = RANDOM.normal(0, 100, (5, 7, channels)).astype(np.float32)
    exr.write_image(tmp_path / "sub" / "image.exr", image)
    mi.set_variant("scalar_rgb")
    assert (np.array(mi.Bitmap(str(tmp_path / "sub" / "image.exr"))) == image).all()
    assert (exr.read_image(tmp_path / "sub" / "image.exr") == image[:, :, :3]).all()
    assert [path.name for path in (tmp_path / "sub").iterdir()] == ["image.exr"]


def test_layers_are_found_by_name_and_their_channels_in_order(tmp_path: Path) -> None:
    given = planes("B G R A n.Z n.X n.Y depth.T")
    found = exr.read(written(tmp_path, given))
    assert {name: list(layer) for name, layer in found.items()} == {"<root>": list("RGBA"), "n": list("XYZ"), "depth": ["T"]}
    assert (exr.stacked(found["n"])[:, :, 2] == given["n.Z"]).all()
    assert exr.stacked(found["depth"]).shape == (3, 4)


def test_luminance_and_xyz_are_shown_in_rgb(tmp_path: Path) -> None:
    grey = planes("Y")
    assert (exr.read_image(written(tmp_path, grey)) == grey["Y"][..., None]).all()
    rgb = RANDOM.uniform(0, 1, (3, 4, 3))
    xyz = {name: (rgb @ row).astype(np.float32) for name, row in zip("XYZ", exr.XYZ_OF_RGB)}
    assert exr.read_image(written(tmp_path, xyz)) == pytest.approx(rgb, abs=1e-6)


def test_whole_numbers_stand_for_zero_to_one(tmp_path: Path) -> None:
    whole = {name: np.array([[0, 2**31, 2**32 - 1]], np.uint32) for name in "RGB"}
    assert exr.read_image(written(tmp_path, whole))[0, :, 0] == pytest.approx([0, 0.5, 1])


def test_what_is_no_image_is_refused(tmp_path: Path) -> None:
    (tmp_path / "image.exr").write_text("no image")
    with pytest.raises(Failure, match="no OpenEXR image"):
        exr.read(tmp_path / "image.exr")
    with pytest.raises(Failure, match="no picture"):
        exr.read_image(written(tmp_path, planes("n.X")))
    with pytest.raises(Failure, match="is no image"):
        exr.write_image(tmp_path / "image.exr", np.zeros((2, 2, 2)))


def test_png_files_are_what_mitsuba_reads(tmp_path: Path) -> None:
    pixels = RANDOM.integers(0, 256, (5, 7, 3)).astype(np.uint8)
    picture.write_png(tmp_path / "image.png", pixels)
    mi.set_variant("scalar_rgb")
    assert (np.array(mi.Bitmap(str(tmp_path / "image.png"))) == pixels).all()
