"""The table of time to equal error: what it concludes from a study, and that both renderers read its scenes."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import tyndall
from tyndall.failure import Failure
from tyndall.scene import open_scene
from validation import cli, efficiency, guide, mitsuba, studies, volumes
from validation.places import EFFICIENCY
from tyndall.statistics import Ratio
from validation.studies import Effort, Found, Reference, Study

COST = 0.02
"""Tyndall's product of relMSE and seconds."""


def scene(**ratios: float) -> Found:
    """A scene of a study; the others' efficiency relative to Tyndall's."""
    point = lambda **numbers: [{name: {"mean": value} for name, value in numbers.items()} | {"samples": 16 if numbers["relmse"] > 0.05 else 8}]
    others = [{"name": other.replace("_", " "), "points": point(relmse=0.06, seconds=0.4)} for other in ratios]
    contenders = [{"name": "tyndall", "points": point(relmse=0.04, seconds=0.5)}, *others]
    costs = {other.replace("_", " "): [0.99 * COST / ratio, 1.01 * COST / ratio] for other, ratio in {"tyndall": 1, **ratios}.items()}
    told = {"name": "pool", "width": 9, "height": 8, "reference": {"own_relmse": 0.002}, "contenders": contenders}
    return Found("pool", told, costs)


MITSUBA = {"mitsuba_volpath_llvm": 0.5, "mitsuba_volpathmis_llvm": 0.25}


def test_the_better_of_mitsubas_counts() -> None:
    row = efficiency.row_of(scene(pt=0.8, lt=0.1, **MITSUBA))
    assert row.ours == pytest.approx(0.02) and row.theirs and row.theirs[0] == "mitsuba volpath llvm"
    assert row.theirs[1].low < row.theirs[1].mean < row.theirs[1].high and row.theirs[1].mean == pytest.approx(2)
    assert (row.own["pt"].mean, row.own["lt"].mean, row.reference) == (pytest.approx(1.25), pytest.approx(10), pytest.approx(0.05))
    assert row.of_sample == pytest.approx((0.06 * 16 / (0.04 * 8), (0.4 / 16) / (0.5 / 8)))
    assert not row.is_beaten and not row.is_outdone


def row_with(theirs: Ratio, best: Ratio) -> efficiency.Row:
    """A scene with these ratios."""
    return efficiency.Row("pool", None, COST, ("mitsuba volpath", theirs), None, (1, 1), {"pt": best}, 0, [])


def test_what_is_surely_better_is_said() -> None:
    surely, hardly, unsure = Ratio(0.8, 0.85, 0.9), Ratio(0.9, 0.93, 0.96), Ratio(0.8, 0.93, 1.1)
    assert row_with(surely, surely).is_beaten and row_with(surely, surely).is_outdone
    assert not row_with(surely, hardly).is_outdone, "surely, but not by more than it may be"
    assert not row_with(unsure, unsure).is_beaten and not row_with(unsure, unsure).is_outdone
    study = {"made_by": "tyndall", "machine": "two cores", "scenes": [scene().told]}
    text = efficiency.page([row_with(unsure, unsure)], study)
    assert "Scenes below 1: pool." in text and "more efficient: pool (pt)." in text


def test_without_mitsuba_tyndalls_own_are_compared() -> None:
    row = efficiency.row_of(scene(pt=0.01))
    assert row.theirs is None and row.own["pt"].mean == pytest.approx(100) and not row.is_beaten
    assert "| pool | 0.02 | none |" in efficiency.table_line(row, ["pt"])
    with pytest.raises(Failure, match="pool: Tyndall could not render it"):
        efficiency.row_of(Found("pool", scene().told, {}))


def asked(monkeypatch: pytest.MonkeyPatch, *words: str) -> tuple[list[Path], dict[str, str], Effort]:
    """The study that a command line asks for."""
    found: list[tuple[list[Path], dict[str, str], Effort]] = []

    def measured(scenes: list[Path], contenders: dict[str, str], effort: Effort, *_: object, **__: object) -> Study:
        found.append((scenes, contenders, effort))
        return Study({"made_by": "tyndall", "machine": "two cores", "scenes": [scene().told]}, [scene(pt=0.8, **MITSUBA)])

    monkeypatch.setattr(volumes, "write", lambda: None)
    monkeypatch.setattr(studies, "measured", measured)
    assert cli.main(["efficiency", *words]) == 0
    return found[0]


def test_scenes_and_contenders_are_those_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine = ("my.xml", "-D", "res=8", "--points", "5", "--against", "no lens,volpath:scalar_rgb", "--contender", "joins: --strategies hit,join")
    scenes, contenders, effort = asked(monkeypatch, *mine, "--output", str(tmp_path))
    assert scenes == [Path("my.xml")] and list(contenders) == ["tyndall", "no lens", "volpath:scalar_rgb", "joins"]
    assert (effort.size, effort.points, effort.parameters, effort.seeds) == (None, 5, ("res=8",), 10)
    scenes, contenders, effort = asked(monkeypatch, "--quick", "--output", str(tmp_path))
    assert scenes == list(efficiency.WANTED) and list(contenders) == ["tyndall", "pt", "volpath", "volpathmis"]
    assert (effort.size, effort.points, effort.seeds) == ("96x96", 1, 3)
    assert "| pool | 0.02 | 0.04 (volpath llvm) |" in (tmp_path / "efficiency.md").read_text()
    assert json.loads((tmp_path / "efficiency.json").read_text())[0]["theirs"][1]["mean"] == pytest.approx(2)


def test_suites_have_scenes_contenders_and_efforts_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scenes, contenders, effort = asked(monkeypatch, "--suite", "guide", "--only", "A", "--seconds", "1", "--output", str(tmp_path))
    assert [scene.stem for scene in scenes] == ["A"] and list(contenders) == ["tyndall", *guide.OTHERS]
    assert (effort.seconds, effort.reference_seconds, effort.size) == (1, 100, "96x72") and (tmp_path / "guide.md").is_file()
    scenes, contenders, _ = asked(monkeypatch, "--suite", "models", "--only", "hg 0.9", "--output", str(tmp_path))
    assert len(scenes) == 3 and contenders == {"tyndall": "--integrator pt", "volpath": ""}
    boxes = efficiency.row_of(replace(scene(no_guide=0.5), name="A"))
    assert "; wanted: 0.9 |" in efficiency.table_line(boxes, ["no guide"])


@pytest.mark.parametrize(("words", "complaint"), [(["--against", "volpth"], "volpth: no such contender"), (["--contender", "joins"], "no name"), (["--only", "x"], "no scene has this")])
def test_what_makes_no_sense_is_refused(words: list[str], complaint: str) -> None:
    with pytest.raises(Failure, match=complaint):
        cli.main(["efficiency", "my.xml", *words])


def test_every_scene_is_measured_and_read_by_both() -> None:
    assert set(EFFICIENCY.glob("*.xml")) < set(efficiency.WANTED)
    volumes.write()
    for path in efficiency.WANTED:
        assert mitsuba.load(open_scene(path), "scalar_rgb", (4, 4)) is not None
        assert "warning" not in tyndall.info(path)


def test_a_command_line_names_each_contender_and_its_reference(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines: list[list[str]] = []

    def run(line: list[object]) -> bool:
        lines.append(list(map(str, line)))
        return True

    monkeypatch.setattr(studies, "run", run)
    monkeypatch.setattr(studies, "read", lambda folder: Study({}, []))
    effort = Effort(3, 0.5, 1, "9x8", 2, parameters=("res=8",))
    studies.measured([Path("a.xml")], {"tyndall": "--x y", "volpathmis:scalar_rgb": ""}, effort, tmp_path, [Reference(Path("a.exr"), 0.5)])
    after = lambda option: [word for before, word in zip(lines[0], lines[0][1:]) if before == option]
    ours, theirs = after("--external")
    assert ours.startswith("tyndall: ") and "'--tyndall=--x y'" in ours
    assert theirs.startswith("mitsuba volpathmis scalar_rgb: ") and "--variant scalar_rgb" in theirs
    assert (after("--reference"), after("--reference-error"), after("-D")) == (["a.exr"], ["0.5"], ["res=8"])
    assert {"--restart", "--size=9x8", "--seeds=3"} <= set(lines[0])
