"""The figure of a study as papers show it: for each scene its reference with frames of crops, and beside it these crops by every
contender, with what they cost. `tyndall report --figure` describes it. Its package, matplotlib, is an extra:
`pip install tyndall[figure]`."""

import json
import logging
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from tyndall import exr
from tyndall.failure import Failure

WIDTH = 7.0
"""Of a page of two columns (inches)."""
GAP = 0.035
"""Between images (inches)."""
LINE = 0.126
"""Between lines of text (inches)."""
ROOM = 0.1
"""Between scenes (inches)."""
SIZE, LEAST_SIZE = 8.0, 5.0
"""Of text, and of names that have little room (points)."""
FRAME = 1.1
"""Width of a frame (points)."""
COLOURS = ("#e8590c", "#1c7ed6", "#2f9e44", "#ae3ec9", "#f2b705", "#0c8599")
"""Of the frames, told apart by all eyes in pairs."""
DOTS = 450
"""For an inch: pixels become so many squares that none is blurred."""
FONTS = ("Linux Libertine O", "Libertinus Serif", "Linux Libertine", "STIX Two Text", "STIXGeneral")
"""The first that there is, as most journals of the field set their text; matplotlib brings the last."""
OTHERS = ("DejaVu Serif", "DejaVu Sans")
"""What has letters that it lacks; matplotlib brings both."""
RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
"""Digits of exponents, which few fonts have."""
REFERENCE = "Reference"
COSTS = (("relMSE", "relmse"), ("time", "seconds"), ("speed-up", "lead"))
"""Lines below the images: what is said of a contender."""


def library() -> Any:
    """The package that draws, an extra."""
    try:
        import matplotlib
    except ImportError:
        raise Failure("matplotlib is not installed", "pip install matplotlib, or tyndall[figure] in place of tyndall") from None
    matplotlib.use("agg")
    return matplotlib


@dataclass(frozen=True)
class Column:
    """The crops of one image."""

    image: Any
    name: str
    told: dict[str, Any]
    """A contender's costs; of the reference, nothing."""


@dataclass(frozen=True)
class Row:
    """A scene, with its sizes (inches)."""

    name: str
    reference: Any
    crops: list[tuple[int, int, int, int]]
    """Column, row, width and height, in pixels."""
    columns: list[Column]

    @property
    def aspect(self) -> float:
        """Width of the whole image over its height."""
        return float(self.reference.shape[1] / self.reference.shape[0])

    @property
    def tallness(self) -> float:
        """Height of all crops of a column together, over its width."""
        return sum(height / width for _, _, width, height in self.crops)

    @property
    def height(self) -> float:
        """So that the images fill the width, and a column of crops is as high as the whole."""
        count, gaps = len(self.columns), GAP * (len(self.crops) - 1)
        return (WIDTH - GAP * count + count * gaps / self.tallness) / (self.aspect + count / self.tallness)

    @property
    def crop_width(self) -> float:
        """Of all crops."""
        return (self.height - GAP * (len(self.crops) - 1)) / self.tallness

    def left(self, column: int) -> float:
        """Where a column begins."""
        return self.aspect * self.height + GAP + column * (self.crop_width + GAP)


def draw(description: Path, outputs: Sequence[Path]) -> None:
    """Writes the figure that `tyndall report` describes."""
    matplotlib = library()
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    rows = [row(told) for told in json.loads(description.read_text())["rows"]]
    with matplotlib.rc_context({"pdf.fonttype": 42, "font.family": [font(), *OTHERS], "mathtext.fontset": "stix", "font.size": SIZE}):
        figure = figure_of(rows)
        for output in outputs:
            exr.whole(output, partial(figure.savefig, dpi=DOTS, metadata=metadata(output)))


def metadata(output: Path) -> dict[str, Any]:
    """What files say of themselves; no date, so that the same study gives the same file."""
    return {"Creator": "tyndall", "CreationDate": None} if output.suffix.lower() == ".pdf" else {"Software": "tyndall"}


def font() -> str:
    """A family that is there."""
    from matplotlib import font_manager

    there = {font.name for font in font_manager.fontManager.ttflist}
    return next((name for name in FONTS if name in there), "serif")


def row(told: dict[str, Any]) -> Row:
    """As it is described."""
    from matplotlib.image import imread

    reference = imread(told["reference"])
    columns = [Column(imread(one["image"]), one["name"], one) for one in told["columns"]]
    crops = [(x, y, width, height) for x, y, width, height in told["crops"]]
    return Row(told["name"], reference, crops, [*columns, Column(reference, REFERENCE, {})])


def figure_of(rows: Sequence[Row]) -> Any:
    """All rows, one below the other."""
    from matplotlib.figure import Figure

    names = [fitted(row) for row in rows]
    heights = [row.height + names_height(size, lines) + LINE * (len(COSTS) + 0.35) for row, (size, lines) in zip(rows, names, strict=True)]
    figure = Figure(figsize=(WIDTH, sum(heights) + ROOM * (len(rows) - 1)))
    top = 0.0
    for row, (size, lines), height in zip(rows, names, heights, strict=True):
        images(Canvas(figure, top), row)
        captions(Canvas(figure, top + row.height), row, size, lines)
        top += height + ROOM
    return figure


def names_height(size: float, names: Sequence[Sequence[str]]) -> float:
    """From the images to the base of the last line of names."""
    return LINE * (1 + (max(map(len, names)) - 1) * size / SIZE)


@dataclass(frozen=True)
class Canvas:
    """A figure, measured in inches from its left and from `top` down."""

    figure: Any
    top: float

    def at(self, x: float, y: float) -> tuple[float, float]:
        """In the figure's own measure."""
        return x / self.figure.get_figwidth(), 1 - (self.top + y) / self.figure.get_figheight()

    def image(self, pixels: Any, x: float, y: float, width: float) -> Any:
        """An image, each pixel of which stays a square."""
        height = width * pixels.shape[0] / pixels.shape[1]
        left, bottom = self.at(x, y + height)
        axes = self.figure.add_axes((left, bottom, width / self.figure.get_figwidth(), height / self.figure.get_figheight()))
        axes.set_axis_off()
        times = max(1, round(width * DOTS / pixels.shape[1]))
        down, across = pixels.shape[:2]
        axes.imshow(pixels.repeat(times, 0).repeat(times, 1), interpolation="none", extent=(0, across, down, 0), aspect="auto")
        return axes

    def text(self, x: float, y: float, text: str, parse_math: bool = False, **more: Any) -> None:
        """A line whose base is at y; dollars in it are dollars, unless it is mathematics."""
        self.figure.text(*self.at(x, y), text, va="baseline", parse_math=parse_math, **more)


def images(canvas: Canvas, row: Row) -> None:
    """The whole reference with frames, and the crops of everybody in the same colours."""
    whole = canvas.image(row.reference, 0, 0, row.aspect * row.height)
    for crop, colour in zip(row.crops, colours(row), strict=True):
        frame(whole, crop, colour)
    for number, column in enumerate(row.columns):
        y = 0.0
        for (left, top, width, height), colour in zip(row.crops, colours(row), strict=True):
            axes = canvas.image(column.image[top : top + height, left : left + width], row.left(number), y, row.crop_width)
            border(axes, colour)
            y += row.crop_width * height / width + GAP


def colours(row: Row) -> Iterator[str]:
    """One for each crop."""
    return (COLOURS[index % len(COLOURS)] for index in range(len(row.crops)))


def frame(axes: Any, crop: tuple[int, int, int, int], colour: str) -> None:
    """Around a part of an image; its edge is seen on any ground."""
    from matplotlib.patches import Rectangle

    x, y, width, height = crop
    for line, edge in ((FRAME + 0.8, "white"), (FRAME, colour)):
        axes.add_patch(Rectangle((x, y), width, height, fill=False, edgecolor=edge, linewidth=line, joinstyle="miter", clip_on=False))


def border(axes: Any, colour: str) -> None:
    """Around a whole image, within its edges."""
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((0, 0), 1, 1, transform=axes.transAxes, fill=False, edgecolor=colour, linewidth=2 * FRAME, joinstyle="miter", clip_on=True))


def captions(canvas: Canvas, row: Row, size: float, names: Sequence[Sequence[str]]) -> None:
    """Below the images: the name of the scene and of each column, and its costs; the best is bold."""
    canvas.text(0, LINE, row.name, weight="bold")
    first = names_height(size, names)
    right = row.aspect * row.height
    for line, (label, _) in enumerate(COSTS, 1):
        canvas.text(right, first + line * LINE, label, ha="right", color="#555555")
    for number, (column, lines) in enumerate(zip(row.columns, names, strict=True)):
        middle = row.left(number) + row.crop_width / 2
        for line, text in enumerate(lines):
            canvas.text(middle, LINE * (1 + line * size / SIZE), text, ha="center", size=size)
        for line, (_, key) in enumerate(COSTS, 1):
            is_bold = key == "lead" and column.told.get("is_best", False)
            text = raised(column.told.get(key, ""), is_bold)
            canvas.text(middle, first + line * LINE, text, parse_math=True, ha="center", weight="bold" if is_bold else "normal")


def raised(number: str, is_bold: bool) -> str:
    """A number whose exponent is mathematics: of fonts for text, few have all raised digits."""
    style = "mathbf" if is_bold else "mathrm"
    return re.sub("10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", lambda found: rf"$\{style}{{10^{{{found[1].translate(RAISED)}}}}}$", number)


def fitted(row: Row) -> tuple[float, list[list[str]]]:
    """The size of names that fits all of them, in points, and their lines: two if one would be too small."""
    names = [column.name for column in row.columns]
    for lines in ([[name] for name in names], [halves(name) for name in names]):
        room = row.crop_width / max(width_of(line) for name in lines for line in name)
        if room >= LEAST_SIZE:
            break
    return min(SIZE, room), lines


def width_of(text: str) -> float:
    """Of a line of one point (inches)."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    return float(TextPath((0, 0), text, size=100, prop=FontProperties(family=font())).get_extents().width) / 7200


def halves(name: str) -> list[str]:
    """A name on two lines, broken near its middle where it may be."""
    places = [index + 1 for index, letter in enumerate(name[:-1]) if letter in " +-_,:/"]
    if not places:
        return [name]
    place = min(places, key=lambda place: abs(place - len(name) / 2))
    return [name[:place].rstrip(), name[place:]]
