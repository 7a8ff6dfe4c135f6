"""Progressive pictures (P03T ch. 6) against as many pixels on a regular grid: how far `tyndall render --progressive` is from all pixels
shaded, by the same samples of each, and how long it takes."""

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tyndall.commands import diff
from tyndall.rendering import Rendering
from tyndall.rendering import run as render
from validation.files import write_report
from validation.places import REPORTS, SCENES

PT: dict[str, Any] = {"strategies": "hit,next-event"}
JOINED: dict[str, Any] = {"strategies": "hit,next-event,join", "connections": "all"}
"""Strategies that shade single pixels, named: all contenders use the same, and no pilot chooses. A pixel that is shaded is the same in
all of them; with light subpaths that pixels share it would not be."""
CASES = {
    SCENES / "gallery" / "cornell_d.json": PT,
    SCENES / "gallery" / "floating_cubes.json": PT,
    SCENES / "gallery" / "reflector.json": JOINED,
    SCENES / "foggy_room.json": PT,
}
PARTS = (0.05, 0.1, 0.2)
METHODS = ("straight", "regions")
TRUTH = 8
"""Samples of the truth, over those of a pixel that is shaded."""
EQUAL = (*METHODS, "all", "denoised")
"""What is compared at as many samples in all."""


@dataclass(frozen=True)
class Row:
    """A scene, and a part of its pixels."""

    scene: str
    part: float
    relmse: dict[str, float]
    """Of the grid and of both methods."""
    flip: dict[str, float]
    seconds: dict[str, float]
    """Of both methods, and of all pixels."""

    equal: dict[str, dict[str, float]]
    """relMSE, FLIP and seconds of as many samples in all, of some of the pixels or of all, against a truth with samples of its own."""

    @property
    def is_better(self) -> bool:
        """Both methods are nearer to all pixels than the grid is."""
        return all(self.relmse[method] < self.relmse["grid"] for method in METHODS)


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--spp", type=int, default=64, help="samples of each pixel that is shaded (default %(default)s)")
    command.add_argument("--size", default="256x192", help="(default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for progressive.md (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures and writes the table; true if both methods are better than the grid everywhere."""
    rows = [row for scene, strategies in CASES.items() for row in rows_of(scene, strategies, options)]
    write_report("progressive", "Progressive pictures", page(rows, options), None, options.output)
    return all(row.is_better for row in rows)


def rows_of(scene: Path, strategies: dict[str, Any], options: argparse.Namespace) -> list[Row]:
    """Those of one scene."""
    given: dict[str, Any] = {**strategies, "integrator": "bdpt", "film_samples": "own", "spp": options.spp, "size": options.size, "threads": options.threads}
    whole = render(scene, **given)
    truth = render(scene, **{**given, "spp": TRUTH * options.spp, "seed": 1})
    found = []
    for part in PARTS:
        few = {method: render(scene, progressive=method, fraction=part, **given) for method in METHODS}
        images = {"grid": gridded(whole.image, part), **{method: one.image for method, one in few.items()}}
        measures = {name: diff(image, whole.image) for name, image in images.items()}
        found.append(
            Row(
                scene.stem,
                part,
                {name: measure["radiance"]["relmse"] for name, measure in measures.items()},
                {name: measure["flip"] for name, measure in measures.items()},
                {**{method: one.render_seconds for method, one in few.items()}, "all": whole.render_seconds},
                equal(few, thin(scene, part, given), truth.image),
            )
        )
    return found


def thin(scene: Path, part: float, given: dict[str, Any]) -> Rendering:
    """All pixels at as many samples as this part of them has in all, with what a denoiser wants."""
    return render(scene, **{**given, "spp": max(1, round(part * given["spp"])), "features": True})


def equal(few: dict[str, Rendering], thin: Rendering, truth: np.ndarray) -> dict[str, dict[str, float]]:
    """See `Row.equal`. Seconds are without those of the denoiser."""
    images = {**{method: one.image for method, one in few.items()}, "all": thin.image, "denoised": np.asarray(thin.picture.denoised())}
    measures = {name: diff(image, truth) for name, image in images.items()}
    seconds = {**{method: one.render_seconds for method, one in few.items()}, "all": thin.render_seconds, "denoised": thin.render_seconds}
    return {
        "relmse": {name: measure["radiance"]["relmse"] for name, measure in measures.items()},
        "flip": {name: measure["flip"] for name, measure in measures.items()},
        "seconds": seconds,
    }


def gridded(image: np.ndarray, part: float) -> np.ndarray:
    """The image from this part of its pixels, on a regular grid with the corners in it, the others interpolated bilinearly."""
    height, width, _ = image.shape
    across = max(2, round((part * width * width) ** 0.5))
    down = max(2, int(part * height * width) // across)
    columns, rows = (np.round(np.linspace(0, size - 1, count)).astype(int) for size, count in ((width, across), (height, down)))
    wide = interpolated(image[rows][:, columns], columns, width, axis=1)
    return interpolated(wide, rows, height, axis=0)


def interpolated(values: np.ndarray, places: np.ndarray, size: int, axis: int) -> np.ndarray:
    """Values at `places` along an axis, at all of its `size` places."""
    return np.apply_along_axis(lambda line: np.interp(np.arange(size), places, line), axis, values)


def page(rows: list[Row], options: argparse.Namespace) -> str:
    """The report."""
    return (
        "`--progressive` (P03T ch. 6) shades a part of the pixels and interpolates the others. Below, how far that is from all pixels shaded, with "
        f"{options.spp} samples of each pixel in both, {options.size} pixels, {options.threads} threads: relMSE and FLIP, beside as many pixels on a regular grid, "
        "interpolated bilinearly. The noise of the pixels that are not shaded counts as error for all. Seconds are of the render alone; "
        "the machine may have been busy with other work.\n\n"
        "| scene | pixels | relMSE: grid | straight | regions | FLIP: grid | straight | regions | seconds: straight | regions | all pixels |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n" + "".join(map(line, rows)) + "\n"
        f"{verdict(rows)} The table has the errors against a truth of {TRUTH * options.spp} samples of each pixel with a seed of its own. `all` is all pixels at as many "
        "samples in all, `denoised` the same by Open Image Denoise with albedo and normals; its own time is not in the seconds.\n\n"
        "| scene | pixels | relMSE: straight | regions | all | denoised | FLIP: straight | regions | all | denoised | seconds: straight | regions | all |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n" + "".join(map(equal_line, rows))
    )


def verdict(rows: list[Row]) -> str:
    """How often the better method is nearer to the truth than all pixels are, plain and denoised."""

    def wins(measure: str, other: str) -> int:
        return sum(min(row.equal[measure][method] for method in METHODS) < row.equal[measure][other] for row in rows)

    parts = [f"than all pixels {'denoised' if other == 'denoised' else 'as they are'} in {wins('relmse', other)} by relMSE and in {wins('flip', other)} by FLIP"
             for other in ("all", "denoised")]
    return f"At as many samples in all, the better method is nearer to the truth {', and '.join(parts)}, of {len(rows)} rows."


def equal_line(row: Row) -> str:
    """Of the second table."""
    errors = [f"{row.equal[measure][name]:.3f}" for measure in ("relmse", "flip") for name in EQUAL]
    seconds = [f"{row.equal['seconds'][name]:.1f}" for name in (*METHODS, "all")]
    return f"| {' | '.join([f'`{row.scene}`', f'{100 * row.part:.0f} %', *errors, *seconds])} |\n"


def line(row: Row) -> str:
    """Of the table."""
    names = ("grid", *METHODS)
    errors = [f"{measure[name]:.3f}" for measure in (row.relmse, row.flip) for name in names]
    seconds = [f"{row.seconds[name]:.1f}" for name in (*METHODS, "all")]
    return f"| {' | '.join([f'`{row.scene}`', f'{100 * row.part:.0f} %', *errors, *seconds])} |\n"
