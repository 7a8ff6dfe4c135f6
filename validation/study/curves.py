"""Error against seconds as one picture of curves, for a README: light, small, the same bytes from the same numbers."""

import math
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from validation.study.outcome import Contender, Outcome, SceneOutcome

STYLE: Any = {
    "svg.hashsalt": "tyndall",  # else its ids were random
    "font.family": "DejaVu Sans",  # comes with the library
    "font.size": 8.5,
    "axes.titlesize": 9.5,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#666666",
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
}
COLUMNS = 3
WIDTH, ROW_HEIGHT, LEGEND_HEIGHT, LABEL_HEIGHT = 9.4, 2.6, 0.5, 0.12
"""Inches; a browser shows 96 pixels of SVG in each."""
OURS = ("#c43c00", "#e69f00", "#3c8d2f", "#8c6d1f")
OTHERS = ("#0060a8", "#4fb3e8", "#6a3d9a", "#d17fb5")
"""To be told apart by those who see red and green alike: ours are warm, theirs are cold."""
MARKS = "os^D"


def write(outcome: Outcome, path: Path) -> None:
    """Draws the curves of a study into an SVG file, whole or not at all."""
    with matplotlib.rc_context(STYLE):
        partial = path.with_suffix(".partial")
        figure(outcome).savefig(partial, format="svg", metadata={"Date": None, "Creator": None})
    partial.replace(path)


def figure(outcome: Outcome) -> Figure:
    """A panel for each scene, and one legend."""
    rows = math.ceil(len(outcome.scenes) / COLUMNS)
    height = rows * ROW_HEIGHT + LEGEND_HEIGHT
    made = Figure(figsize=(WIDTH, height), facecolor="white")
    looks = looks_of(outcome)
    axes = made.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axis, scene in zip(axes, outcome.scenes):
        panel(axis, scene, looks)
    for axis in axes[len(outcome.scenes) :]:
        axis.set_axis_off()
    below = LEGEND_HEIGHT / height
    made.text(0.5, below, "seconds", ha="center", va="bottom")
    made.text(0.004, (1 + below) / 2, "relMSE", ha="left", va="center", rotation=90)
    handles = [Line2D([], [], label=name, **look) for name, look in looks.items()]
    made.legend(handles=handles, loc="lower center", ncols=4, frameon=False)
    made.tight_layout(rect=(0.02, below + LABEL_HEIGHT / height, 1, 1), w_pad=1.2)
    return made


Look = dict[str, Any]
"""Options of a line."""


def looks_of(outcome: Outcome) -> dict[str, Look]:
    """How each contender's line looks, the same in all panels."""
    names = list(dict.fromkeys(c.name for scene in outcome.scenes for c in scene.contenders))
    ours = [name for name in names if not is_other(name)]
    others = [name for name in names if is_other(name)]
    return {name: look(i, OURS, "-") for i, name in enumerate(ours)} | {name: look(i, OTHERS, "--") for i, name in enumerate(others)}


def is_other(name: str) -> bool:
    """True of Mitsuba's."""
    return name.startswith("mitsuba")


def look(number: int, colours: tuple[str, ...], line: str) -> Look:
    """Of the so-manieth of its renderer; the first, which matters most, is the thickest."""
    which = number % len(colours)
    return {
        "color": colours[which],
        "linestyle": line,
        "marker": MARKS[(which + number // len(colours)) % len(MARKS)],
        "linewidth": 1.3 if number else 1.9,
        "markersize": 4,
    }


def panel(axis: Axes, scene: SceneOutcome, looks: dict[str, Look]) -> None:
    """One scene's curves."""
    axis.set(xscale="log", yscale="log")
    axis.set_title(scene.name.replace("_", " "))
    axis.grid(True)
    axis.set_axisbelow(True)
    for contender in scene.contenders:
        curve(axis, contender, looks[contender.name])
    if scene.reference.own_relmse:
        low, high = axis.get_ylim()
        axis.axhline(scene.reference.own_relmse, color="#888888", linestyle=":", linewidth=1)
        axis.set_ylim(min(low, scene.reference.own_relmse / 1.5), high)
    for one in (axis.xaxis, axis.yaxis):
        ticks(one, *one.get_view_interval())


def curve(axis: Axes, contender: Contender, look: Look) -> None:
    """One contender's points with what is sure about them; a number that is none leaves a gap."""
    seconds = [point.seconds.mean for point in contender.points]
    errors = [point.relmse for point in contender.points]
    low, high = [error.low for error in errors], [error.high for error in errors]
    axis.fill_between(seconds, low, high, color=look["color"], alpha=0.18, linewidth=0)
    axis.vlines(seconds, low, high, color=look["color"], linewidth=0.8)  # a band of one point could not be seen
    axis.plot(seconds, [error.mean for error in errors], **look)


def ticks(axis: matplotlib.axis.Axis, low: float, high: float) -> None:
    """Numbers at powers of ten, or at 1, 2 and 5 where there are too few of those."""
    few = math.log10(high / low) < 1.6
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(tick))


def tick(value: float, _: object = None) -> str:
    """A short number, or a power of ten."""
    power = math.floor(math.log10(value) + 1e-9)
    return f"{value:g}" if -3 <= power <= 3 else f"${value / 10**power:.0f} \\cdot 10^{{{power}}}$".replace("1 \\cdot ", "")
