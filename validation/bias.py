"""Bias against the step of ray marching (LW96 sec. 5): `tyndall study --vary step=...` on a cosine cloud and a noise cloud, with
unbiased flights as the truth. All contenders have the same seeds and their renders are compared seed by seed, so that the error of
the study's reference, which all have in common, cancels."""

import argparse
import csv
import json
import math
import os
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from validation import studies
from validation.files import write_report, write_text
from validation.places import OUTPUT, REPORTS, SCENES

CLOUDS = {"function_cosine": "a cosine cloud", "function_noise": "a noise cloud"}
"""Scenes of `scenes/crosscheck/`, in whose boxes rays take some 0.5 to 1.8 m."""
STEPS = (1.6, 0.8, 0.4, 0.2, 0.1, 0.05)
"""The longest intervals [m]."""
EXACT = "unbiased"
LEVEL = 0.95
PATHS = "--integrator pt --strategies hit,next-event"
"""Named, so that no pilot chooses: all contenders draw the same numbers."""


@dataclass(frozen=True)
class Point:
    """The bias of one step."""

    step: float
    bias: float
    """Mean of the image over that of unbiased flights, less 1."""
    error: float
    """Half its interval."""

    @property
    def is_sure(self) -> bool:
        return abs(self.bias) > self.error


@dataclass(frozen=True)
class Curve:
    """A cloud and its points."""

    scene: str
    points: list[Point]


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--spp", type=int, default=1024, help="samples per pixel of each render (default %(default)s)")
    command.add_argument("--seeds", type=int, default=16, help="renders of each contender (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for bias.md, .json and .svg (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures, writes, and judges: the finest step must be the least biased, and a quarter of the coarsest at most."""
    folder = OUTPUT / "bias"
    if not studies.run(line(options, folder)):
        return False
    curves = [Curve(scene, points(folder / "study.csv", scene)) for scene in CLOUDS]
    made_by = json.loads((folder / "study.json").read_text())["made_by"]
    write_report("bias", "Bias against the step of ray marching", page(curves, options, made_by), [asdict(curve) for curve in curves], options.output)
    write_text(options.output / "bias.svg", drawing(curves))
    return all(holds(curve) for curve in curves)


def line(options: argparse.Namespace, folder: Path) -> list[str]:
    """The study's command line."""
    scenes = [os.path.relpath(SCENES / "crosscheck" / f"{name}.json") for name in CLOUDS]
    march = [word for step in STEPS for word in ("--contender", f"step={step}: {PATHS} --step {step}")]
    effort = ["--spp", str(options.spp), "--doublings", "1", "--seeds", str(options.seeds), "--reference-spp", str(options.spp), "--threads", str(options.threads)]
    return [*scenes, "--contender", f"{EXACT}: {PATHS} --tracker auto", *march, *effort, "--restart", "-o", os.path.relpath(folder)]


def points(file: Path, scene: str) -> list[Point]:
    """The bias of every step, from how far the means of its renders are from those of unbiased flights with the same seeds."""
    with file.open() as opened:
        rows = [row for row in csv.DictReader(opened) if row["scene"] == scene]

    def means(contender: str) -> dict[str, float]:
        return {row["seed"]: 1 + float(row["difference"]) for row in rows if row["contender"] == contender}

    truth = means(EXACT)
    return [point(step, means(f"step={step}"), truth) for step in STEPS]


def point(step: float, found: dict[str, float], truth: dict[str, float]) -> Point:
    """From means of images over that of one reference, by seed."""
    whole = float(np.mean(list(truth.values())))
    biases = np.array([(found[seed] - truth[seed]) / whole for seed in truth])
    half = stats.t.ppf(0.5 + LEVEL / 2, len(biases) - 1) * biases.std(ddof=1) / math.sqrt(len(biases))
    return Point(step, float(biases.mean()), float(half))


def holds(curve: Curve) -> bool:
    """True if bias goes away with the step, within what is known of it."""
    first, last = curve.points[0], curve.points[-1]
    return abs(last.bias) <= 0.25 * abs(first.bias) + last.error


def page(curves: list[Curve], options: argparse.Namespace, program: str) -> str:
    """The report."""
    head = (
        "![bias over step](bias.svg)\n\n"
        f"LW96 sec. 5: the medium is traversed at discrete intervals and taken as homogeneous in each. The mean of the image by `--step`, over that by unbiased flights, less 1, in percent, with "
        f"{100 * LEVEL:g} % intervals: {options.seeds} pairs of renders of {options.spp} samples per pixel by `pt`, 18 x 18 pixels, each pair with one seed. "
        f"{program}.\n\n"
    )
    steps = " | ".join(f"{step:g} m" for step in STEPS)
    table = f"| cloud | {steps} |\n|{'---|' * (1 + len(STEPS))}\n"
    for curve in curves:
        cells = " | ".join(f"{100 * point.bias:+.3f} ± {100 * point.error:.3f}" for point in curve.points)
        table += f"| `{curve.scene}`: {CLOUDS[curve.scene]} | {cells} |\n"
    return head + table


WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 400, 70, 20, 20, 60
COLOURS = ("#0072b2", "#d55e00")


def drawing(curves: list[Curve]) -> str:
    """|bias| with its interval over the step, both logarithmic; what is not surely there is hollow."""
    found = [point for curve in curves for point in curve.points]
    lows = [abs(point.bias) for point in found if point.bias]
    low, high = 10 ** math.floor(math.log10(min(lows))), 10 ** math.ceil(math.log10(max(abs(p.bias) + p.error for p in found)))

    def x(step: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log(step / min(STEPS) * 1.2) / math.log(max(STEPS) / min(STEPS) * 1.44)

    def y(value: float) -> float:
        share = math.log(max(value, low) / low) / math.log(high / low)
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * min(share, 1)

    decades = [low * 10**k for k in range(round(math.log10(high / low)) + 1)]
    parts = [f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(d):.1f}" y2="{y(d):.1f}" stroke="#ddd"/><text x="{LEFT - 8}" y="{y(d) + 4:.1f}" text-anchor="end">{100 * d:g} %</text>' for d in decades]
    parts += [f'<text x="{x(step):.1f}" y="{HEIGHT - BOTTOM + 20}" text-anchor="middle">{step:g}</text>' for step in STEPS]
    parts.append(f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 12}" text-anchor="middle">step [m]</text>')
    for colour, curve, index in zip(COLOURS, curves, range(len(curves)), strict=False):
        line_ = " ".join(f"{x(p.step):.1f},{y(abs(p.bias)):.1f}" for p in curve.points)
        parts.append(f'<polyline points="{line_}" fill="none" stroke="{colour}" stroke-width="1.5"/>')
        for p in curve.points:
            ends = (y(max(abs(p.bias) - p.error, 0)), y(abs(p.bias) + p.error))
            fill = colour if p.is_sure else "white"
            parts.append(f'<line x1="{x(p.step):.1f}" x2="{x(p.step):.1f}" y1="{ends[0]:.1f}" y2="{ends[1]:.1f}" stroke="{colour}"/>')
            parts.append(f'<circle cx="{x(p.step):.1f}" cy="{y(abs(p.bias)):.1f}" r="4" fill="{fill}" stroke="{colour}"/>')
        parts.append(f'<text x="{LEFT + 12}" y="{TOP + 18 + 18 * index}" fill="{colour}">{CLOUDS[curve.scene]}</text>')
    inside = "\n".join(parts)
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">\n<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>\n{inside}\n</svg>\n'
