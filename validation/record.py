"""Renews every recorded number: each part is one of this package's commands, whose report goes to validation/reports once it is whole.
A report names the sources it was made from (see `sources`); one of other sources is out of date, until it is renewed or accepted."""

import argparse
import json
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tyndall import program
from tyndall.failure import Failure
from validation import tables
from validation.files import write_text
from validation.made import Made, sources_of
from validation.places import OUTPUT, REPORTS, ROOT
from validation.sources import digest, paths
from validation.stability.kept import binary

FOLDER = OUTPUT / "record"
ACCEPTED = REPORTS / "accepted.md"
ACCEPTANCE = "# Reports that later sources leave valid\n\n| report | sources | why |\n|---|---|---|\n"
GPU = " ".join(f"scenes/efficiency/{name}.xml" for name in ("fog_room", "dusty_window", "skylight", "headlights", "glass_fog_sky", "plume", "door_ajar"))
CURVES = "scenes/lampbox_down.xml scenes/lampbox_up.xml scenes/efficiency/plume.xml scenes/efficiency/cloud.xml scenes/efficiency/pool.xml scenes/foggy_room.json"


@dataclass(frozen=True)
class Part:
    """A command of this package, what it writes, and how long it takes two processors."""

    command: str
    ends: tuple[str, ...]
    """Of the names of its files."""
    minutes: int
    study: bool = False
    """The page of its study is the report."""
    found: str = ""
    """What the command calls its report, where that is another name."""
    needs: str = ""
    """A program that not every machine has."""

    @property
    def is_possible(self) -> bool:
        """Here."""
        return not self.needs or shutil.which(self.needs) is not None

    def run(self, name: str) -> bool:
        """Renews the report; true if what it checks holds. What an interrupted run of this very program left is taken over."""
        folder, stamp = FOLDER / name, FOLDER / name / "program"
        if not stamp.is_file() or stamp.read_text() != binary():
            shutil.rmtree(folder, ignore_errors=True)
            write_text(stamp, binary())
        found = self.found or name
        (folder / f"{found}.md").unlink(missing_ok=True)
        command = [sys.executable, "-m", "validation", *shlex.split(self.command), "--output", str(folder)]
        code = subprocess.run(command, cwd=ROOT).returncode
        if code not in (0, 1) or not (self.study or (folder / f"{found}.md").is_file()):
            return False
        if self.study:
            self.draw(folder / f"{name}.md")
        for end in self.ends:
            write_text(REPORTS / f"{name}{end}", (folder / f"{found}{end}").read_text())
        return code == 0

    def draw(self, report: Path) -> None:
        """The report of a study, with how it was made below its title."""
        program.call([str(program.binary()), "report", str(report.parent), "--record", str(report.parent)])
        title, rest = report.read_text().replace(f"{ROOT}/", "").split("\n", 1)
        write_text(report, f"{title}\n\n{Made.by(f'python3 -m validation {self.command}')}.\n{rest}")


PARTS = {
    "stability": Part("stability", (".md",), 40),
    "efficiency": Part("efficiency --seeds 6 --seconds 0.6 --reference-seconds 12 --against pt,volpath,volpathmis", (".md", ".json"), 20),
    "convergence": Part(f"efficiency {CURVES} --size 96x96 --points 5 --seeds 6 --seconds 1 --against pt,lt,volpath,volpathmis", (".md", ".svg", "_strips.svg"), 20, study=True),
    "guide": Part("efficiency --suite guide --seeds 4 --seconds 3 --reference-seconds 30", (".md", ".json"), 40),
    "gpu": Part(f"efficiency scenes/lampbox_up.xml {GPU} --seeds 3 --seconds 0.4 --reference-seconds 5 --threads 16 --against volpath:cuda_ad_rgb", (".md",), 4, found="efficiency", needs="nvidia-smi"),
    "intervals": Part("intervals", (".md", ".json"), 10),
    "instructions": Part("instructions --table", (".md",), 8, needs="valgrind"),
    "growth": Part("growth", (".md", ".json"), 10, needs="valgrind"),
    "threads": Part("growth --threads", (".md", ".json"), 2),
    "bias": Part("bias", (".md", ".json", ".svg"), 15),
    "thresholds": Part("thresholds", (".md",), 17),
    "progressive": Part("progressive", (".md",), 3),
    "first_passes": Part("first_passes", (".md", ".json"), 30),
}
"""By the names of their reports."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    told = ", ".join(f"{name} ({part.minutes})" for name, part in PARTS.items())
    command.add_argument("parts", nargs="*", metavar="PART", help=f"any of {told}; minutes on two processors (default: those out of date)")
    command.add_argument("--accept", metavar="WHY", help="render nothing: write down why PARTs are still valid for today's sources")
    command.add_argument("--tables", action="store_true", help="render nothing: only write anew the tables that pages take from reports")
    command.add_argument("--list", action="store_true", help="render nothing: say which reports are out of date")


def run(options: argparse.Namespace) -> bool:
    """Does what was asked for; true if all that was renewed holds or, of a list, if nothing is out of date."""
    unknown = [name for name in options.parts if name not in PARTS]
    if unknown:
        raise Failure(f"{', '.join(unknown)}: no part of what is recorded", f"name any of {', '.join(PARTS)}")
    late = out_of_date()
    if options.list:
        print("\n".join(f"{name:12} {late.get(name, 'of these sources')}" for name in PARTS))
        return not late
    if options.accept:
        accept(options.parts or list(late), options.accept)
        return True
    names = [] if options.tables else options.parts or list(late)
    if names:
        check_program()
    for name in names:
        if not PARTS[name].is_possible:
            print(f"{name:12} left as it is: there is no {PARTS[name].needs} here")
    found = {name: PARTS[name].run(name) for name in names if PARTS[name].is_possible}
    tables.renew()
    print("\n".join(f"{name:12} {'holds' if holds else 'DOES NOT HOLD'}" for name, holds in found.items()))
    return all(found.values())


def check_program() -> None:
    """A report names sources: the program must not be older."""
    newest = max(paths(), key=lambda path: path.stat().st_mtime)
    if program.binary().stat().st_mtime < newest.stat().st_mtime:
        raise Failure(f"{program.binary()} is older than {newest.relative_to(ROOT)}", "cargo build --release")


def out_of_date() -> dict[str, str]:
    """The reports that are neither of today's sources nor accepted for them, and what each says."""
    accepted = {name for name, of in re.findall(r"^\| (\w+) \| (\w+) \|", ACCEPTED.read_text(), re.MULTILINE) if of == digest()}
    told = {name: sources_of(REPORTS / f"{name}.md") for name in PARTS if name not in accepted}
    return {name: f"of sources {of}, not {digest()}" for name, of in told.items() if of != digest()}


def accept(names: list[str], why: str) -> None:
    """Writes down that reports stay valid; what was said of them before goes."""
    kept = [line for line in ACCEPTED.read_text().removeprefix(ACCEPTANCE).splitlines() if line.split(" | ")[0].removeprefix("| ") not in names]
    write_text(ACCEPTED, ACCEPTANCE + "".join(f"{line}\n" for line in [*kept, *(f"| {name} | {digest()} | {why} |" for name in names)]))
