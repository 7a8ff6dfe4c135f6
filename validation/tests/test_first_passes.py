"""What first passes are compared with, and what is said of them."""

import json
from pathlib import Path

import pytest

from tyndall.failure import Failure
from tyndall.statistics import Ratio
from validation import cli, first_passes
from validation.first_passes import BDPT, PT, Row
from validation.studies import Effort

SURELY, PERHAPS, NOT = Ratio(1.5, 2, 3), Ratio(0.8, 1.2, 2), Ratio(0.2, 0.3, 0.4)
EFFORT = Effort(3, 1.5, 8, "96x72")


def test_a_contender_is_measured_and_one_that_cannot_render_is_noted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(first_passes, "FIRST_PASSES", {"nobody": "--integrator pt --basis nothing"})
    monkeypatch.setattr(first_passes, "CONTENDERS", {**first_passes.PLAIN, **first_passes.FIRST_PASSES})
    little = ["--only", "D:", "--size", "16x12", "--seeds", "2", "--seconds", "0.1", "--reference-seconds", "0.2", "--output", str(tmp_path)]
    assert cli.main(["first_passes", "--against", "nobody", *little]) == 1, "nobody pays nowhere"
    [row] = json.loads((tmp_path / "first_passes.json").read_text())
    assert 0 < row["over"][PT][BDPT]["mean"] and list(row["over"][PT]) == [BDPT] and list(row["over"][BDPT]) == [PT]
    assert row["seconds"][PT] == pytest.approx(0.1, rel=0.9) and 0 <= row["first_pass"][PT] < 0.1
    assert "- D: fog in a half: nobody: invalid value 'nothing'" in (tmp_path / "first_passes.md").read_text()


def test_where_each_pays_is_read_from_the_table() -> None:
    rows = [
        Row("A: empty", {PT: {BDPT: SURELY, "links": SURELY, "bins": NOT}, BDPT: {PT: NOT, "links": PERHAPS, "bins": NOT}}, {"links": 0.2, "bins": 4.0}, {"links": 1.5, "bins": 4.8}, 0, []),
        Row("reflector (fig. 5.14)", {PT: {BDPT: PERHAPS, "links": SURELY}, BDPT: {PT: PERHAPS, "links": SURELY}}, {"links": 0.1}, {"links": 1.6}, 0, ["bins: no"]),
    ]
    text = first_passes.page(rows, ["links", "bins"], EFFORT)
    assert "- *links* surely has less error than `pt` in A, reflector; than `bdpt`, in reflector." in text
    assert "- *bins* surely has less error than `pt` in no scene; than `bdpt`, in no scene." in text
    assert "| A: empty | 0.2 | 4.0 (4.8) |" in text and "| reflector (fig. 5.14) | 0.1 |  |" in text
    assert f"| reflector (fig. 5.14) | {PERHAPS} | {SURELY} |  |" in text and "- reflector (fig. 5.14): bins: no" in text


def test_names_that_are_none_are_refused() -> None:
    with pytest.raises(Failure, match="nobody: no such contender"):
        cli.main(["first_passes", "--against", "nobody"])
    with pytest.raises(Failure, match="no scene has this in its name"):
        cli.main(["first_passes", "--only", "nowhere"])
