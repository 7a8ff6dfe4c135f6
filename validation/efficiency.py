"""Time to equal error, relMSE x seconds, as one number a scene: how many times as efficient Tyndall is as the better of Mitsuba's
`volpath` and `volpathmis`, beside its own `pt`, `lt` and subsets of strategies. By default on `scenes/efficiency/` and the lamp
boxes; the references are long renders that are kept."""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tyndall.failure import Failure
from validation import studies, volumes
from validation.contender import INTEGRATORS
from validation.files import write_text
from validation.made_by import made_by_command
from validation.places import OUTPUT, REPORTS, SCENES
from validation.statistics import Ratio
from validation.studies import BDPT, MITSUBA, OURS, Effort, Found, Reference, Study

FOLDER = SCENES / "efficiency"
WANTED = {
    SCENES / "lampbox_down.xml": 15,
    SCENES / "lampbox_up.xml": 200,
    FOLDER / "fog_room.xml": 15,
    FOLDER / "dusty_window.xml": 15,
    FOLDER / "skylight.xml": 1,
    FOLDER / "headlights.xml": 80,
    FOLDER / "glass_fog_sky.xml": 4,
    FOLDER / "plume.xml": 3,
    FOLDER / "cloud.xml": 3,
    FOLDER / "nested_media.xml": 3,
    FOLDER / "frosted_pane.xml": 1,
    FOLDER / "small_opening.xml": 1,
    FOLDER / "door_ajar.xml": 1,
    FOLDER / "keyhole.xml": 1,
    FOLDER / "chapel_sun.xml": 1,
    FOLDER / "candles.xml": 1,
    FOLDER / "chromatic_fog.xml": 1,
    FOLDER / "screen.xml": 1,
    FOLDER / "pool.xml": 1,
    FOLDER / "smoky_room.xml": 1,
}
"""How many times as efficient as Mitsuba Tyndall shall be in each scene."""
WANTED_OVER_PT = {"frosted_pane": 100, "small_opening": 100, "door_ajar": 100, "church": 100}
"""How many times as efficient as its own `pt` where light hardly finds the way in."""
WANTED_MEAN = 12
"""The geometric mean of all."""
OWN = {
    "pt": "--integrator pt",
    "lt": "--integrator lt",
    "no lens": "--integrator bdpt --strategies hit,next-event,join",
    "no join": "--integrator bdpt --strategies hit,next-event,lens",
    "no next-event": "--integrator bdpt --strategies hit,join,lens",
}
"""What else Tyndall could do."""
WORSE = 0.05
"""By what part Tyndall may be less efficient than the best of these."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("scenes", nargs="*", type=Path, metavar="SCENE", help="default: the lamp boxes and all of scenes/efficiency")
    command.add_argument("--quick", action="store_true", help="3 seeds, short renders, and of our own only pt: ten minutes, into target/")
    command.add_argument("--ours", metavar="OPTIONS", default=BDPT, help='the options of `tyndall render` to judge (default "%(default)s")')
    names = ", ".join((*OWN, *INTEGRATORS, *MITSUBA))
    command.add_argument("--against", metavar="LIST", help=f"the others, separated by commas: any of {names} (default: all but the variants of Mitsuba's)")
    command.add_argument("--contender", metavar="NAME: OPTIONS", action="append", default=[], help="another one, by options of `tyndall render`")
    command.add_argument("--points", type=int, default=1, help="budgets, each twice the one before: curves of error against time (default %(default)s)")
    command.add_argument("--seeds", type=int, help="independent renders of each contender (default 10, quick 3)")
    command.add_argument("--seconds", type=float, help="of each contender's longest render (default 0.75, quick 0.4)")
    command.add_argument("--reference-seconds", type=float, help="of each reference that is not there yet (default 30, quick 6)")
    command.add_argument("--reference", metavar="FILE", type=Path, action="append", default=[], help="image (.exr, .pfm) in its place, one a scene")
    command.add_argument("--size", metavar="WxH", help="of all images (default: 96x96; with other scenes or -D, the scenes' own)")
    command.add_argument("--threads", type=int, default=2, help="of all contenders alike (default %(default)s)")
    command.add_argument("-D", metavar="NAME=VALUE", action="append", default=[], help="a parameter of the scenes")
    command.add_argument("--resume", action="store_true", help="continue an interrupted measurement")
    command.add_argument("--output", type=Path, help="folder for the study, whose page has the curves, and for efficiency.md and .json (default: target/validation/efficiency and, if all is measured, validation/reports)")  # fmt: skip
    command.add_argument("--grids", action="store_true", help="only write the grids that the scenes name")


def run(options: argparse.Namespace) -> bool:
    """Measures, writes and judges the table."""
    scenes, effort = options.scenes or list(WANTED), effort_of(options)
    if options.grids or FOLDER in (scene.resolve().parent for scene in scenes):
        volumes.write()
    if options.grids:
        return True
    folder = options.output or OUTPUT / ("efficiency-quick" if options.quick else "efficiency")
    given = [Reference(file) for file in options.reference]
    study = studies.measured(scenes, contenders(options), effort, folder, given, restart=not options.resume and not options.output)
    is_whole = not (options.quick or options.scenes or options.output or options.against)
    return told(study, [folder, *([REPORTS] if is_whole else [])])


def effort_of(options: argparse.Namespace) -> Effort:
    """What was asked for, or else its default."""
    seeds, seconds, reference = (3, 0.4, 6) if options.quick else (10, 0.75, 30)
    size = "96x96" if {scene.resolve() for scene in options.scenes} <= WANTED.keys() and not options.D else None
    return Effort(options.seeds or seeds, options.seconds or seconds, options.reference_seconds or reference, options.size or size,
                  options.threads, options.points, tuple(options.D))  # fmt: skip


def contenders(options: argparse.Namespace) -> dict[str, str]:
    """Their names and options, ours first."""
    usual = ("pt", *INTEGRATORS) if options.quick else (*OWN, *INTEGRATORS)
    names = options.against.split(",") if options.against is not None else usual
    known = {**OWN, **dict.fromkeys((*INTEGRATORS, *MITSUBA), "")}
    wrong = next((name for name in names if name and name not in known), None)
    if wrong:
        raise Failure(f"--against {wrong}: no such contender", f"choose among {', '.join(known)}")
    unnamed = next((text for text in options.contender if ": " not in text), None)
    if unnamed:
        raise Failure(f'--contender "{unnamed}": no name', 'write --contender "joins: --integrator bdpt --strategies hit,join"')
    more = dict(text.split(": ", 1) for text in options.contender)
    return {OURS: options.ours, **{name: known[name] for name in names if name}, **more}


def told(study: Study, folders: Sequence[Path]) -> bool:
    """Prints and writes the table; true if nobody is surely better."""
    rows = [row_of(scene) for scene in study.scenes]
    text = page(rows, study.told, made_by_command())
    for folder in folders:
        write_text(folder / "efficiency.json", json.dumps([asdict(row) for row in rows], indent=1) + "\n")
        write_text(folder / "efficiency.md", text)
    print(text)
    return not any(row.is_beaten or row.is_outdone for row in rows)


@dataclass(frozen=True)
class Row:
    """What was found in a scene; products of relMSE and seconds, and how many times as efficient as others Tyndall is."""

    scene: str
    wanted: float | None
    ours: float
    theirs: tuple[str, Ratio] | None
    """The better of Mitsuba's, where it can render the scene."""
    of_sample: tuple[float, float] | None
    """relMSE and seconds of a sample, Mitsuba's over ours."""
    own: dict[str, Ratio]
    reference: float
    """The reference's relMSE over that of our renders."""
    notes: list[str]

    @property
    def best(self) -> tuple[str, Ratio] | None:
        """The most efficient of our others."""
        return least(self.own)

    @property
    def is_beaten(self) -> bool:
        """Mitsuba is surely more efficient."""
        return self.theirs is not None and self.theirs[1].high < 1

    @property
    def is_outdone(self) -> bool:
        """Another of ours surely is, by more than it may be."""
        return self.best is not None and self.best[1].high < 1 - WORSE


def least(ratios: dict[str, Ratio]) -> tuple[str, Ratio] | None:
    """The one over whom Tyndall's lead is least."""
    return min(ratios.items(), key=lambda one: one[1].mean, default=None)


def row_of(scene: Found) -> Row:
    """Of what a study found in a scene."""
    if OURS not in scene.costs:
        raise Failure(f"{scene.name}: Tyndall could not render it: {'; '.join(scene.notes)}", "measure without this scene")
    ratios = {name: scene.ratio(name) for name in scene.costs if name != OURS}
    theirs = least({name: ratio for name, ratio in ratios.items() if name.startswith("mitsuba ")})
    wanted = next((wanted for path, wanted in WANTED.items() if path.stem == scene.name), None)
    samples = {one["name"]: per_sample(one) for one in scene.told["contenders"]}
    (error, seconds), (other_error, other_seconds) = samples[OURS], samples[theirs[0] if theirs else OURS]
    of_sample = (other_error / error, other_seconds / seconds) if theirs else None
    own = {name: ratio for name, ratio in ratios.items() if not name.startswith("mitsuba ")}
    share = scene.noise / scene.told["contenders"][0]["points"][-1]["relmse"]["mean"]
    return Row(scene.name, wanted, scene.cost(), theirs, of_sample, own, share, scene.notes)


def per_sample(contender: dict[str, Any]) -> tuple[float, float]:
    """relMSE and seconds of a sample of each pixel."""
    last = contender["points"][-1]
    return last["relmse"]["mean"] * last["samples"], last["seconds"]["mean"] / last["samples"]


def page(rows: list[Row], study: dict[str, Any], command: str) -> str:
    """The table and what follows from it, in Markdown."""
    ratios = [row.theirs[1] for row in rows if row.theirs]
    below = ", ".join(row.scene for row in rows if row.theirs and row.theirs[1].mean < 1) or "none"
    outdone = ", ".join(f"{row.scene} ({row.best[0]})" for row in rows if row.best and row.best[1].mean < 1 - WORSE) or "none"
    wanted = f"; wanted: {WANTED_MEAN}" if all(row.wanted for row in rows) else ""
    size = study["scenes"][0]
    return "\n".join([
        "# Time to equal error", "",
        f"relMSE x seconds, {size['width']} x {size['height']}; {study['made_by']}, Mitsuba 3.9.1; {study['machine']}",
        "for each contender, which took turns; pilots and learning are among the seconds; intervals hold 95 %.", "", f"    {command}", "",
        "| scene | Tyndall | Mitsuba, the better | ratio | of a sample: error, time | wanted | over pt | over the best of our others | reference |",
        "|---|---|---|---|---|---|---|---|---|",
        *map(table_line, rows), "",
        *([f"- Geometric mean of {len(ratios)} ratios: {Ratio.geometric(ratios)}{wanted}."] if ratios else []),
        f"- Scenes below 1: {below}.",
        f"- Scenes where another choice of strategies is more than {100 * WORSE:g} % more efficient: {outdone}.",
        "- of a sample: the relMSE and the seconds of a sample of each pixel, Mitsuba's over ours; their product is about the ratio.",
        "- reference: its own relMSE over that of Tyndall's renders; it is subtracted from all.",
        *(f"- {row.scene}: {note}" for row in rows for note in row.notes), "",
    ])  # fmt: skip


def table_line(row: Row) -> str:
    """A row in Markdown."""
    theirs = f"{row.ours * row.theirs[1].mean:.3g} ({row.theirs[0].split()[1]}) | {row.theirs[1]}" if row.theirs else "none | "
    of_sample = f"{row.of_sample[0]:.3g}, {row.of_sample[1]:.2g}" if row.of_sample else ""
    wanted = "" if row.wanted is None else f"{row.wanted:g}"
    over = f"; wanted: {WANTED_OVER_PT[row.scene]}" if row.scene in WANTED_OVER_PT else ""
    best = "{} {}".format(*row.best) if row.best else ""
    return (f"| {row.scene} | {row.ours:.3g} | {theirs} | {of_sample} | {wanted} | {row.own.get('pt', '')}{over} |"
            f" {best} | {100 * row.reference:.2g} % |")  # fmt: skip
