"""The stability table: printed, as Markdown and as JSON."""

import json
import math
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from validation.files import write_text
from validation.stability.case import Case
from validation.stability.judge import Found, refused
from tyndall.statistics import SIGNIFICANCE

CASE_WIDTH, METHOD_WIDTH = 52, 19
HEADER = (
    f"{'case':{CASE_WIDTH}} {'method':{METHOD_WIDTH}} {'expected':>12} {'found':>12} {'std error':>10} {'relative':>10} {'chance':>8}"
    f" {'NaN/inf':>7} {'worst':>9} {'time':>8}"
)


@dataclass(frozen=True)
class Line:
    """One case by one method, and what was found or why nothing was."""

    case: Case
    method: str
    found: Found | None
    problem: str = ""


def short(line: Line) -> str:
    """As printed while the table grows."""
    start = f"{line.case.name:{CASE_WIDTH}} {line.method:{METHOD_WIDTH}}"
    f = line.found
    if f is None:
        return f"{start} CANNOT: {line.problem}"
    return (
        f"{start} {f.expected:12.6g} {f.found:12.6g} {f.error:10.2g} {100 * f.difference:+8.3f} % {f.probability:8.2g}"
        f" {f.not_finite:7d} {f.worst:9.3g} {f.seconds:6.1f} s"
    )


HOLDS = "holds"
COARSELY = "holds, coarsely"
"""So does a line that could have hidden more than it should."""


@dataclass(frozen=True)
class Table:
    """All lines, judged together."""

    lines: list[Line]
    command: str
    """That made it."""
    perturbation: float
    quick: bool

    def verdicts(self) -> list[str]:
        """A word for each line."""
        verdicts = refused([line.found.probability if line.found else 0 for line in self.lines])
        return [self.verdict(line, wrong) for line, wrong in zip(self.lines, verdicts)]

    def verdict(self, line: Line, wrong: bool) -> str:
        if line.found is None:
            return "CANNOT"
        if wrong and line.case.flaw and abs(line.found.difference) <= line.case.flawed_by and not line.found.not_finite:
            return "KNOWN FLAW"
        if wrong:
            return "REFUSED"
        return COARSELY if self.coarse(line) else HOLDS

    def coarse(self, line: Line) -> bool:
        """True if an error could hide here that the case says would not."""
        if line.found is None:
            return False
        resolution = line.found.resolution(len(self.lines))
        return math.isfinite(resolution) and resolution > line.case.required(line.method)

    def unseen(self) -> list[Line]:
        """Of a perturbed table: the lines that should have refused and did not."""
        seen = lambda line: line.found.resolution(len(self.lines)) <= abs(self.perturbation)
        return [line for line, v in zip(self.lines, self.verdicts()) if v not in ("REFUSED", "KNOWN FLAW") and line.found and seen(line)]

    def failing(self) -> list[Line]:
        """The lines that do not hold."""
        return [line for line, verdict in zip(self.lines, self.verdicts()) if verdict not in (HOLDS, COARSELY, "KNOWN FLAW")]

    def flawed(self) -> int:
        """How many lines are off as is known."""
        return self.verdicts().count("KNOWN FLAW")

    def holds(self) -> bool:
        return not (self.unseen() if self.perturbation else self.failing())

    def summary(self) -> str:
        """The last lines of what is printed."""
        wrong = self.unseen() if self.perturbation else self.failing()
        names = "".join(f"\n  {line.case.row}: {line.case.name}, {line.method}" for line in wrong)
        if self.perturbation:
            claimed = sum(v == "REFUSED" for v in self.verdicts())
            return f"off by {self.perturbation:g}: {claimed} of {len(self.lines)} lines refuse, {len(wrong)} should and do not{names}"
        lost = sum(line.found.not_finite for line in self.lines if line.found)
        flawed = self.flawed()
        holding = f"{len(self.lines) - len(wrong) - flawed} of {len(self.lines)} lines hold"
        coarsely = self.verdicts().count(COARSELY)
        return f"{holding} ({coarsely} of them resolve less than asked), {flawed} are off as is known, {lost} values are NaN or infinite{names}"

    def write(self, folder: Path) -> None:
        """stability.md and stability.json."""
        write_text(folder / "stability.md", self.markdown())
        write_text(folder / "stability.json", json.dumps(self.dictionary(), indent=1) + "\n")

    def markdown(self) -> str:
        """The whole table, row by row."""
        told = [] if not self.quick else ["Made with fewer samples than usual (`--quick`): many lines resolve less than that."]
        parts = [f"# Stability\n\n    {self.command}", INTRODUCTION, *told, self.summary().split("\n")[0] + "."]
        judged = list(zip(self.lines, self.verdicts()))
        for row, group in groupby(judged, key=lambda pair: pair[0].case.row):
            pairs = list(group)
            parts.append("\n".join([f"## {row}", "", COLUMNS, *(self.markdown_line(*pair) for pair in pairs)]))
            remarks = {f"- {line.case.name}: {line.case.coarse}." for line, _ in pairs if line.case.coarse}
            remarks |= {f"- {line.case.name}: {line.case.flaw}." for line, _ in pairs if line.case.flaw}
            remarks |= {f"- {line.case.name}, {line.method}: {line.problem}" for line, _ in pairs if line.problem}
            if remarks:
                parts.append("\n".join(sorted(remarks)))
        return "\n\n".join(parts) + "\n"

    def markdown_line(self, line: Line, verdict: str) -> str:
        f = line.found
        start = f"| {line.case.name} | {line.method} | {line.case.source} |"
        if f is None:
            return f"{start} | | | | | {verdict} | | |"
        resolution = f.resolution(len(self.lines))
        resolves = f"{100 * resolution:.2g} %" if math.isfinite(resolution) else "-"
        difference = f"{100 * f.difference:+.3f} %" if f.expected else "-"
        numbers = f"{f.expected:.6g} | {f.found:.6g} | {f.error:.1e} | {difference} | {resolves}"
        return f"{start} {numbers} | {verdict} | {f.not_finite} | {f.worst:.3g} |"

    def dictionary(self) -> dict:
        """The table for programs."""
        lines = [self.line_dictionary(*pair) for pair in zip(self.lines, self.verdicts())]
        return {"significance": SIGNIFICANCE, "perturbation": self.perturbation, "holds": self.holds(), "lines": lines}

    def line_dictionary(self, line: Line, verdict: str) -> dict:
        case, f = line.case, line.found
        start = {"row": case.row, "case": case.name, "method": line.method, "truth": case.source, "verdict": verdict}
        if f is None:
            return {**start, "problem": line.problem}
        figures = {"found": f.found, "standard_error": f.error, "relative_difference": f.difference if f.expected else math.nan}
        figures["resolution"] = f.resolution(len(self.lines))
        told = {"expected": f.expected, "chance": f.probability, "not_finite": f.not_finite, "worst_sample": f.worst}
        asked = {"required_resolution": case.required(line.method), "why_coarse": case.coarse or None, "known_flaw": case.flaw or None}
        return {**start, **told, **asked, **{name: number(value) for name, value in figures.items()}}


def number(value: float) -> float | None:
    """JSON has no NaN and no infinity."""
    return value if math.isfinite(value) else None


COLUMNS = (
    "| case | method | truth | expected | found | standard error | relative | resolves | verdict | NaN/inf | worst sample |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|"
)
INTRODUCTION = f"""Every number that a scene gives, at its extremes, against truth. Each line is a case by one integrator (and tracker):

- expected, found: the mean over the image, of the channel that differs most; its standard error is that of the difference.
- resolves: the relative difference that would have been refused all but surely. It must be below 2 % (light
  tracing: 6 %), or the reason is told; else the line is said to hold coarsely.
- verdict: means of the image and of {4 * 4} tiles by Welch's test on independent images, all lines together by Holm's rule at
  significance {SIGNIFICANCE:g}.
- NaN/inf: values of all images that are not finite; any is a failure.
- worst sample: the greatest pixel value, over the expected mean, of an image of one sample per pixel."""
