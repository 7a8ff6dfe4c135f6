"""Every command of the manual runs, at small sizes, in the order of its page, and every block of Python."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
import tyndall
from tyndall import program
from validation.places import PYTHON, ROOT, SCENES

PAGES = [*sorted((SCENES / "manual").glob("*.md")), ROOT / "README.md"]
SMALLER = {
    r"--size \S+": "--size 12x9",
    r"--samples 0\.\.32": "--samples 0..2",
    r"--samples 32\.\.64": "--samples 2..4",
    r"--crop 120x180\+0\+0": "--crop 12x18+0+0",
    r"--crop 120x180\+120\+0": "--crop 12x18+12+0",
    r"--crop 80x60\S+": "--crop 8x6+4+4",
    r"--spp \d+": "--spp 2",
    r"--time-limit \S+": "--time-limit 1s",
    r"--seconds \S+": "--seconds 0.1",
    r"--seeds \d+": "--seeds 2",
    r"--doublings \d+": "--doublings 2",
    r"--points \d+": "--points 2",
    r"--frames 0\.\.47": "--frames 0..1",
    r"-D res=\d+": "-D res=12",
    r"--outliers 5": "--outliers 2",
    r"^tyndall view": "timeout --signal INT 2 tyndall view",
}
"""What makes the commands quick: the scenes are small too."""
NAMES = {"SCENE": "fog.json", "PLUGIN": "spot"}
"""Words that stand for any."""
MENTIONS = re.compile(r"tyndall (\w+|render --frames|render --error)")
"""Commands without what they are for: named, not told to be run."""


def commands(page: Path) -> list[str]:
    """Those that stand indented or in the middle of a line; tables of output are none."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    found = [(m.start(), m[1]) for m in re.finditer(r"^ {4,6}((?:tyndall|python3 -m validation|cargo run).*)$", text, re.MULTILINE)]
    if page.name != "README.md":  # the table of which shows forms: test_readme.py
        found += [(m.start(), re.sub(r"\s+", " ", m[1])) for m in re.finditer(r"`(tyndall [^`]+)`", text) if not MENTIONS.fullmatch(m[1])]
    return [line for _, line in sorted(found)]


def first_fog() -> dict:
    """The scene that the first chapter ends with, small."""
    clear, fog, camera = re.findall(r"```json\n(.*?)```", (SCENES / "manual" / "first-fog.md").read_text(), re.DOTALL)
    scene = json.loads(f"{clear.rstrip().removesuffix('}')},\n{fog}}}")
    scene["camera"] |= json.loads(f"{{{camera.rstrip().rstrip(',')}}}")
    scene["camera"]["film"] |= {"width": 24, "height": 18}
    scene["camera"]["sampler"] = {"type": "independent", "sample_count": 2}
    scene["fog"]["sigma_t"] = "$density"
    return {**scene, "$defaults": {"density": 0.15}}


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the files that the pages speak of, and the program on the path."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "tyndall").symlink_to(Path(program.binary()).resolve())
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), str(PYTHON)]))
    monkeypatch.setenv("TYNDALL_PYTHON", sys.executable)
    monkeypatch.setenv("TYNDALL_BINARY", str(program.binary()))
    (tmp_path / "scenes").symlink_to(SCENES)
    for name in ("fog", "other", "scene"):
        (tmp_path / f"{name}.json").write_text(json.dumps(first_fog()))
    for name in ("plume", "cloud", *(f"plume_{number:04}" for number in range(3))):
        shutil.copy(SCENES / "gallery" / "assets" / "cumulus.vdb", f"{name}.vdb")
    for name in ("a", "my_scene", "mitsuba_scene", "scene"):
        shutil.copy(SCENES / "lampbox_down.xml", f"{name}.xml")
    for seed, name in enumerate(("fog", "a", "b", "A", "B")):
        subprocess.run(["tyndall", "render", "fog.json", "--seed", str(seed), "-o", f"{name}.exr"], check=True, capture_output=True)
    return tmp_path


def smaller(line: str) -> str:
    """A command that does as much as the page's, in less time."""
    if "--help" in line:
        return line
    line = re.sub(r"^cargo run --release -- ", "tyndall ", line).replace("python3 ", f"{shlex.quote(sys.executable)} ", 1)
    line = " ".join(NAMES.get(word, word) for word in line.split(" "))
    for pattern, replacement in SMALLER.items():
        line = re.sub(pattern, replacement, line)
    named = re.search(r"tyndall render (\S+)", line)
    if named and named[1] != "fog.json" and not re.search(r"--size|--crop|-D res", line):
        line += " --size 12x9"
    if named and not re.search(r"--spp|--time-limit|--error|--samples|--resume", line):
        line += " --spp 2"
    if "validation compare" in line:
        line += " --size 8x6 --batches 4 --spp 2"
    if "validation efficiency" in line:
        line += " --seconds 0.1 --reference-seconds 0.5 --seeds 2 --size 8x6"
    if "tyndall study" in line and "--seconds" not in line:
        line += " --seconds 0.1 --seeds 2 --doublings 2"
    return line


def codes(line: str) -> tuple[int, ...]:
    """Those with which it may end."""
    if "tyndall view" in line:
        return (124,)  # it serves until it is stopped
    # A comparison of a few samples may find a difference.
    return (0, 1) if "validation compare" in line or "--fail-above" in line else (0,)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_command_runs(page: Path, desk: Path) -> None:
    wrong = []
    for line in commands(page):
        if " new fog" in line:
            (desk / "fog.json").unlink()
        done = subprocess.run(["bash", "-c", smaller(line)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode not in codes(line) or "panicked" in done.stderr:
            wrong.append(f"{line}\n  as {smaller(line)}\n  {done.returncode}: {done.stdout[-300:]}{done.stderr[-600:]}")
    assert not wrong, "\n".join(wrong)


def test_the_comparison_runs(desk: Path) -> None:
    block = re.search(r"((?:^    .*\n)*^    import tyndall\n(?:^    .*\n)*)", (SCENES / "manual" / "compare.md").read_text(), re.MULTILINE)
    assert block and '"my_scene.xml"' in block[1]
    names: dict[str, object] = {}
    exec(textwrap.dedent(block[1]).replace('"my_scene.xml"', '"my_scene.xml", seconds=4'), names)
    assert isinstance(names["found"], tyndall.Comparison)


def test_there_are_commands() -> None:
    assert sum(len(commands(page)) for page in PAGES) > 80
