"""First passes (P03T ch. 4) and their uses: the coarse solution itself, paths that end in it, and path tracing by densities over its
links, beside other guides and none. relMSE after the same seconds, first pass included."""

import argparse
import json
import shlex
import statistics
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from tyndall import program
from tyndall.commands import diff
from tyndall.failure import Failure
from tyndall.statistics import Ratio
from validation import guide, studies
from validation.files import write_report
from validation.guide import GALLERY, Case
from validation.places import REPORTS
from validation.studies import Effort, Reference

CASES = [
    *guide.CASES["P03T's boxes"],
    Case("reflector (fig. 5.14)", GALLERY / "reflector.json"),
    Case("indirect_room (fig. 5.15)", GALLERY / "indirect_room.json"),
    Case("three_lights (fig. 5.22)", GALLERY / "three_lights.json"),
    Case("floating_cubes (fig. 5.23)", GALLERY / "floating_cubes.json"),
    Case("clusters (fig. 4.2)", GALLERY / "clusters.json"),
]
PT, BDPT = "pt", "bdpt"
PLAIN = {PT: "--integrator pt", BDPT: studies.BDPT}
"""What needs no first pass."""
FIRST_PASSES = {
    "quadtree": "--integrator pt --guide always --basis quadtree",
    "bins": "--integrator pt --guide always --basis bins",
    "links": "--integrator pt --guide always --basis links",
    "first pass by links": "--integrator first-pass --first-pass links",
    "first pass by particles": "--integrator first-pass --first-pass particles",
    "gather by links": "--integrator gather --first-pass links",
    "gather by particles": "--integrator gather --first-pass particles",
}
CONTENDERS = {**PLAIN, **FIRST_PASSES}
SAMPLING = 0.5
"""The part of its seconds that each has for samples, at least; who needs the others before gets more of them,"""
ROOM = 1.1
"""so many times as many as it needed: no two renders take the same time."""
LATE = 1.1
"""So many times as long as it should a render takes where that is told."""


@dataclass(frozen=True)
class Render:
    """What was found of one render."""

    relmse: float
    seconds: float


@dataclass(frozen=True)
class Row:
    """A scene, and what was found by the names of those that could render it."""

    scene: str
    over: dict[str, dict[str, Ratio]]
    """By PLAIN: its relMSE over that of others, after as many seconds as these take."""
    first_pass: dict[str, float]
    """Seconds of a render of one sample per pixel, which takes little more."""
    seconds: dict[str, float]
    """The median of those of all samples."""
    reference: float
    """Its own relMSE, which is subtracted from all."""
    notes: list[str]

    def beats(self, name: str, plain: str) -> bool:
        """Surely."""
        return name in self.over[plain] and self.over[plain][name].low > 1


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--only", metavar="TEXT", default="", help="scenes whose names contain this")
    command.add_argument("--against", metavar="LIST", default=",".join(FIRST_PASSES), help="contenders beside pt and bdpt, separated by commas (default: %(default)s)")
    command.add_argument("--quick", action="store_true", help="2 seeds, 0.5 s, references of 3 s")
    command.add_argument("--seeds", type=int, help="renders of each kind, at least 2 (default 3)")
    command.add_argument("--seconds", type=float, help="of each render, but half of them at least after its first pass (default 1.5)")
    command.add_argument("--reference-seconds", type=float, help="of each reference that is not there yet (default 8)")
    command.add_argument("--size", default="96x72", help="of all images (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for first_passes.md and .json (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures and writes the tables; true if each first pass pays somewhere."""
    effort, names = effort_of(options), list(filter(None, options.against.split(",")))
    wrong = next((name for name in names if name not in FIRST_PASSES), None)
    if wrong:
        raise Failure(f"--against {wrong}: no such contender", f"choose among {', '.join(FIRST_PASSES)}")
    rows = [row_of(case, [*PLAIN, *names], effort) for case in CASES if options.only in case.name]
    if not rows:
        raise Failure(f"--only {options.only}: no scene has this in its name", f"name a part of one of {', '.join(case.name for case in CASES)}")
    write_report("first_passes", "What a first pass gives", page(rows, names, effort), [asdict(row) for row in rows], options.output)
    return all(any(row.beats(name, PT) for row in rows) for name in names)


def effort_of(options: argparse.Namespace) -> Effort:
    """What was asked for, or else its default."""
    usual = Effort(2, 0.5, 3) if options.quick else Effort(3, 1.5, 8)
    return Effort(options.seeds or usual.seeds, options.seconds or usual.seconds, options.reference_seconds or usual.reference_seconds,
                  options.size, options.threads)  # fmt: skip


def row_of(case: Case, names: list[str], effort: Effort) -> Row:
    """Renders a scene by all of them, in turn; who cannot is noted, and left out."""
    scene = case.file()
    reference = studies.reference(scene, effort)
    first: dict[str, float] = {}
    notes: list[str] = []
    for name in names:
        try:
            first[name] = rendered(scene, CONTENDERS[name], effort, reference, spp=1).seconds
        except Failure as failure:
            notes.append(f"{name}: {' '.join(failure.problem.split())}")
    limits = {name: max(effort.seconds, ROOM * seconds + SAMPLING * effort.seconds) for name, seconds in first.items()}
    made: dict[str, list[Render]] = {name: [] for name in first}
    for seed in range(effort.seeds):
        for name, renders in made.items():
            renders.append(rendered(scene, CONTENDERS[name], effort, reference, seed=seed, time_limit=f"{limits[name]:.3f}s"))
    noise = reference.relmse or 0.0
    costs = {name: [max(one.relmse - noise, one.relmse / 2) * one.seconds for one in renders] for name, renders in made.items()}
    over = {plain: {name: Ratio.of(costs[plain], costs[name]) for name in made if name != plain} for plain in PLAIN}
    seconds = {name: statistics.median(one.seconds for one in renders) for name, renders in made.items()}
    row = Row(case.name, over, first, seconds, noise, notes)
    print(line_of_errors(row, names), end="", flush=True)
    return row


def rendered(scene: Path, words: str, effort: Effort, reference: Reference, **more: program.Option) -> Render:
    """One render, by more options."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        image, report = Path(folder, "image.exr"), Path(folder, "report.json")
        own = program.flags({"output": image, "report": report, **more})
        program.call([str(program.binary()), "--quiet", "render", str(scene), *shlex.split(words), *own, *effort.given()])
        return Render(diff(image, reference.image)["radiance"]["relmse"], json.loads(report.read_text())["render_seconds"])


def page(rows: list[Row], names: list[str], effort: Effort) -> str:
    """The report."""
    others = [BDPT, *names]
    return "\n".join([
        "A first pass (P03T ch. 4) solves for the light of a scene coarsely: by links between clusters (4.2), or by particles (4.3). *links*, beside *quadtree* and *bins*, is "
        "`pt --guide always` by that basis; *first pass* is the solution itself, *gather* ends paths in it; both are biased.\n",
        f"Below, the relMSE of `pt` over that of others after the same seconds: {effort.seconds:g} s, the first pass included, {effort.size} pixels, {effort.threads} threads, {effort.seeds} seeds; "
        "intervals hold 95 %. A contender has half of these seconds for its samples at least. If its first pass leaves it less, it renders for longer, and `pt` is taken after as many seconds. "
        "References are by `bdpt`; their own noise is subtracted. The error of a biased contender stops falling: its ratio holds for these seconds only.\n",
        f"| scene | {' | '.join(others)} |",
        "|---" * (1 + len(others)) + "|",
        *(line_of_errors(row, others).rstrip() for row in rows),
        "\nSeconds of a render of one sample per pixel, most of which are those of the first pass; in brackets, seconds of the whole render where it took longer than it should:\n",
        f"| scene | {' | '.join(names)} |",
        "|---" * (1 + len(names)) + "|",
        *(line_of_seconds(row, names, effort.seconds) for row in rows), "",
        *(f"- *{name}* surely has less error than `pt` in {scenes(rows, name, PT)}; than `bdpt`, in {scenes(rows, name, BDPT)}." for name in names),
        *(f"- {row.scene}: {note}" for row in rows for note in row.notes), "",
    ])  # fmt: skip


def line_of_errors(row: Row, names: list[str]) -> str:
    """Of the first table."""
    return f"| {' | '.join([row.scene, *(str(row.over[PT].get(name, '')) for name in names if name != PT)])} |\n"


def line_of_seconds(row: Row, names: list[str], limit: float) -> str:
    """Of the second table."""
    late = {name: f" ({seconds:.1f})" for name, seconds in row.seconds.items() if seconds > LATE * limit}
    told = {name: f"{seconds:.1f}{late.get(name, '')}" for name, seconds in row.first_pass.items()}
    return f"| {' | '.join([row.scene, *(told.get(name, '') for name in names)])} |"


def scenes(rows: list[Row], name: str, plain: str) -> str:
    """Where it surely has less error."""
    return ", ".join(row.scene.split()[0].strip(":") for row in rows if row.beats(name, plain)) or "no scene"
