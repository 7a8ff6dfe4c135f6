"""P03T's tests A-F (sec. 5.2.1) as P03T made them: a path tracer without next-event estimation renders until every pixel is within an
error, with a guide and without, the time of learning included."""

import argparse
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyndall.rendering import Rendering
from tyndall.rendering import run as render
from tyndall.scene import Scene
from validation import guide
from validation.files import write_report
from validation.places import REPORTS
from tyndall.statistics import Ratio

WANTED = 2.0
"""How many times as long it shall take without a guide."""


@dataclass(frozen=True)
class Published:
    """P03T's results of a test at a threshold: paths per pixel by classical and by informed path tracing, and the ratio of their times,
    first pass not counted (figures 5.4 to 5.8)."""

    classical: float
    informed: float
    times: float


PUBLISHED = {
    ("A", 100): Published(240944 / 25**2, 95008 / 25**2, 2.02),
    ("A", 50): Published(968064 / 25**2, 458160 / 25**2, 1.60),
    ("B", 100): Published(351616 / 25**2, 130448 / 25**2, 2.36),
    ("B", 50): Published(1474720 / 25**2, 692672 / 25**2, 1.68),
    ("C", 100): Published(5100656 / 100**2, 2165792 / 100**2, 1.88),
    ("C", 50): Published(23504512 / 100**2, 12962384 / 100**2, 1.43),
    ("D", 100): Published(5570720 / 100**2, 1491040 / 100**2, 2.22),
    ("D", 50): Published(22553536 / 100**2, 8297216 / 100**2, 1.69),
    ("E", 100): Published(6747392 / 100**2, 1891984 / 100**2, 2.38),
    ("E", 50): Published(29119872 / 100**2, 10709424 / 100**2, 2.07),
    ("F", 100): Published(4314064 / 100**2, 1613184 / 100**2, 2.0),
    ("F", 50): Published(18095312 / 100**2, 9640272 / 100**2, 1.41),
}
"""By test and threshold [percent]; of F, the informed tracer that samples by incident light."""
PATHS: dict[str, Any] = {"integrator": "pt", "strategies": "hit"}
"""A path tracer without next-event estimation."""
WAYS: dict[str, dict[str, Any]] = {"plain": {"guide": "never"}, "guided": {"guide": "always"}}


@dataclass(frozen=True)
class Row:
    """What was found in a box at a threshold."""

    name: str
    threshold: int
    samples: dict[str, float]
    """Per pixel, on average, by the names of WAYS."""
    seconds: dict[str, float]
    """Likewise."""
    gain: Ratio

    @property
    def published(self) -> Published:
        return PUBLISHED[self.name[0], self.threshold]


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--seeds", type=int, default=3, help="renders of each kind, at least 2 (default %(default)s)")
    command.add_argument("--size", default="100x100", help="of all images (default %(default)s, as in P03T)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for thresholds.md (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures and writes the table; true if a guide gives what it shall everywhere."""
    rows = [row_of(case, threshold, options) for case in guide.CASES["P03T's boxes"] for threshold in (100, 50)]
    write_report("thresholds", "P03T's tests A-F at its own thresholds", page(rows, options), None, options.output)
    return all(row.gain.mean >= WANTED for row in rows)


def row_of(case: guide.Case, threshold: int, options: argparse.Namespace) -> Row:
    """Renders a box to a threshold [percent], with a guide and without, in turn."""
    scene = Scene(case.scene, case.name, case.parameters)
    given: dict[str, Any] = {**PATHS, "error": threshold / 100, "size": options.size, "threads": options.threads}
    made: dict[str, list[Rendering]] = {name: [] for name in WAYS}
    for seed in range(options.seeds):
        for name, way in WAYS.items():
            made[name].append(render(scene, seed=seed, **way, **given))
    seconds = {name: [one.report["load_seconds"] + one.report["render_seconds"] for one in renders] for name, renders in made.items()}
    samples = {name: statistics.mean(one.report["samples_per_pixel"] for one in renders) for name, renders in made.items()}
    means = {name: statistics.mean(each) for name, each in seconds.items()}
    row = Row(case.name, threshold, samples, means, Ratio.of(seconds["plain"], seconds["guided"]))
    print(line(row), end="", flush=True)
    return row


def page(rows: list[Row], options: argparse.Namespace) -> str:
    """The report."""
    return (
        "P03T (sec. 5.2.1) renders until each pixel is within a threshold (eprt) with 95 % confidence, by its own samples (A.8). Its classical tracer took a hundred paths and more for a "
        "standard error as large as the mean. So it took no next-event estimation, whatever the text says; ours takes none here either.\n\n"
        f"Below, `pt --strategies hit --error` 1 and 0.5 by `--guide never` and `--guide always`: {options.size} pixels, {options.threads} threads, {options.seeds} seeds; intervals hold 95 %. "
        "Seconds run from the start to the image, training included; P03T's are without its first pass. Ours takes more samples to a threshold, because it must hold "
        "in each channel and among neighbours, and in halves that do not judge themselves. P03T's 200 % is left out: any two paths that meet the lamp satisfy it.\n\n"
        "| box | threshold | samples per pixel | guided | P03T's paths per pixel | informed | seconds | guided | times as long without | wanted | P03T's |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n" + "".join(map(line, rows))
    )


def line(row: Row) -> str:
    """Of the table."""
    samples, seconds, published = row.samples, row.seconds, row.published
    return (
        f"| {row.name} | {row.threshold} % | {samples['plain']:.0f} | {samples['guided']:.0f} | {published.classical:.0f} | {published.informed:.0f} | "
        f"{seconds['plain']:.1f} | {seconds['guided']:.1f} | {row.gain} | {WANTED:g} | {published.times:.2f} |\n"
    )
