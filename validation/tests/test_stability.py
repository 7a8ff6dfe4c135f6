"""The stability table: when a line is done, what is said of it, and what is kept."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from validation.closed_forms.case import SIZE, scene
from validation.compare import options_of
from validation.stability import report, run
from validation.stability.case import Case, Sampled, mean
from validation.stability.judge import Found, judge, level, refused
from validation.made import Made
from validation.stability.report import Line, Table

EFFORT = run.Effort(budget=10, cap=50)
KIN = 20
FOUND = Found(expected=1, found=1, error=1e-3, relative_error=1e-3, probability=0.5, freedom=15, not_finite=0, samples=100, seconds=1)
MADE = Made("command", "tyndall 1", "abc", "0123456789ab", "2026-01-01", "a processor", 0.5, 0)


def line(row: str = "row", flaw: str = "", **changes: Any) -> Line:
    """A line of which this was found."""
    return Line(Case(row, "case", scene("s"), 1, ("pt",), "theory", flaw=flaw, flawed_by=0.1), "pt", replace(FOUND, **changes), KIN)


def more(**changes: Any) -> int:
    """What is asked for next, at a hundredth of a second a sample."""
    return run.more(replace(FOUND, **changes), 0.02, KIN, EFFORT, 0.01)


def test_a_line_that_resolves_its_aim_is_done() -> None:
    assert more() == 0


def test_a_line_that_does_not_goes_on_for_as_much_as_it_lacks_and_as_its_time_allows() -> None:
    lacking = more(relative_error=3e-3)
    assert 50 < lacking < 400
    assert more(relative_error=3e-2) == run.GROWTH * 100
    assert more(relative_error=3e-2, seconds=9.95) == run.GROWTH * 100  # above 10 %: up to the cap
    assert more(relative_error=5e-3, seconds=9.95) == 5
    assert more(relative_error=5e-3, seconds=10) == 0
    assert more(relative_error=3e-2, seconds=50) == 0


def test_few_samples_and_what_looks_wrong_are_not_believed() -> None:
    assert more(samples=1, relative_error=0) > 0
    assert more(probability=1e-9) == run.GROWTH * 100
    assert more(probability=1e-9, seconds=50) == 0
    assert more(not_finite=1, probability=0) == 0


def test_a_line_that_might_hide_a_tenth_is_not_decided() -> None:
    lines = [line(), line(relative_error=2e-2), line(probability=0), line(probability=0, found=1.05, flaw="why")]
    table = Table(lines, MADE, 0, False)
    assert [said for _, said in table.judged()] == ["holds", "not decided", "fails", "fails"]
    assert table.failing() == [lines[2]] and not table.holds()
    assert Table(lines[:2] + lines[3:], MADE, 0, False).holds()


def test_kinds_are_judged_apart() -> None:
    doubtful = level(KIN) / 2
    alone = Table([line(probability=doubtful)], MADE, 0, False)
    beside_many = Table([*(line("another") for _ in range(1000)), line(probability=doubtful)], MADE, 0, False)
    assert len(alone.failing()) == len(beside_many.failing()) == 1


def test_of_few_rows_rendered_no_more_are_refused_than_of_all() -> None:
    assert refused([level(3) * 1.01], 3) == [False] and refused([level(3) * 0.99], 3) == [True]
    assert refused([1e-9, level(2) * 0.99, 0.5], 3) == [True, True, False]


def test_a_truths_own_error_counts() -> None:
    random = np.random.default_rng(1)
    images, truth = random.normal(1, 0.1, (16, SIZE, SIZE, 1)), 1.02 + random.normal(0, 0.06, 16)
    sampled = Case("row", "case", scene("s"), Sampled(truth), ("pt",), "itself").expected()
    exact = Case("row", "case", scene("s"), 1.02, ("pt",), "theory").expected()
    assert sampled.shape == (16, SIZE, SIZE, 3) and exact.shape == (1, SIZE, SIZE, 3)
    three = np.broadcast_to(images, (16, SIZE, SIZE, 3))
    assert judge(three, exact).probability < 1e-3 < judge(three, sampled).probability


def test_a_line_of_which_nothing_is_seen_where_something_is_fails() -> None:
    assert judge(np.zeros((16, SIZE, SIZE, 3)), np.full((1, SIZE, SIZE, 3), 1e-20)).probability == 0


def test_black_that_is_black_holds() -> None:
    black = judge(np.zeros((16, SIZE, SIZE, 3)), np.zeros((1, SIZE, SIZE, 3)))
    assert (black.probability, black.resolution(KIN)) == (1, 0)


def test_means_of_images_are_judged_as_they_are() -> None:
    images = np.random.default_rng(2).normal(1, 0.01, (16, SIZE, SIZE, 3))
    found = judge(mean(images), np.ones((1, SIZE, SIZE, 3)))
    assert found.found == pytest.approx(1, abs=1e-3) and found.probability > 1e-3


def test_a_methods_name_says_all_of_it() -> None:
    assert options_of("pt/hit")["strategies"] == "hit"
    assert options_of("bdpt+pilot")["strategies"] is None
    assert options_of("pt+guide:march") == {"integrator": "pt", "strategies": None, "tracker": "march", "guide": "always"}
    assert (options_of("bdpt+learnt+sky")["starts"], options_of("bdpt+sky")["sky"]) == ("learnt", "hit")


def test_every_line_of_the_table_has_a_name_of_its_own() -> None:
    lines = [(job.case.row, job.case.name, job.method) for job in run.jobs()]
    assert len(set(lines)) == len(lines) > 300


def test_the_table_says_how_it_was_made() -> None:
    text = Table([line()], Made.by("python3 -m validation stability"), 0, False).markdown()
    assert all(part in text for part in ("tyndall ", "commit ", "load ", report.HOLDS))
