"""Time to equal error, relMSE x seconds, as one number a scene: how many times as efficient Tyndall is as the better of Mitsuba's
`volpath` and `volpathmis`, beside its own `pt`, `lt` and subsets of strategies. By default on `scenes/efficiency/` and the lamp
boxes; the references are long renders that are kept."""

import argparse
import math
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from tyndall.failure import Failure
from validation import guide, models, studies, volumes
from validation.contender import GPU, INTEGRATORS
from validation.files import write_report
from validation.places import EFFICIENCY, OUTPUT, REPORTS, SCENES
from tyndall.statistics import Ratio
from validation.studies import BDPT, MITSUBA, OURS, Effort, Found, Reference

WANTED = {
    SCENES / "lampbox_down.xml": 15,
    SCENES / "lampbox_up.xml": 200,
    EFFICIENCY / "fog_room.xml": 15,
    EFFICIENCY / "dusty_window.xml": 15,
    EFFICIENCY / "skylight.xml": 1,
    EFFICIENCY / "headlights.xml": 80,
    EFFICIENCY / "glass_fog_sky.xml": 4,
    EFFICIENCY / "plume.xml": 3,
    EFFICIENCY / "cloud.xml": 3,
    EFFICIENCY / "nested_media.xml": 3,
    EFFICIENCY / "frosted_pane.xml": 1,
    EFFICIENCY / "small_opening.xml": 1,
    EFFICIENCY / "door_ajar.xml": 1,
    EFFICIENCY / "keyhole.xml": 1,
    EFFICIENCY / "chapel_sun.xml": 1,
    EFFICIENCY / "candles.xml": 1,
    EFFICIENCY / "chromatic_fog.xml": 1,
    EFFICIENCY / "screen.xml": 1,
    EFFICIENCY / "pool.xml": 1,
    EFFICIENCY / "smoky_room.xml": 1,
}
"""How many times as efficient as Mitsuba Tyndall shall be in each scene."""
WANTED_OVER = {"pt": {"frosted_pane": 100.0, "small_opening": 100.0, "door_ajar": 100.0, "church": 100.0}, "no guide": guide.WANTED}
"""How many times as efficient as others of its own."""
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


@dataclass(frozen=True)
class Suite:
    """Scenes, who is compared in them by default, and how much is rendered."""

    scenes: Callable[[], list[Path]]
    others: dict[str, str]
    """Of our own."""
    effort: Effort
    theirs: tuple[str, ...] = INTEGRATORS
    ours: str = BDPT
    """What is judged, and what references are made by."""


SUITES = {
    "efficiency": Suite(lambda: list(WANTED), OWN, Effort(10, 0.75, 30, "96x96")),
    "guide": Suite(guide.scenes, guide.OTHERS, Effort(10, 10, 100, "96x72"), ()),
    "models": Suite(models.scenes, {}, Effort(4, 0.5, 10), INTEGRATORS[:1], OWN["pt"]),
}


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    known = ", ".join((*OWN, *INTEGRATORS, *MITSUBA))
    command.add_argument("scenes", nargs="*", type=Path, metavar="SCENE", help="default: those of the suite")
    command.add_argument("--suite", choices=SUITES, default="efficiency", help="scenes, contenders and effort where none are given: scenes/efficiency and the lamp boxes; scenes where a guide may help; a scene for each model, by path tracing alone (default %(default)s)")  # fmt: skip
    command.add_argument("--only", metavar="TEXT", default="", help="scenes whose names contain this")
    command.add_argument("--quick", action="store_true", help="3 seeds, short renders, and of our own only pt: ten minutes")
    command.add_argument("--ours", metavar="OPTIONS", help='the options of `tyndall render` to judge (default "--integrator bdpt", of models pt)')
    command.add_argument("--against", metavar="LIST", help=f"the others, separated by commas: any of the suite's ({known}; default: all but the variants of Mitsuba's)")
    command.add_argument("--variant", metavar="NAME", help=f"compare with Mitsuba's integrators in this variant too; {GPU} needs a GPU and has a column of its own")
    command.add_argument("--contender", metavar="NAME: OPTIONS", action="append", default=[], help="another one, by options of `tyndall render`")
    command.add_argument("--points", type=int, default=1, help="budgets, each twice the one before: curves of error against time (default %(default)s)")
    command.add_argument("--seeds", type=int, help="independent renders of each contender, at least 2 (default 10; of models 4, quick 3)")
    command.add_argument("--seconds", type=float, help="of each contender's longest render (default 0.75; guide 10, models 0.5, quick 0.4)")
    command.add_argument("--reference-seconds", type=float, help="of each reference that is not there yet (default 30; guide 100, models 10, quick 6)")
    command.add_argument("--reference", metavar="FILE", type=Path, action="append", default=[], help="image (.exr, .pfm) in its place, one a scene")
    command.add_argument("--size", metavar="WxH", help="of all images (default 96x96, guide 96x72; of other scenes or with -D, their own)")
    command.add_argument("--threads", type=int, default=2, help="of all contenders alike (default %(default)s)")
    command.add_argument("-D", metavar="NAME=VALUE", action="append", default=[], help="a parameter of the scenes")
    command.add_argument("--resume", action="store_true", help="continue an interrupted measurement")
    command.add_argument("--output", type=Path, help="folder for the study, whose page has the curves, and for its table as .md and .json (default: target/validation/SUITE and, if all is measured, validation/reports)")  # fmt: skip
    command.add_argument("--grids", action="store_true", help="only write the grids that the scenes name")


def run(options: argparse.Namespace) -> bool:
    """Measures, writes and judges the table, the least lead first; true if nobody is surely better."""
    suite = SUITES[options.suite]
    if options.grids or not options.scenes or EFFICIENCY in (scene.resolve().parent for scene in options.scenes):
        volumes.write()
    if options.grids:
        return True
    scenes = [scene for scene in options.scenes or suite.scenes() if options.only in scene.stem]
    if not scenes:
        raise Failure(f"--only {options.only}: no scene has this in its name", "name another part of one")
    folder = options.output or OUTPUT / (options.suite + ("-quick" if options.quick else ""))
    given, restart = [Reference(file) for file in options.reference], not options.resume and not options.output
    study = studies.measured(scenes, contenders(suite, options), effort_of(suite, options), folder, given, suite.ours, restart)
    is_whole = not (options.quick or options.scenes or options.only or options.output or options.against)
    rows = sorted(map(row_of, study.scenes), key=lambda row: min((ratio.mean for ratio in row.leads), default=0))
    write_report(options.suite, "Time to equal error", page(rows, study.told), [asdict(row) for row in rows], folder, *([REPORTS] if is_whole else []))
    return not any(row.is_beaten or row.is_outdone for row in rows)


def effort_of(suite: Suite, options: argparse.Namespace) -> Effort:
    """What was asked for, or else its default."""
    usual = replace(suite.effort, seeds=3, seconds=0.4, reference_seconds=6) if options.quick else suite.effort
    size = suite.effort.size if {scene.resolve() for scene in options.scenes} <= WANTED.keys() and not options.D else None
    return Effort(options.seeds or usual.seeds, options.seconds or usual.seconds, options.reference_seconds or usual.reference_seconds,
                  options.size or size, options.threads, options.points, tuple(options.D))  # fmt: skip


def contenders(suite: Suite, options: argparse.Namespace) -> dict[str, str]:
    """Their names and options, ours first."""
    usual = [name for name in (*suite.others, *suite.theirs) if not options.quick or name in ("pt", *suite.theirs)]
    names = options.against.split(",") if options.against is not None else usual
    names += [f"{kind}:{options.variant}" for kind in INTEGRATORS if options.variant]
    known = {**OWN, **suite.others, **dict.fromkeys((*INTEGRATORS, *MITSUBA), "")}
    wrong = next((name for name in names if name and name not in known), None)
    if wrong:
        raise Failure(f"--against {wrong}: no such contender", f"choose among {', '.join(known)}")
    unnamed = next((text for text in options.contender if ": " not in text), None)
    if unnamed:
        raise Failure(f'--contender "{unnamed}": no name', 'write --contender "joins: --integrator bdpt --strategies hit,join"')
    more = dict(text.split(": ", 1) for text in options.contender)
    return {OURS: options.ours or suite.ours, **{name: known[name] for name in names if name}, **more}


@dataclass(frozen=True)
class Row:
    """What was found in a scene; products of relMSE and seconds, and how many times as efficient as others Tyndall is."""

    scene: str
    wanted: float | None
    ours: float
    theirs: tuple[str, Ratio] | None
    """The better of Mitsuba's on processors, where it can render the scene."""
    gpu: Ratio | None
    """Likewise on a GPU."""
    of_sample: tuple[float, float] | None
    """relMSE and seconds of a sample, Mitsuba's over ours."""
    own: dict[str, Ratio]
    reference: float
    """The reference's relMSE over that of our renders."""
    notes: list[str]

    @property
    def leads(self) -> list[Ratio]:
        """Over Mitsuba, or else over our others."""
        return [self.theirs[1]] if self.theirs else list(self.own.values())

    @property
    def is_beaten(self) -> bool:
        """Mitsuba is surely more efficient."""
        return self.theirs is not None and self.theirs[1].high < 1

    @property
    def is_outdone(self) -> bool:
        """Another of ours surely is, by more than it may be."""
        return any(ratio.high < 1 - WORSE for ratio in self.own.values())


def row_of(scene: Found) -> Row:
    """Of what a study found in a scene."""
    if OURS not in scene.costs:
        raise Failure(f"{scene.name}: Tyndall could not render it: {'; '.join(scene.notes)}", "measure without this scene")
    ratios = {name: scene.ratio(name) for name in scene.costs if name != OURS}
    mitsuba = [(name, ratio) for name, ratio in ratios.items() if name.startswith("mitsuba ")]
    theirs = min((one for one in mitsuba if GPU not in one[0]), key=lambda one: one[1].mean, default=None)
    gpu = min((ratio for name, ratio in mitsuba if GPU in name), key=lambda ratio: ratio.mean, default=None)
    wanted = next((wanted for path, wanted in WANTED.items() if theirs and path.stem == scene.name), None)
    samples = {one["name"]: per_sample(one) for one in scene.told["contenders"]}
    (error, seconds), (other_error, other_seconds) = samples[OURS], samples[theirs[0] if theirs else OURS]
    of_sample = (other_error / error, other_seconds / seconds) if theirs else None
    own = {name: ratio for name, ratio in ratios.items() if not name.startswith("mitsuba ")}
    share = scene.noise * scene.told["contenders"][0]["points"][-1]["samples"] / error
    return Row(scene.name, wanted, scene.cost(), theirs, gpu, of_sample, own, share, scene.notes)


def per_sample(contender: dict[str, Any]) -> tuple[float, float]:
    """relMSE and seconds of a sample of each pixel; NaN where an image holds it."""
    last = contender["points"][-1]
    relmse = last["relmse"]["mean"]
    return math.nan if relmse is None else relmse * last["samples"], last["seconds"]["mean"] / last["samples"]


def page(rows: list[Row], study: dict[str, Any]) -> str:
    """The table and what follows from it, in Markdown."""
    ratios = [row.theirs[1] for row in rows if row.theirs]
    below = ", ".join(row.scene for row in rows if row.theirs and row.theirs[1].mean < 1) or "none"
    outdone = ", ".join(f"{row.scene} ({name})" for row in rows for name, ratio in row.own.items() if ratio.mean < 1 - WORSE) or "none"
    others = list(dict.fromkeys(name for row in rows for name in row.own))
    wanted = f"; wanted: {WANTED_MEAN}" if {row.scene for row in rows} == {path.stem for path in WANTED} else ""
    size, gpus = study["scenes"][0], [row.gpu for row in rows if row.gpu]
    on = f" and {gpu_name()}" if gpus else ""
    return "\n".join([
        f"relMSE x seconds, {size['width']} x {size['height']}; {study['made_by']}, Mitsuba 3.9.1; {study['machine']}{on}",
        "for each contender, which took turns; pilots and learning are among the seconds; intervals hold 95 %.", "",
        f"| scene | Tyndall | Mitsuba, the better | ratio | of a sample: error, time | wanted |{' over a GPU |' if gpus else ''}{''.join(f' over {name} |' for name in others)} reference |",
        "|---" * (7 + len(others) + bool(gpus)) + "|",
        *(table_line(row, others, bool(gpus)) for row in rows), "",
        *([f"- Geometric mean of {len(ratios)} ratios: {Ratio.geometric(ratios)}{wanted}."] if ratios else []),
        *([f"- Over the GPU: {Ratio.geometric(gpus)}, above 1 in {sum(ratio.mean > 1 for ratio in gpus)} of {len(gpus)}."] if gpus else []),
        f"- Scenes below 1: {below}.",
        f"- Scenes where another of ours is more than {100 * WORSE:g} % more efficient: {outdone}.",
        "- of a sample: the relMSE and the seconds of a sample of each pixel, Mitsuba's over ours; their product is about the ratio.",
        "- reference: its own relMSE over that of Tyndall's renders; it is subtracted from all.",
        *(f"- {row.scene}: {note}" for row in rows for note in row.notes), "",
    ])  # fmt: skip


def gpu_name() -> str:
    """As its driver calls it."""
    return subprocess.run(["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"], capture_output=True, text=True).stdout.strip()


def table_line(row: Row, others: Sequence[str], has_gpu: bool = False) -> str:
    """A row in Markdown."""
    theirs = f"{row.ours * row.theirs[1].mean:.3g} ({row.theirs[0].removeprefix('mitsuba ')}) | {row.theirs[1]}" if row.theirs else "none | "
    of_sample = f"{row.of_sample[0]:.3g}, {row.of_sample[1]:.2g}" if row.of_sample else ""
    wanted = "" if row.wanted is None else f"{row.wanted:g}"
    over = " | ".join(f"{row.own.get(name, '')}{aim(name, row.scene)}" for name in others)
    return f"| {row.scene} | {row.ours:.3g} | {theirs} | {of_sample} | {wanted} | {f'{row.gpu} | ' if has_gpu else ''}{f'{over} | ' if others else ''}{100 * row.reference:.2g} % |"


def aim(other: str, scene: str) -> str:
    """What was wanted there."""
    wanted = WANTED_OVER.get(other, {}).get(scene)
    return "" if wanted is None else f"; wanted: {wanted:g}"
