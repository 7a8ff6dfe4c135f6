"""What the same time buys, as one small picture: each scene's reference beside an image of ours and one of Mitsuba's."""

import math
from itertools import product
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation import exr, picture
from validation.study.outcome import Contender, Outcome, Point, SceneOutcome

BLOCKS = 2
"""Scenes in a row, three images each."""
WIDTH, ROW_HEIGHT = 9.0, 1.9
"""Inches of `DPI` pixels."""
DPI = 100
STYLE: Any = {"font.family": "DejaVu Sans", "font.size": 7.5}
FIRST = "tyndall bdpt"


def write(outcome: Outcome, folder: Path, path: Path) -> None:
    """Draws a study's images, which lie in `folder`, into a PNG file, whole or not at all."""
    with matplotlib.rc_context(STYLE):
        partial = path.with_suffix(".partial")
        figure(outcome, folder).savefig(partial, format="png", dpi=DPI, metadata={"Software": None})
    partial.replace(path)


def figure(outcome: Outcome, folder: Path) -> Figure:
    """All scenes."""
    rows = math.ceil(len(outcome.scenes) / BLOCKS)
    made = Figure(figsize=(WIDTH, rows * ROW_HEIGHT), facecolor="white", layout="constrained")
    axes = made.subplots(rows, 3 * BLOCKS, squeeze=False).ravel()
    for axis in axes:
        axis.set_axis_off()
    for number, scene in enumerate(outcome.scenes):
        strip(list(axes[3 * number : 3 * number + 3]), scene, folder)
    return made


def strip(axes: list[Axes], scene: SceneOutcome, folder: Path) -> None:
    """One scene's images, brought to light alike."""
    reference = exr.read_image(folder / scene.reference.image)
    white = picture.white_of(reference)
    show(axes[0], reference, white, f"{scene.name}\nreference")
    for axis, (contender, point) in zip(axes[1:], equal_time(scene)):
        name = contender.name.removeprefix("tyndall ").removeprefix("mitsuba ").replace("_ad_rgb", "").replace("_rgb", "")
        title = f"{name}, {point.seconds.mean:.2g} s\nrelMSE {point.relmse.mean:.2g}"
        show(axis, exr.read_image(folder / point.image), white, title)


def show(axis: Axes, image: np.ndarray, white: float, title: str) -> None:
    """One image; what is no number is black."""
    axis.imshow(picture.displayed(np.nan_to_num(image, posinf=white, neginf=0), white), interpolation="nearest")
    axis.set_title(title, fontsize=STYLE["font.size"], pad=3)


def equal_time(scene: SceneOutcome) -> list[tuple[Contender, Point]]:
    """Ours and the most efficient of Mitsuba's, each with the image that it had after about the same time."""
    ours = next((c for c in scene.contenders if c.name == FIRST and c.points), None)
    others = [c for c in scene.contenders if c.name.startswith("mitsuba") and c.points]
    best = max(others, key=lambda c: sure(c.efficiency.mean), default=None)
    if ours is None or best is None:
        return [(c, c.points[-1]) for c in (ours, best) if c]
    own, other = min(product(ours.points, best.points), key=lambda pair: unlike(*pair))
    return [(ours, own), (best, other)]


ALIKE = math.log(1.25)
"""Times this near each other are the same."""


def unlike(own: Point, other: Point) -> tuple[float, float]:
    """How bad a pair is: times that differ, and among those that do not a short one."""
    apart = abs(math.log(other.seconds.mean / own.seconds.mean))
    return (apart if apart > ALIKE else 0.0, -own.seconds.mean)


def sure(number: float) -> float:
    """What is no number is the least."""
    return number if math.isfinite(number) else -math.inf
