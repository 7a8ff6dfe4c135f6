"""Renders every line of the table and judges all of them together."""

import os
import sys
import time
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import tyndall
from tyndall.failure import Failure
from tyndall.scene import Scene, changed
from validation.closed_forms.case import SIZE
from validation.compare import options_of
from validation.stability import albedo, anisotropy, boundaries, contrast, grazing, index, lamps, published, report, scale, thickness, voids, walks
from validation.stability.case import Case
from validation.stability.judge import Found, judge
from validation.stability.report import Line
from tyndall.statistics import Estimate

GROUPS = (thickness, albedo, anisotropy, contrast, scale, lamps, boundaries, grazing, walks, index, voids, published)
"""In the order of the table."""
PATIENCE = 300
"""Seconds after which one image counts as never finished."""
SINGLE = 64
"""Pixels a side of the images of one sample per pixel."""


@dataclass(frozen=True)
class Effort:
    """How much is rendered: independent images of each line; at most so many samples a pixel in each, times the line's own
    factor; the first seed."""

    batches: int = 12
    spp: int = 2048
    seed: int = 1

FEWEST = 16
"""Samples a pixel, however little noise there is."""
AIM = 0.6
"""Lines are rendered to this part of what they must resolve: the noise itself is an estimate."""


def cases(only: str = "") -> list[Case]:
    """The lines whose row or name contains `only`, or one of several such texts with | between them."""
    every = [case for group in GROUPS for case in group.cases()]
    return [case for case in every if any(part in f"{case.row}: {case.name}" for part in only.split("|"))]


def run(effort: Effort, output: Path, only: str = "", perturbation: float = 0, quick: bool = False) -> bool:
    """Makes the table; true if all of it holds or, of a perturbed one, if every line refuses what it claims to see.
    A `quick` table says that it is one."""
    chosen = cases(only)
    if not chosen:
        raise Failure(f"no line of the stability table contains {only!r}", "name a part of a row or of a case, or leave --only out")
    lines = []
    print(report.HEADER, flush=True)
    for line in found_lines(chosen, effort, 1 + perturbation):
        lines.append(line)
        print(report.short(line), flush=True)
    table = report.Table(lines, command(sys.argv[1:]), perturbation, quick)
    table.write(output)
    print(table.summary())
    return table.holds()


def command(arguments: list[str]) -> str:
    """What was typed, but for where the table goes."""
    kept = [a for i, a in enumerate(arguments) if not a.startswith("--output") and arguments[i - 1 : i] != ["--output"]]
    return " ".join(["python3 -m validation", *kept])


def found_lines(chosen: list[Case], effort: Effort, factor: float) -> Iterator[Line]:
    """Every case by every method, in order; all processors render."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        pairs = [(case, method) for case in chosen for method in case.methods]
        yield from pool.map(lambda pair: line(pair[0], pair[1], effort, factor), pairs)


def line(case: Case, method: str, effort: Effort, factor: float) -> Line:
    """One line."""
    start = time.perf_counter()
    # Lines have seeds of their own, whichever of them are rendered: what chance does to one it does not do to others.
    first = effort.seed + 1000 * (zlib.crc32(f"{case.row} {case.name}".encode()) % 100_000)
    try:
        truth = case.expected()
        single = raw(case.scene, method, 1, first, SINGLE if case.methods[method] >= 0.1 else None)[0]
        spp = samples(case, method, single, truth, effort)
        batches = raw(case.scene, method, spp, first + 1, batches=effort.batches)
    except Failure as failure:
        return Line(case, method, None, str(failure))
    return Line(case, method, judge(batches, single, truth, time.perf_counter() - start, factor))


def samples(case: Case, method: str, single: np.ndarray, truth: Estimate, effort: Effort) -> int:
    """Samples a pixel for the line to resolve what it must, as far as one sample of each pixel tells."""
    most = max(1, round(case.methods[method] * effort.spp))
    mean = truth.mean.mean(axis=(0, 1))
    if not np.isfinite(single).all() or not mean.any():
        return min(most, FEWEST)
    lit = mean > 0
    noise = float((spread(single)[lit] / mean[lit] ** 2).max())
    if noise == 0 and not np.allclose(single.mean(axis=(0, 1)), mean, rtol=1e-3):
        return most  # one sample has seen nothing of it
    limit = Found.limit(effort.batches - 1, TYPICAL_LINES)
    wanted = noise * (limit / (AIM * case.required(method))) ** 2 / (SIZE**2 * effort.batches)
    return int(np.clip(wanted, min(most, FEWEST), most))


TYPICAL_LINES = 300


def spread(single: np.ndarray) -> np.ndarray:
    """The variance of a channel's pixels, as far as it is not the picture's own: within squares that are one pixel of the
    truth."""
    height, width, channels = single.shape
    if height == SIZE:
        return single.astype(float).var(axis=(0, 1))
    squares = single.astype(float).reshape(SIZE, height // SIZE, SIZE, width // SIZE, channels)
    return squares.var(axis=(1, 3)).mean(axis=(0, 1))


def raw(scene: Scene, method: str, spp: int, seed: int, size: int | None = None, batches: int | None = None) -> np.ndarray:
    """Independent images, or one, as they are in the file: NaN and infinities included. A contribution that the program left
    out because it was none counts as one."""
    done = tyndall.run(
        Scene(changed(scene.source, single_precision), scene.name, {}, scene.base),
        **options_of(method),
        spp=spp,
        seed=seed,
        size=(size, size) if size else None,
        batches=batches,
        threads=1,
        patience=PATIENCE * (batches or 1),
        must_be_finite=False,
    )
    images = done.image[None] if done.batches is None else done.batches
    if done.report["faults"]:
        images[0, 0, 0, 0] = np.nan
    return images


def single_precision(o: dict) -> dict:
    """Films that can hold 1e20; Mitsuba's default is half precision."""
    return {**o, "component_format": "float32"} if o["type"] == "hdrfilm" else o
