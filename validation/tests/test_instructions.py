"""Counted instructions: how valgrind's answer is read, and what follows from a record."""

import json
from pathlib import Path

import pytest

from validation import instructions


def test_valgrinds_answer_is_read() -> None:
    assert instructions.collected("==7== Events    : Ir\n==7== Collected : 123456\n==7==") == 123456


@pytest.mark.parametrize(("count", "holds"), [(1010.0, True), (1030.0, False), (970.0, False)])
def test_counts_are_held(count: float, holds: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instructions, "RECORD", tmp_path / "instructions.json")
    monkeypatch.setattr("shutil.which", lambda _: "valgrind")
    monkeypatch.setattr(instructions, "per_sample", lambda _: 1000.0)
    assert instructions.run(record=False), "nothing is recorded"
    assert instructions.run(record=True) and set(json.loads((tmp_path / "instructions.json").read_text()).values()) == {1000}
    monkeypatch.setattr(instructions, "per_sample", lambda _: count)
    assert instructions.run(record=False) == holds


def test_without_valgrind_nothing_fails(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    assert instructions.run(record=False) and "valgrind was not found" in capsys.readouterr().out


def test_the_table_has_a_scene_for_every_profile() -> None:
    profiles = list(map(instructions.profile_of, instructions.scenes()))
    assert profiles == ["vacuum", "fog", "bounded", "smoke", "fire", "chromatic-fog", "chromatic-bounded"]


def test_a_line_tells_what_part_is_saved() -> None:
    cells = [instructions.Cell("fog", "a", way, fitted, 2000.0) for way, fitted in (("pt", 1500.0), ("bdpt", 2000.0))]
    assert list(instructions.rows(cells)) == ["| `fog` | a | 1.5 of 2.0: 25.0 % | 2.0 of 2.0: 0.0 % |"]
