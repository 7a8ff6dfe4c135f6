"""What is kept of a study: from a made-up one of known numbers, so that it can be seen what is drawn."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from validation import cli, exr
from validation.failure import Failure
from validation.places import ROOT
from validation.study import curves, outcome, record, strips
from validation.study.outcome import Contender, Interval, Outcome, Point, Reference, SceneOutcome


def interval(mean: float) -> Interval:
    return Interval(mean, mean / 1.2, mean * 1.2)


def contender(name: str, cost: float, first_second: float, points: int = 4) -> Contender:
    """Errors that fall as they should, each budget twice the one before."""
    slug = name.replace(" ", "-")
    seconds = [first_second * 2**k for k in range(points)]
    done = [
        Point(k + 1, interval(s), e, e, e, e, e, Interval(0.01, -0.01, 0.03), f"images/toy/{slug}/{k}.exr")
        for k, (s, e) in enumerate((s, interval(cost / s)) for s in seconds)
    ]
    return Contender(name, 0.1, done, Interval(-1, -1.1, -0.9), interval(1 / cost), None, f"images/toy/{slug}/variance.exr", [])


def study(folder: Path) -> Outcome:
    """Ours ten times as good as the better of two others; its images are there."""
    names = [contender("tyndall bdpt", 0.01, 0.1), contender("mitsuba a", 0.1, 0.11), contender("mitsuba b", 0.3, 0.02)]
    scene = SceneOutcome("toy_scene", 8, 6, Reference("images/reference.exr", "known", 1e-4), names, ["a note"])
    command = f"python3 -m validation convergence {ROOT}/scenes/lampbox_up.xml --minutes 3 --output {folder}"
    made = Outcome("us", command, "a machine", 0.95, [scene, replace(scene, name="other")])
    for image in ["images/reference.exr", *(point.image for c in names for point in c.points)]:
        exr.write_image(folder / image, np.random.default_rng(1).random((6, 8, 3)))
    outcome.write(made, folder)
    return made


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    made = study(tmp_path)
    assert outcome.read(tmp_path) == made


def test_null_is_nan_and_older_studies_have_no_notes(tmp_path: Path) -> None:
    study(tmp_path)
    path = tmp_path / outcome.FILE
    told = json.loads(path.read_text())
    del told["scenes"][0]["notes"], told["scenes"][0]["contenders"][0]["notes"], told["scenes"][0]["contenders"][0]["ratio"]
    told["scenes"][0]["contenders"][1]["points"][2]["relmse"] = {"mean": None, "low": None, "high": None}
    path.write_text(json.dumps(told))
    scene = outcome.read(tmp_path).scenes[0]
    assert scene.notes == [] and scene.contenders[0].ratio is None
    assert math.isnan(scene.contenders[1].points[2].relmse.mean)
    record.run(tmp_path, tmp_path / "reports")  # which leaves a gap


def test_the_record_is_the_same_again_and_names_no_place(tmp_path: Path) -> None:
    study(tmp_path)
    for name in ("one", "two"):
        assert cli.main(["record", str(tmp_path), "--output", str(tmp_path / name)]) == 0
    first, second = ({p.name: p.read_bytes() for p in (tmp_path / name).iterdir()} for name in ("one", "two"))
    assert first == second and set(first) == {record.TABLE, record.CURVES, record.STRIPS}
    text = first[record.TABLE].decode()
    assert "    python3 -m validation convergence scenes/lampbox_up.xml --minutes 3\n" in text
    assert str(tmp_path) not in text and str(ROOT) not in text and "- a note." in text
    assert all(f"]({name})" in text for name in (record.CURVES, record.STRIPS))


@pytest.mark.parametrize("place", ["--output a", "-o a", "--output=a", ""])
def test_commands_do_not_tell_where_they_wrote(place: str) -> None:
    assert record.portable(f"tyndall study {place} 'b c.xml' --seeds 4") == "tyndall study 'b c.xml' --seeds 4"


def test_curves_are_where_the_numbers_are(tmp_path: Path) -> None:
    [first, *_] = curves.figure(study(tmp_path)).axes
    bdpt = first.get_lines()[0]
    assert first.get_title() == "toy scene" and first.get_xscale() == first.get_yscale() == "log"
    assert np.allclose(bdpt.get_xydata(), [[0.1, 0.1], [0.2, 0.05], [0.4, 0.025], [0.8, 0.0125]])
    assert np.unique(first.get_lines()[3].get_ydata()) == [1e-4]  # the reference's own
    assert len({line.get_color() for line in first.get_lines()[:3]}) == 3


def test_strips_are_of_one_time(tmp_path: Path) -> None:
    (ours, own), (best, other) = strips.equal_time(study(tmp_path).scenes[0])
    assert (ours.name, best.name) == ("tyndall bdpt", "mitsuba a")
    assert (own.seconds.mean, other.seconds.mean) == pytest.approx((0.8, 0.88))


@pytest.mark.parametrize(("value", "text"), [(0.5, "0.5"), (1000, "1000"), (1e-3, "0.001"), (1e4, "$10^{4}$"), (2e-5, r"$2 \cdot 10^{-5}$")])
def test_ticks_are_short(value: float, text: str) -> None:
    assert curves.tick(value) == text


@pytest.mark.parametrize("content", ["{", "[]", '{"scenes": []}', '{"scenes": [{"name": "a"}]}'])
def test_what_is_no_study_is_refused(content: str, tmp_path: Path) -> None:
    with pytest.raises(Failure, match="no study.json"):
        outcome.read(tmp_path)
    (tmp_path / outcome.FILE).write_text(content)
    with pytest.raises(Failure, match="not what a study has"):
        outcome.read(tmp_path)
