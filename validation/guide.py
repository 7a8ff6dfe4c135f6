"""What a guide gives: time to equal error with `--guide` and without, learning included, by `bdpt` and by `pt`, in scenes lit
through openings, rooms lit indirectly, the Cornell boxes of the founding thesis and a dense cloud."""

import argparse
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tyndall
from tyndall import program
from tyndall.scene import Scene, load
from validation import efficiency, studies, volumes
from validation.files import write_text
from validation.made_by import made_by_command
from validation.places import OUTPUT, REPORTS, SCENES
from validation.statistics import Ratio
from validation.studies import Effort, Found

FOLDER = OUTPUT / "guide"
GALLERY = SCENES / "gallery"


@dataclass(frozen=True)
class Case:
    """A scene, as it is named in the table."""

    name: str
    scene: Path
    parameters: dict[str, str] = field(default_factory=dict)

    @property
    def file(self) -> Path:
        """The scene with its parameters filled in."""
        path = FOLDER / "scenes" / f"{self.name.split()[0].strip(':')}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(load(Scene(self.scene, self.name, self.parameters))))
        return path


def cases(*scenes: Path) -> list[Case]:
    """Scenes as they are."""
    return [Case(scene.stem, scene) for scene in scenes]


CASES = {
    "lit through an opening": cases(
        *(efficiency.FOLDER / f"{name}.xml" for name in ("small_opening", "keyhole", "door_ajar", "skylight", "dusty_window")), GALLERY / "attic.json"
    ),
    "lit indirectly": [
        Case("indirect_room (fig. 5.15)", GALLERY / "indirect_room.json"),
        Case("reflector (fig. 5.14)", GALLERY / "reflector.json"),
        *cases(GALLERY / "three_lights.json", SCENES / "lampbox_up.xml"),
    ],
    "P03T's boxes": [
        Case("A: empty", GALLERY / "cornell_d.json", {"medium": "0"}),
        Case("B: blocks", GALLERY / "cornell_e.json", {"medium": "0"}),
        Case("C: a glossy block", GALLERY / "cornell_e.json", {"medium": "0", "glossy": "1"}),
        Case("D: fog in a half", GALLERY / "cornell_d.json"),
        Case("E: blocks in fog", GALLERY / "cornell_e.json"),
        Case("F: fog that scatters forwards", GALLERY / "cornell_f.json"),
    ],
    "dense cloud": cases(GALLERY / "cumulus.json"),
    "lit openly": [Case("floating_cubes (fig. 5.23)", GALLERY / "floating_cubes.json")],
}
WANTED = {"lit through an opening": 5.0, "lit indirectly": 2.0, "P03T's boxes": 0.9, "dense cloud": 1.5, "lit openly": 0.9}
"""How many times less a guide shall cost by bdpt; by pt it is WANTED_PT in the boxes."""
WANTED_PT = 2.0
WAYS = {
    "bdpt": "--integrator bdpt --starts emitted --guide never",
    "bdpt, starts": "--integrator bdpt --guide never",
    "bdpt, guide": "--integrator bdpt --guide auto",
    "pt": "--integrator pt",
    "pt, guide": "--integrator pt --guide auto",
    "gather": "--integrator gather",
}
"""What is rendered."""
GAINS = {
    "starts": ("bdpt", "bdpt, starts"),
    "bdpt": ("bdpt", "bdpt, guide"),
    "pt": ("pt", "pt, guide"),
    "gather over pt": ("pt", "gather"),
    "gather over bdpt": ("bdpt, starts", "gather"),
}
"""What is compared: relMSE x seconds of the one over that of the other."""


@dataclass(frozen=True)
class Row:
    """What was found in a scene."""

    kind: str
    name: str
    gains: dict[str, Ratio]
    """By the names of GAINS."""
    learnt: dict[str, Any]
    """What `tyndall guide --json` says."""
    follows: dict[str, bool]
    """Whether `bdpt` and `pt` by `--guide auto` follow the guide."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--seconds", type=float, default=10, help="of each render, learning included (default %(default)s)")
    command.add_argument("--reference-seconds", type=float, default=100, help="of each reference (default %(default)s)")
    command.add_argument("--seeds", type=int, default=10, help="independent renders of each kind, at least 2 (default %(default)s)")
    command.add_argument("--scenes", nargs="+", metavar="NAME", help="those whose names begin so (default all)")
    command.add_argument("--size", default="96x72", help="of all images (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for guide.md (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures and writes the table; true if a guide gives what it shall everywhere."""
    volumes.write()
    wanted = tuple(options.scenes or [""])
    chosen = [(kind, case) for kind, cases in CASES.items() for case in cases if case.name.startswith(wanted)]
    effort = Effort(options.seeds, options.seconds, options.reference_seconds, options.size, options.threads)
    study = studies.measured([case.file for _, case in chosen], WAYS, effort, FOLDER / "study", by=WAYS["bdpt, guide"])
    rows = [row_of(kind, case, found, options) for (kind, case), found in zip(chosen, study.scenes)]
    text = page(rows, options)
    write_text(options.output / "guide.md", text)
    print(text)
    return all(row.gains["bdpt"].mean >= WANTED[row.kind] for row in rows)


def row_of(kind: str, case: Case, found: Found, options: argparse.Namespace) -> Row:
    """What the study says of a scene, and what a guide learns there."""
    gains = {name: found.ratio(plain, other) for name, (plain, other) in GAINS.items()}
    given = program.flags({"json": True, "size": options.size, "threads": options.threads})
    learn = [str(program.binary()), "--quiet", "guide", str(case.file), "--output", str(FOLDER / case.file.stem), *given]
    plans = {by: json.loads(tyndall.info(case.file, json=True, integrator=by, guide="auto", spp=64))["plan"] for by in ("bdpt", "pt")}
    return Row(kind, case.name, gains, json.loads(program.call(learn).stdout), {by: plan["guided"] for by, plan in plans.items()})


def page(rows: list[Row], options: argparse.Namespace) -> str:
    """The report."""
    command = made_by_command()
    return (
        f"# What a guide gives\n\n    {command}\n\n"
        f"relMSE x seconds without path guiding (`--starts emitted --guide never`) over that with it (`--guide auto`, the default of `bdpt`), {options.seconds:g} s each, training and pilots included. *Followed*: whether `auto` guided. {options.size} pixels, {options.threads} threads, "
        f"{options.seeds} seeds; intervals hold 95 %. The reference is a render of {options.reference_seconds:g} s by `bdpt --guide auto`; its own relMSE is subtracted. *Starts*: learnt starts of light subpaths alone, where the pilot of `bdpt` finds "
        "them worth learning; the guide includes them. *gather*: `pt`, and `bdpt` with its starts, over the preview `gather`. [thresholds.md](thresholds.md) has P03T's boxes by a path tracer like P03T's own, at its thresholds.\n\n"
        "| scene | starts | guide, by bdpt | wanted | followed | guide, by pt | wanted | followed | gather over pt | over bdpt | learning | memory | portals | cells of surfaces, media | guided on surfaces, in media (camera's walks) |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n" + "".join(map(line, rows))
    )


def line(row: Row) -> str:
    """Of the table."""
    kinds = [row.learnt[kind] for kind in ("surfaces", "media")]
    cells = ", ".join(str(kind["cells"]) for kind in kinds)
    guided = ", ".join(f"{100 * kind['guided'][0]:.0f} %" for kind in kinds)
    over_pt = f"{WANTED_PT:g}" if row.kind == "P03T's boxes" else ""
    bdpt, pt = ("yes" if row.follows[by] else "no" for by in ("bdpt", "pt"))
    return (
        f"| {row.name} ({row.kind}) | {row.gains['starts']} | {row.gains['bdpt']} | {WANTED[row.kind]:g} | {bdpt} | {row.gains['pt']} | {over_pt} | {pt} | {row.gains['gather over pt']} | {row.gains['gather over bdpt']} | {row.learnt['seconds']:.1f} s | "
        f"{row.learnt['bytes'] / 2**20:.1f} MiB | {len(row.learnt['portals'])} | {cells} | {guided} |\n"
    )
