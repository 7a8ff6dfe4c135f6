"""The stability table: printed, as Markdown and as JSON."""

import json
import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path

from tyndall.statistics import SIGNIFICANCE
from validation.files import write_text
from validation.made import Made
from validation.stability.case import AIM, LIGHT_AIM, Case
from validation.stability.judge import REQUIRED, TILES, Found, refused

CASE_WIDTH, METHOD_WIDTH = 52, 19
HEADER = (
    f"{'case':{CASE_WIDTH}} {'method':{METHOD_WIDTH}} {'expected':>12} {'found':>12} {'std error':>10} {'relative':>10} {'resolves':>9} {'chance':>8}"
    f" {'NaN/inf':>7} {'samples':>8} {'time':>8}"
)
HOLDS, FAILS, UNDECIDED = "holds", "fails", "not decided"


@dataclass(frozen=True)
class Line:
    """One case by one method, and what was found or why nothing was."""

    case: Case
    method: str
    found: Found | None
    kin: int
    """Lines of its kind in the whole table."""
    problem: str = ""
    on: str = ""
    """The processors by which it was rendered."""

    @property
    def resolution(self) -> float:
        """Of what was found."""
        return self.found.resolution(self.kin) if self.found else math.inf

    @property
    def is_known(self) -> bool:
        """True if it is off by no more than it is known to be."""
        f = self.found
        return f is not None and bool(self.case.flaw) and not f.not_finite and abs(f.difference) <= self.case.flawed_by

    def verdict(self, is_refused: bool) -> str:
        if is_refused or self.found is None:
            return FAILS
        return HOLDS if self.resolution <= REQUIRED else UNDECIDED


def short(line: Line) -> str:
    """As printed while the table grows."""
    start = f"{line.case.name:{CASE_WIDTH}} {line.method:{METHOD_WIDTH}}"
    f = line.found
    if f is None:
        return f"{start} CANNOT: {line.problem}"
    return (
        f"{start} {f.expected:12.6g} {f.found:12.6g} {f.error:10.2g} {100 * f.difference:+8.3f} % {100 * line.resolution:7.2f} % {f.probability:8.2g}"
        f" {f.not_finite:7d} {f.samples:8d} {f.seconds:6.1f} s"
    )


@dataclass(frozen=True)
class Table:
    """All lines; those of a kind are judged together."""

    lines: list[Line]
    made: Made
    perturbation: float
    quick: bool

    def judged(self) -> list[tuple[Line, str]]:
        """Each line with its verdict."""
        return [pair for _, kind in groupby(self.lines, key=lambda line: line.case.row) for pair in judged(list(kind))]

    def those(self, verdict: str) -> list[Line]:
        """The lines that it is said of."""
        return [line for line, said in self.judged() if said == verdict]

    def unseen(self) -> list[Line]:
        """Of a perturbed table: the lines that should fail and do not."""
        return [line for line, said in self.judged() if said != FAILS and 0 < line.resolution <= abs(self.perturbation)]

    def failing(self) -> list[Line]:
        """The lines that fail, but for what is known."""
        return [line for line in self.those(FAILS) if not line.is_known]

    def holds(self) -> bool:
        """True if nothing fails; what is not decided is no fault, and is told."""
        return not (self.unseen() if self.perturbation else self.failing())

    def summary(self) -> str:
        """The last lines of what is printed."""
        if self.perturbation:
            wrong = self.unseen()
            told = f"off by {self.perturbation:g}: {len(self.those(FAILS))} of {len(self.lines)} lines fail, {len(wrong)} should and do not"
            return told + names(wrong)
        failing, known = self.failing(), [line for line in self.those(FAILS) if line.is_known]
        told = f"{len(self.those(HOLDS))} of {len(self.lines)} lines hold, {len(known) + len(failing)} fail"
        told += f" ({len(known)} of them as is known)" if known else ""
        told += f", {len(self.those(UNDECIDED))} are not decided; {sum(line.found.not_finite for line in self.lines if line.found)} values are NaN or infinite"
        return told + names(failing) + names(self.those(UNDECIDED), ", not decided")

    def cost(self) -> str:
        """What it took."""
        all_of_them = sum(line.found.seconds for line in self.lines if line.found)
        sharp = sum(line.found is not None and line.resolution <= aim(line) for line in self.lines)
        places = ", ".join(f"{count} on {on}" for on, count in Counter(line.on for line in self.lines).items())
        return f"{sharp} of {len(self.lines)} lines resolve their aim. They took {all_of_them:.0f} s of one processor, {all_of_them / 120:.0f} minutes of two ({places})."

    def write(self, folder: Path) -> None:
        """stability.md and stability.json."""
        write_text(folder / "stability.md", self.markdown())
        write_text(folder / "stability.json", json.dumps(self.dictionary(), indent=1) + "\n")

    def markdown(self) -> str:
        """The whole table, row by row."""
        told = [] if not self.quick else ["Made in less time than usual (`--quick`): many lines resolve less than that."]
        parts = [f"# Stability\n\n    {self.made.command}", f"{self.made}.", INTRODUCTION, *told, self.summary().split("\n")[0] + ".", self.cost()]
        for row, group in groupby(self.judged(), key=lambda pair: pair[0].case.row):
            pairs = list(group)
            parts.append("\n".join([f"## {row}", "", COLUMNS, *(markdown_line(*pair) for pair in pairs)]))
            remarks = {f"- {line.case.name}: {line.case.flaw}." for line, _ in pairs if line.case.flaw}
            remarks |= {f"- {line.case.name}, {line.method}: {line.problem}" for line, _ in pairs if line.problem}
            if remarks:
                parts.append("\n".join(sorted(remarks)))
        return "\n\n".join(parts) + "\n"

    def dictionary(self) -> dict:
        """The table for programs."""
        lines = [line_dictionary(*pair) for pair in self.judged()]
        about = {"significance": SIGNIFICANCE, "required_resolution": REQUIRED, "perturbation": self.perturbation, "holds": self.holds()}
        return {**asdict(self.made), **about, "lines": lines}


def judged(kind: list[Line]) -> list[tuple[Line, str]]:
    """The verdicts of the lines of one kind."""
    verdicts = refused([line.found.probability if line.found else 0 for line in kind], kind[0].kin)
    return [(line, line.verdict(wrong)) for line, wrong in zip(kind, verdicts)]


def aim(line: Line) -> float:
    """What it was rendered to resolve."""
    return LIGHT_AIM if line.method.startswith("lt") else AIM


def names(lines: Iterable[Line], remark: str = "") -> str:
    """Of lines, each on a line of its own."""
    return "".join(f"\n  {line.case.row}: {line.case.name}, {line.method}{remark}" for line in lines)


def markdown_line(line: Line, verdict: str) -> str:
    f = line.found
    start = f"| {line.case.name} | {line.method} | {line.case.source} |"
    if f is None:
        return f"{start} | | | | | {verdict} | | | | |"
    difference, resolves = (f"{100 * f.difference:+.3f} %", f"{100 * line.resolution:.2g} %") if f.expected else ("-", "-")
    worst = "-" if f.worst is None else f"{f.worst:.3g}"
    numbers = f"{f.expected:.6g} | {f.found:.6g} | {f.error:.1e} | {difference} | {resolves}"
    return f"{start} {numbers} | {verdict} | {f.not_finite} | {worst} | {f.samples} | {f.seconds:.1f} |"


def line_dictionary(line: Line, verdict: str) -> dict:
    case, f = line.case, line.found
    start = {"row": case.row, "case": case.name, "method": line.method, "truth": case.source, "verdict": verdict, "known_flaw": case.flaw or None}
    if f is None:
        return {**start, "problem": line.problem}
    figures = {"relative_difference": f.difference if f.expected else math.nan, "resolution": line.resolution}
    return {**start, **{name: number(value) for name, value in (asdict(f) | figures).items()}}


def number(value: float | None) -> float | None:
    """JSON has no NaN and no infinity."""
    return value if value is not None and math.isfinite(value) else None


COLUMNS = (
    "| case | method | truth | expected | found | standard error | relative | resolves | verdict | NaN/inf | worst sample | samples | seconds |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
)
INTRODUCTION = f"""Every number that a scene gives, at its extremes, against truth ([where it is from](../truths.md)). Each line is a case by one
method: an integrator, `/` strategies, `+` what else is chosen, `:` tracker. `bdpt` is all of its strategies, `bdpt+pilot` those that
its pilot chooses.

- expected, found: the mean over the image, of the channel that differs most; its standard error is that of the difference.
- resolves: the relative difference that would have been refused all but surely. Lines are rendered until that is
  {100 * AIM:g} % (light tracing: {100 * LIGHT_AIM:g} %) or their time is up, those above {100 * REQUIRED:g} %, and those that look wrong, for longer.
- verdict: means of the image and of {TILES * TILES} tiles by Welch's test on independent images, all lines of a kind (a table below) by Holm's
  rule at significance {SIGNIFICANCE:g}. A line that would not have refused {100 * REQUIRED:g} % is not decided.
- NaN/inf: values of all images that are not finite; any is a failure.
- worst sample: the greatest pixel value, over the expected mean, of images of one sample per pixel.
- samples: a pixel, in each of 16 images of 8 x 8 pixels. seconds: of one processor."""
