"""The figure of a study, as `tyndall report --figure` makes it of images that are there."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tyndall import exr, figure, program
from tyndall.failure import Failure
from tyndall.figure import Column, Row

HERE = Path(figure.__file__).parents[1]


def interval(mean: float) -> dict[str, float]:
    """With ends."""
    return {"mean": mean, "low": 0.9 * mean, "high": 1.2 * mean}


def study(folder: Path, sizes: dict[str, tuple[int, int]], contenders: tuple[str, ...]) -> None:
    """A made-up study of scenes with images of such sizes."""
    generator = np.random.default_rng(1)

    def image(name: str, size: tuple[int, int], noise: float) -> str:
        light = np.linspace(0.1, 0.9, size[0])[None, :, None] * np.ones((size[1], 1, 3))
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        exr.write_image(folder / name, light * (1 + noise * generator.normal(size=light.shape)))
        return name

    def contender(scene: str, number: int, name: str) -> dict[str, Any]:
        noise = 0.1 * (number + 1)
        errors = {key: interval(noise**2) for key in ("mse", "relmse", "trimmed_relmse", "mape", "smape", "difference")}
        point = {"samples": 4, "seconds": interval(1.5), **errors, "image": image(f"{scene}/{number}.exr", sizes[scene], noise)}
        ratio = {"ratio": interval(1 / (number + 1) ** 2)} if number else {}
        return {"name": name, "load_seconds": None, "points": [point], "slope": None, "efficiency": interval(1 / noise**2), **ratio, "variance": ""}

    def scene(name: str) -> dict[str, Any]:
        reference = {"image": image(f"{name}/reference.exr", sizes[name], 0), "how": "a formula", "own_relmse": 0.0}
        everybody = [contender(name, number, one) for number, one in enumerate(contenders)]
        return {"name": name, "width": sizes[name][0], "height": sizes[name][1], "reference": reference, "contenders": everybody}

    told = {"made_by": "a test", "command": "none", "machine": "none", "confidence": 0.95, "scenes": [scene(name) for name in sizes]}
    (folder / "study.json").write_text(json.dumps(told))


def report(folder: Path, *words: str, **variables: str) -> "subprocess.CompletedProcess[str]":
    """`tyndall report`, with this Python."""
    there = program.environment() | {"TYNDALL_PYTHON": sys.executable, "PYTHONPATH": str(HERE), **variables}
    return subprocess.run([str(program.binary()), "report", str(folder), *words], env=there, capture_output=True, text=True)


def test_a_study_becomes_a_figure(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    study(tmp_path, {"wide": (48, 30), "tall": (20, 32)}, ("bdpt", "hit+next-event joined", "$pt$"))
    pdf, png = tmp_path / "figures" / "a.pdf", tmp_path / "figures" / "a.png"
    done = report(tmp_path, "--figure", str(pdf), "--figure", str(png), "--exposure", "auto")
    assert done.returncode == 0, done.stderr
    text = pdf.read_bytes()
    [box] = re.findall(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", text)
    assert float(box[0]) == 72 * figure.WIDTH
    assert b"/FontFile2" in text and b"/CIDFontType2" in text and b"/Type3" not in text, "text stays text, its fonts are in the file"
    from matplotlib.image import imread

    pixels = imread(png)
    assert pixels.shape[1] == round(figure.WIDTH * figure.DOTS) and len(np.unique(pixels[..., :3].reshape(-1, 3), axis=0)) > 100
    again = tmp_path / "again.pdf"
    report(tmp_path, "--figure", str(again), "--exposure", "auto")
    assert again.read_bytes() == text, "the same study gives the same file"


def row(sizes: tuple[int, int], crops: list[tuple[int, int, int, int]], names: tuple[str, ...]) -> Row:
    """With black images."""
    black = np.zeros((sizes[1], sizes[0], 3))
    return Row("scene", black, crops, [Column(black, name, {}) for name in names])


@pytest.mark.parametrize("sizes", [(640, 360), (100, 300), (1, 1)])
@pytest.mark.parametrize("crops", [[(0, 0, 8, 8)], [(0, 0, 8, 8), (1, 1, 16, 4)], [(0, 0, 3, 9)] * 3])
def test_images_fill_the_width_and_crops_are_as_high_as_the_whole(sizes: tuple[int, int], crops: list[tuple[int, int, int, int]]) -> None:
    one = row(sizes, crops, ("a", "b", "c"))
    assert np.isclose(one.left(2) + one.crop_width, figure.WIDTH)
    heights = sum(one.crop_width * height / width for _, _, width, height in crops) + figure.GAP * (len(crops) - 1)
    assert np.isclose(heights, one.height) and one.crop_width > 0


def test_long_names_take_two_lines() -> None:
    assert figure.halves("hit+next-event") == ["hit+next-", "event"] and figure.halves("volpath") == ["volpath"]
    assert figure.halves("pt independent") == ["pt", "independent"]


def test_exponents_are_mathematics() -> None:
    assert figure.raised("1.23×10⁻⁵", False) == r"1.23×$\mathrm{10^{-5}}$" and figure.raised("10.2 s", True) == "10.2 s"
    assert figure.raised("9.00×10¹²×", True) == r"9.00×$\mathbf{10^{12}}$×"


def test_without_the_package_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(Failure, match=r"\[figure\]"):
        figure.library()


def test_what_cannot_be_shown_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    study(tmp_path, {"room": (12, 8)}, ("bdpt", "pt"))
    output = tmp_path / "a.pdf"
    for words, said in ((["--contender", "lt"], "bdpt, pt"), (["--crop", "4,4,9,1"], "12 x 8"), (["--scene", "hall"], "room")):
        done = report(tmp_path, "--figure", str(output), *words)
        assert done.returncode == 2 and said in done.stderr and not output.exists(), done.stderr
    done = report(tmp_path / "none", "--figure", str(output))
    assert done.returncode == 2 and "study.json" in done.stderr
