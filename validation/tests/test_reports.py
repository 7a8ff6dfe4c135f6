"""Recorded numbers are of today's sources or accepted for them, and pages show what the reports say."""

import re
import subprocess
from pathlib import Path

import pytest

from validation import record, sources, tables


def test_every_report_is_of_these_sources_or_accepted() -> None:
    late = record.out_of_date()
    assert not late, f"{late}: renew them (python3 -m validation record), or say why they are still valid (--accept WHY {' '.join(late)})"


def test_tables_of_pages_are_those_of_the_reports() -> None:
    assert not tables.stale(), "python3 -m validation record --tables"


def test_a_number_changed_by_hand_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "README.md"
    page.write_text(re.sub(r"(pool.*\| )0", r"\g<1>9", tables.PAGES[0].read_text()))
    monkeypatch.setattr(tables, "PAGES", (page,))
    assert tables.stale() == [page]


def test_comments_and_tests_are_no_sources() -> None:
    assert sources.bare("let a = 1; // one\n") == sources.bare("let a  =\n1;\n#[cfg(test)]\nmod tests {\n  a\n}\n")
    assert sources.bare("let a = 1;") != sources.bare("let a = 2;")


def test_what_is_accepted_takes_the_place_of_what_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "accepted.md"
    file.write_text(record.ACCEPTANCE + "| bias | 000000000000 | old |\n| guide | 000000000000 | old |\n")
    monkeypatch.setattr(record, "ACCEPTED", file)
    record.accept(["bias"], "a name changed")
    assert file.read_text() == record.ACCEPTANCE + f"| guide | 000000000000 | old |\n| bias | {sources.digest()} | a name changed |\n"
    assert "bias" not in record.out_of_date()


@pytest.mark.parametrize(("code", "is_written", "expected"), [(0, True, "new"), (1, True, "new"), (1, False, "old"), (2, False, "old"), (-11, True, "old")])
def test_a_report_is_renewed_once_it_is_whole(code: int, is_written: bool, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def command(words: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        if is_written:
            Path(words[-1], "bias.md").write_text("new")
        return subprocess.CompletedProcess(words, code)

    (tmp_path / "bias.md").write_text("old")
    monkeypatch.setattr(record, "REPORTS", tmp_path)
    monkeypatch.setattr(record, "FOLDER", tmp_path / "record")
    monkeypatch.setattr(subprocess, "run", command)
    assert record.Part("bias", (".md",), 1).run("bias") == (code == 0)
    assert (tmp_path / "bias.md").read_text() == expected
