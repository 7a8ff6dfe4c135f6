"""Time to equal error, relMSE x seconds, on the scenes of `scenes/efficiency/` and the lamp boxes: against the better of
Mitsuba's `volpath` and `volpathmis`, and against Tyndall's own `pt`, `lt` and subsets of strategies. All contenders take turns
in one `tyndall study`; the references are long renders that are kept."""

import argparse
import json
import math
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from tyndall.failure import Failure
from tyndall.volume_file import vol
from validation import studies
from validation.made_by import made_by_command
from validation.places import OUTPUT, REPORTS, SCENES

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
WANTED_OVER_PT = {"frosted_pane": 100, "small_opening": 100, "door_ajar": 100}
"""How many times as efficient as its own `pt` where light hardly finds the way in."""
WANTED_MEAN = 12
"""The geometric mean of all."""
MITSUBA = ("volpath:llvm_ad_rgb", "volpathmis:llvm_ad_rgb")
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
    command.add_argument("--ours", metavar="OPTIONS", default="--integrator bdpt", help='the options of `tyndall render` to judge (default "%(default)s")')
    command.add_argument("--seeds", type=int, help="independent renders of each contender (default 10, quick 3)")
    command.add_argument("--seconds", type=float, help="of each render (default 0.75, quick 0.4)")
    command.add_argument("--reference-seconds", type=float, help="of each reference that is not there yet (default 30, quick 6)")
    command.add_argument("--size", help="of all images (default 96x96)")
    command.add_argument("--threads", type=int, default=2, help="of all contenders alike (default %(default)s)")
    command.add_argument("--resume", action="store_true", help="continue an interrupted measurement")
    command.add_argument("--output", type=Path, help="folder for efficiency.md and .json (default: validation/reports if all is measured, else target/)")
    command.add_argument("--grids", action="store_true", help="only write the grids that the scenes name")


def run(options: argparse.Namespace) -> bool:
    """Measures, writes and judges the table."""
    volumes()
    if options.grids:
        return True
    effort = Effort.of(options)
    scenes = options.scenes or list(WANTED)
    folder = OUTPUT / ("efficiency-quick" if options.quick else "efficiency")
    references = [reference(scene, effort) for scene in scenes]
    own = {"pt": OWN["pt"]} if options.quick else OWN
    if not studies.run(line(scenes, {"tyndall": options.ours, **own}, effort, references, folder, options.resume)):
        return False
    study = json.loads((folder / "study.json").read_text())
    rows = [row_of(scene) for scene in study["scenes"]]
    output = options.output or (folder if options.quick or options.scenes else REPORTS)
    output.mkdir(parents=True, exist_ok=True)
    (output / "efficiency.json").write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n")
    text = page(rows, study, made_by_command())
    (output / "efficiency.md").write_text(text)
    print(text)
    return not any(row.is_beaten or row.is_outdone for row in rows)


@dataclass(frozen=True)
class Effort:
    """How much is rendered."""

    seeds: int
    seconds: float
    reference_seconds: float
    size: str
    threads: int

    @staticmethod
    def of(options: argparse.Namespace) -> "Effort":
        """What was asked for, or else its default."""
        usual = Effort(3, 0.4, 6, "96x96", 2) if options.quick else Effort(10, 0.75, 30, "96x96", 2)
        return Effort(*(getattr(options, name) or getattr(usual, name) for name in asdict(usual)))


def line(scenes: list[Path], own: dict[str, str], effort: Effort, references: list["Reference"], folder: Path, resume: bool) -> list[str]:
    """The study's command line; ours come first: the others are compared with the first of all."""
    ours = [word for name, words in own.items() for word in ("--contender", f"{name}: {words}")]
    given = {"seconds": effort.seconds, "seeds": effort.seeds, "doublings": 1, "threads": effort.threads, "size": effort.size, "restart": not resume}
    known = [word for one in references for word in ("--reference", str(one.image), "--reference-error", f"{one.relmse:.6g}")]
    return studies.words(scenes, list(MITSUBA), given, [*ours, *known, "-o", os.path.relpath(folder)])


@dataclass(frozen=True)
class Reference:
    """A scene's long render by all strategies, and its own relMSE."""

    image: Path
    relmse: float


def reference(scene: Path, effort: Effort) -> Reference:
    """A reference is made once, by a study of its own: it is made again when the scene changes or more time is given."""
    folder = OUTPUT / "efficiency-references" / f"{scene.stem}-{effort.size}-{effort.reference_seconds:g}s"
    given = {"quiet": True, "spp": 1, "seeds": 2, "doublings": 1, "size": effort.size, "threads": effort.threads,
             "reference_by": "--integrator bdpt", "reference_seconds": effort.reference_seconds}  # fmt: skip
    if not studies.run(studies.words([scene], ["bdpt"], given, ["-o", os.path.relpath(folder)])):
        raise Failure(f"{scene}: no reference could be made", f"see the message above; if the scene is another one now, remove {folder}")
    [found] = json.loads((folder / "study.json").read_text())["scenes"]
    return Reference(folder / found["reference"]["image"], found["reference"]["own_relmse"])


@dataclass(frozen=True)
class Ratio:
    """How many times as efficient as another contender Tyndall is, and the ends of the interval."""

    other: str
    low: float
    mean: float
    high: float

    def __str__(self) -> str:
        return f"{self.mean:.3g} [{self.low:.3g}, {self.high:.3g}]"


@dataclass(frozen=True)
class Row:
    """What was found in a scene; products of relMSE and seconds."""

    scene: str
    wanted: float | None
    ours: float
    theirs: float
    mitsuba: Ratio
    of_sample: tuple[float, float]
    """relMSE and seconds of a sample, Mitsuba's over ours."""
    own: dict[str, Ratio]
    reference: float
    """The reference's relMSE over that of our renders."""
    notes: list[str]

    @property
    def best(self) -> Ratio:
        """Over the most efficient of our others."""
        return min(self.own.values(), key=lambda ratio: ratio.mean)

    @property
    def is_beaten(self) -> bool:
        """Mitsuba is surely more efficient."""
        return self.mitsuba.high < 1

    @property
    def is_outdone(self) -> bool:
        """Another of ours surely is, by more than it may be."""
        return self.best.high < 1 - WORSE


def row_of(scene: dict[str, Any]) -> Row:
    """A scene's part of study.json."""
    ours, *others = scene["contenders"]
    ratios = {other["name"]: Ratio(other["name"], *(1 / other["ratio"][end] for end in ("high", "mean", "low"))) for other in others}
    theirs = [ratio for name, ratio in ratios.items() if name.startswith("mitsuba ")]
    if not theirs:
        raise Failure(f"{scene['name']}: Mitsuba could not render it: {'; '.join(scene.get('notes', []))}", "measure without this scene")
    mitsuba = min(theirs, key=lambda ratio: ratio.mean)
    wanted = next((wanted for path, wanted in WANTED.items() if path.stem == scene["name"]), None)
    share = scene["reference"]["own_relmse"] / ours["points"][-1]["relmse"]["mean"]
    notes = [f"{one['name']}: {note}" for one in scene["contenders"] for note in one.get("notes", []) if "mean differs" in note]
    own = {name: ratio for name, ratio in ratios.items() if name in OWN}
    cost = 1 / ours["efficiency"]["mean"]
    [best] = [other for other in others if other["name"] == mitsuba.other]
    of_sample = cast(tuple[float, float], tuple(np.divide(per_sample(best), per_sample(ours)).tolist()))
    return Row(scene["name"], wanted, cost, cost * mitsuba.mean, mitsuba, of_sample, own, share, [*scene.get("notes", []), *notes])


def per_sample(contender: dict[str, Any]) -> tuple[float, float]:
    """relMSE and seconds of a sample of each pixel."""
    last = contender["points"][-1]
    return last["relmse"]["mean"] * last["samples"], last["seconds"]["mean"] / last["samples"]


def mean(ratios: list[Ratio]) -> Ratio:
    """The geometric mean."""
    middle = sum(math.log(ratio.mean) for ratio in ratios) / len(ratios)
    off = math.sqrt(sum(math.log(ratio.high / ratio.low) ** 2 for ratio in ratios)) / 2 / len(ratios)
    return Ratio("", *(math.exp(middle + sign * off) for sign in (-1, 0, 1)))


def page(rows: list[Row], study: dict[str, Any], command: str) -> str:
    """The table and what follows from it, in Markdown."""
    whole = mean([row.mitsuba for row in rows])
    below = ", ".join(row.scene for row in rows if row.mitsuba.mean < 1) or "none"
    outdone = ", ".join(f"{row.scene} ({row.best.other})" for row in rows if row.best.mean < 1 - WORSE) or "none"
    size = study["scenes"][0]
    return "\n".join([
        "# Time to equal error", "",
        f"relMSE x seconds, {size['width']} x {size['height']}; {study['made_by']}, Mitsuba 3.9.1 llvm_ad_rgb; {study['machine']}",
        f"for each contender, which took turns; intervals hold {100 * study['confidence']:g} %.", "", f"    {command}", "",
        "| scene | Tyndall | Mitsuba, the better | ratio | of a sample: error, time | wanted | over pt | over the best of our others | reference |",
        "|---|---|---|---|---|---|---|---|---|",
        *map(table_line, rows), "",
        f"- Geometric mean of {len(rows)} ratios: {whole}; wanted: {WANTED_MEAN}.",
        f"- Scenes below 1: {below}.",
        f"- Scenes where another choice of strategies is more than {100 * WORSE:g} % more efficient: {outdone}.",
        "- of a sample: the relMSE and the seconds of a sample of each pixel, Mitsuba's over ours; their product is about the ratio.",
        "- reference: its own relMSE over that of Tyndall's renders, of which it is a part: the ratio is too small by about so much.",
        *(f"- {row.scene}: {note}" for row in rows for note in row.notes), "",
    ])  # fmt: skip


def table_line(row: Row) -> str:
    """A row in Markdown."""
    kind = row.mitsuba.other.split()[1]
    error, seconds = row.of_sample
    wanted = "" if row.wanted is None else f"{row.wanted:g}"
    over = f"; wanted: {WANTED_OVER_PT[row.scene]}" if row.scene in WANTED_OVER_PT else ""
    return (f"| {row.scene} | {row.ours:.3g} | {row.theirs:.3g} ({kind}) | {row.mitsuba} | {error:.3g}, {seconds:.2g} | {wanted} | {row.own.get('pt', '')}{over} |"
            f" {row.best.other} {row.best} | {100 * row.reference:.2g} % |")  # fmt: skip


def volumes() -> None:
    """Writes the grids that the scenes name, too large for the repository."""
    folder = FOLDER / "assets"
    folder.mkdir(exist_ok=True)
    from validation import plume  # it needs Mitsuba

    for name, samples in (("plume", plume.smoke), ("cloud", cloud)):
        path = folder / f"{name}.vol"
        if not path.is_file():
            partial = path.with_suffix(".partial")
            partial.write_bytes(vol(samples(VOXELS)))
            partial.replace(path)


VOXELS = 256


def cloud(voxels: int) -> np.ndarray:
    """Billows over a flat base, (z, y, x), from 0 to 1; what is around them is empty."""
    at = (np.arange(voxels, dtype=np.float32) + 0.5) / voxels
    z, y, x = np.meshgrid(at, at, at, indexing="ij", sparse=True)
    random = np.random.default_rng(6)
    body = np.full((voxels,) * 3, -1, np.float32)
    for radius in (0.27, 0.22, 0.2, 0.18, 0.16, 0.15, 0.13, 0.12):
        centre = random.uniform((0.3, 0.22, 0.3), (0.7, 0.75 - radius, 0.7))
        distance = np.sqrt((z - centre[0]) ** 2 + (y - centre[1]) ** 2 + (x - centre[2]) ** 2)
        body = np.maximum(body, 1 - distance / radius)
    from validation import plume

    billows = body + 0.9 * (plume.turbulence(voxels, 11) - 0.45)
    return (np.clip(4 * billows, 0, 1) * np.clip(20 * (y - 0.12), 0, 1)).astype(np.float32)
