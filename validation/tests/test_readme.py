"""What the README of the repository names exists and works; every link of the manual leads somewhere."""

import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import tyndall
from tyndall import program

from validation.places import ROOT

TEXT = (ROOT / "README.md").read_text()
PAGES = [*ROOT.glob("*.md"), *(ROOT / "scenes").rglob("*.md"), *(ROOT / "validation").rglob("*.md")]
LINKS = [(page, link) for page in PAGES for link in re.findall(r"\]\(([^)]+)\)", page.read_text()) if not link.startswith("http")]


def help_of(*command: str) -> str:
    """What the program says of a command."""
    return subprocess.run([program.binary(), *command, "--help"], capture_output=True, text=True, check=True).stdout


def commands() -> set[str]:
    """All commands but `help`."""
    listed = re.search(r"Commands:\n((?:  .*\n)+)", help_of())
    assert listed
    return set(re.findall(r"^  (\w+)", listed[1], re.MULTILINE)) - {"help"}


def test_the_table_lists_every_command() -> None:
    named = re.findall(r"`tyndall (\w+)[^`]*`", "\n".join(line for line in TEXT.splitlines() if line.startswith("| `tyndall")))
    assert set(named) == commands()


def test_every_option_is_one() -> None:
    known = {option for command in commands() for option in re.findall(r"--[\w-]+", help_of(command))}
    named = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", TEXT)) - {"--release", "--locked", "--path"}
    assert named and named <= known, named - known


def anchors(page: Path) -> set[str]:
    """Names that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize(("page", "link"), LINKS)
def test_every_link_leads_somewhere(page: Path, link: str) -> None:
    name, _, anchor = link.partition("#")
    target = page.parent / name if name else page
    assert target.exists()
    assert not anchor or anchor in anchors(target)


def test_the_example_in_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = re.search(r"((?:^    .*\n)*^    import tyndall\n(?:^    .*\n)*)", TEXT, re.MULTILINE)
    assert code
    render = tyndall.render
    monkeypatch.setattr(tyndall, "render", lambda scene, **options: render(ROOT / scene, **{**options, "spp": 1, "size": (32, 24)}))
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(re.sub("^    ", "", code[1], flags=re.MULTILINE), names)  # noqa: S102
    assert Path("fog.exr").is_file()
