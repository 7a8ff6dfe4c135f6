"""The table of time to equal error: what it concludes from a study, and that both renderers read its scenes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyndall
from tyndall import exr
from tyndall.failure import Failure
from tyndall.scene import open_scene
from validation import cli, efficiency, mitsuba, studies
from validation.efficiency import Effort, Ratio, Reference


def interval(middle: float, off: float = 1.1) -> dict[str, float]:
    """A mean and the ends of its interval."""
    return {"mean": middle, "low": middle / off, "high": middle * off}


def scene(**ratios: float) -> dict[str, Any]:
    """A scene of study.json: Tyndall's product of relMSE and seconds is 0.02; the others' efficiency relative to it."""
    ours = {"name": "tyndall", "efficiency": interval(50), "points": [{"relmse": interval(0.04), "seconds": interval(0.5), "samples": 8}]}
    point = {"relmse": interval(0.06), "seconds": interval(0.4), "samples": 16}
    others = [{"name": other.replace("_", " "), "ratio": interval(ratio), "points": [point]} for other, ratio in ratios.items()]
    return {"name": "pool", "width": 9, "height": 8, "reference": {"own_relmse": 0.002}, "contenders": [ours, *others]}


MITSUBA = {"mitsuba_volpath_llvm": 0.5, "mitsuba_volpathmis_llvm": 0.25}


def test_the_better_of_mitsubas_counts() -> None:
    row = efficiency.row_of(scene(pt=0.8, lt=0.1, **MITSUBA))
    assert (row.ours, row.theirs) == (pytest.approx(0.02), pytest.approx(0.04))
    assert row.mitsuba.other == "mitsuba volpath llvm"
    assert (row.mitsuba.low, row.mitsuba.mean, row.mitsuba.high) == pytest.approx((2 / 1.1, 2, 2 * 1.1))
    assert (row.best.other, row.best.mean, row.reference) == ("pt", pytest.approx(1.25), pytest.approx(0.05))
    assert row.of_sample == pytest.approx((0.06 * 16 / (0.04 * 8), (0.4 / 16) / (0.5 / 8)))
    assert not row.is_beaten and not row.is_outdone


def test_what_is_surely_better_is_said() -> None:
    assert efficiency.row_of(scene(pt=1.2, mitsuba_volpath=1.2)).is_outdone
    assert efficiency.row_of(scene(pt=1.2, mitsuba_volpath=1.2)).is_beaten
    assert not efficiency.row_of(scene(pt=1.15, mitsuba_volpath=0.5)).is_outdone, "surely, but not by more than it may be"
    unsure = efficiency.row_of(scene(pt=1.1, mitsuba_volpath=1.05))
    assert not unsure.is_outdone and not unsure.is_beaten
    study = {"made_by": "tyndall", "machine": "two cores", "confidence": 0.95, "scenes": [scene()]}
    text = efficiency.page([unsure], study, "made by this")
    assert "Scenes below 1: pool." in text and "more efficient: pool (pt)." in text and "made by this" in text


def test_a_scene_without_mitsuba_has_no_ratio() -> None:
    with pytest.raises(Failure, match="pool: Mitsuba could not render it"):
        efficiency.row_of(scene(pt=1))


def test_the_mean_is_geometric_and_its_interval_narrows() -> None:
    found = efficiency.mean([Ratio("", 1, 2, 4), Ratio("", 4, 8, 16)])
    assert (found.mean, found.high) == (pytest.approx(4), pytest.approx(4 * 2 ** (1 / 2**0.5)))


def test_all_take_part_and_each_scene_has_its_reference() -> None:
    references = [Reference(Path("a.exr"), 0.5), Reference(Path("b.exr"), 0.25)]
    scenes = list(efficiency.WANTED)[:2]
    line = efficiency.line(scenes, {"tyndall": "--x", "pt": "--y"}, Effort(3, 0.5, 1, "9x8", 2), references, Path("out"), False)
    after = lambda option: [word.split(":")[0] for before, word in zip(line, line[1:]) if before == option]
    assert after("--contender") == ["tyndall", "pt"]  # a study takes these first
    assert after("--external") == ["mitsuba volpath llvm_ad_rgb", "mitsuba volpathmis llvm_ad_rgb"]
    assert after("--reference") == ["a.exr", "b.exr"]
    assert "--restart" in line and "--size=9x8" in line and "--seeds=3" in line


def test_the_command_writes_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "efficiency-quick").mkdir()
    study = {"made_by": "tyndall", "machine": "two cores", "confidence": 0.95, "scenes": [scene(pt=0.8, **MITSUBA)]}
    (tmp_path / "efficiency-quick" / "study.json").write_text(json.dumps(study))
    monkeypatch.setattr(efficiency, "OUTPUT", tmp_path)
    monkeypatch.setattr(efficiency, "volumes", lambda: None)
    monkeypatch.setattr(efficiency, "reference", lambda *_: Reference(Path("a.exr"), 0.5))
    monkeypatch.setattr(studies, "run", lambda _: True)
    assert cli.main(["efficiency", "--quick", str(efficiency.FOLDER / "pool.xml")]) == 0
    assert "| pool | 0.02 | 0.04 (volpath) |" in (tmp_path / "efficiency-quick" / "efficiency.md").read_text()
    assert json.loads((tmp_path / "efficiency-quick" / "efficiency.json").read_text())[0]["mitsuba"]["mean"] == pytest.approx(2)


def test_every_scene_is_measured_and_read_by_both() -> None:
    assert set(efficiency.FOLDER.glob("*.xml")) < set(efficiency.WANTED)
    efficiency.volumes()
    for path in efficiency.WANTED:
        assert mitsuba.load(open_scene(path), "scalar_rgb", (4, 4)) is not None
        assert "warning" not in tyndall.info(path)


def test_a_reference_is_made_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(efficiency, "OUTPUT", tmp_path)
    effort = Effort(2, 0.1, 0.2, "8x8", 1)
    first = efficiency.reference(efficiency.FOLDER / "nested_media.xml", effort)
    image = exr.read_image(first.image)
    assert image.shape == (8, 8, 3) and first.relmse > 0
    assert efficiency.reference(efficiency.FOLDER / "nested_media.xml", effort) == first
    assert np.array_equal(exr.read_image(first.image), image)
