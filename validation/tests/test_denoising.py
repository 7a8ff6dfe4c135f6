"""Denoising, by Open Image Denoise where it is installed, and by a stand-in."""

import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tyndall
from tyndall.failure import Failure, TyndallWarning
from validation.places import CROSSCHECK, SCENES

SCENE = CROSSCHECK / "fog_isotropic.json"


def blurred(calls: list[dict[str, Any]]) -> Any:
    """What stands in for Open Image Denoise: the image, and what it was called with."""

    def denoise(color: np.ndarray, **options: Any) -> np.ndarray:
        calls.append({"color": color, **options})
        return color

    return SimpleNamespace(denoise=denoise)


@pytest.mark.parametrize("scene", [SCENE, SCENES / "lampbox_up.xml", tyndall.load(SCENE), CROSSCHECK / "integrator_aov.json"], ids=["json", "xml", "dictionary", "aov"])
def test_features_are_layers_of_any_scene(scene: Any) -> None:
    options: dict[str, Any] = {"spp": 1, "size": (8, 8), "seed": 3}
    image = tyndall.render(scene, features=True, **options)
    assert image.layers["albedo"].shape == image.layers["normal"].shape == image.shape
    assert image.layers["albedo"].max() > 0 and np.abs(image.layers["normal"]).max() > 0.5
    assert (image == tyndall.render(scene, **options)).all()  # as it would be without


def test_what_is_denoised_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[dict[str, Any]] = []
    monkeypatch.setitem(sys.modules, "pyoidn", blurred(calls))
    image = tyndall.render(SCENE, spp=1, size=(8, 6), features=True)
    found = image.denoised()
    assert calls[0]["hdr"] is True and all(calls[0][name].dtype == np.float32 and calls[0][name].shape == (6, 8, 3) for name in ("color", "albedo", "normal"))
    assert found.save(tmp_path / "fog.exr") == tmp_path / "fog.denoised.exr" and found.save(tmp_path / "fog.denoised.png").is_file()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fog.denoised.exr", "fog.denoised.png"]
    assert tyndall.read(tmp_path / "fog.denoised.exr").metadata["denoised"] == "Open Image Denoise"
    tyndall.render(SCENE, spp=1, size=(8, 6)).denoised()
    assert set(calls[1]) == {"color", "hdr"}


def test_shared_samples_are_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyoidn", blurred([]))
    few: dict[str, Any] = {"spp": 1, "size": (8, 6)}
    with pytest.warns(TyndallWarning, match="film_samples='apart'"):
        tyndall.render(SCENES / "foggy_room.json", **few).denoised()
    with warnings.catch_warnings():
        warnings.simplefilter("error", TyndallWarning)
        tyndall.render(SCENES / "foggy_room.json", film_samples="apart", **few).denoised()
        tyndall.render(SCENES / "foggy_room.json", features=True, **few).denoised()


def test_without_the_package_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(Failure, match=r"\[denoise\]"):
        tyndall.render(SCENE, spp=1, size=(4, 4)).denoised()


def test_open_image_denoise_lowers_the_error() -> None:
    options: dict[str, Any] = {"integrator": "pt", "size": (64, 64)}
    reference = tyndall.render(SCENE, spp=512, seed=100, **options)
    image = tyndall.render(SCENE, spp=8, features=True, **options)
    error = [float(((found - reference) ** 2).mean()) for found in (image, image.denoised())]
    assert error[1] < 0.5 * error[0]
