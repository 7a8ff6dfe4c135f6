"""Renders every line of the table and judges all of them together."""

import os
import subprocess
import tempfile
import time
import zlib
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation import mitsuba, tyndall
from validation.failure import Failure
from validation.scene import Scene, changed
from validation.stability import (
    albedo,
    anisotropy,
    boundaries,
    contrast,
    grazing,
    index,
    lamps,
    report,
    scale,
    thickness,
    voids,
    walks,
)
from validation.stability.case import Case
from validation.stability.judge import Found, judge
from validation.stability.report import Line

GROUPS = (thickness, albedo, anisotropy, contrast, scale, lamps, boundaries, grazing, walks, index, voids)
"""In the order of the table."""
PATIENCE = 300
"""Seconds after which one image counts as never finished."""
SINGLE = 64
"""Pixels a side of the images of one sample per pixel."""
SINGLE_SEED = 9000


@dataclass(frozen=True)
class Effort:
    """How much is rendered: independent images of each line, samples a pixel in each (times the line's own factor)."""

    batches: int = 12
    spp: int = 256
    seed: int = 1


def cases(only: str = "") -> list[Case]:
    """The lines whose row or name contains `only`."""
    return [case for group in GROUPS for case in group.cases() if only in f"{case.row}: {case.name}"]


def run(effort: Effort, output: Path, only: str = "", perturbation: float = 0, strict: bool = True) -> bool:
    """Makes the table; true if all of it holds or, of a perturbed one, if every line refuses what it claims to see.
    Where it is not `strict`, too coarse a line is no failure."""
    chosen = cases(only)
    if not chosen:
        raise Failure(f"no line of the stability table contains {only!r}", "name a part of a row or of a case, or leave --only out")
    lines = []
    print(report.HEADER, flush=True)
    for line in found_lines(chosen, effort, 1 + perturbation):
        lines.append(line)
        print(report.short(line), flush=True)
    table = report.Table(lines, perturbation, strict)
    table.write(output)
    print(table.summary())
    return table.holds()


def found_lines(chosen: list[Case], effort: Effort, factor: float) -> Iterator[Line]:
    """Every case by every method, in order; all processors render."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        waiting = [
            (case, method, [pool.submit(rendered, case, method, part, effort, share) for part in range(effort.batches + 1)])
            for case in chosen
            for method, share in case.methods.items()
        ]
        for case, method, images in waiting:
            yield line(case, method, images, factor)


def line(case: Case, method: str, images: list[Future], factor: float) -> Line:
    """One line from its images, the first of which is that of one sample per pixel."""
    try:
        done = [image.result() for image in images]
    except Failure as failure:
        for image in images:
            image.cancel()
        return Line(case, method, None, str(failure))
    (single, _), *batches = done
    seconds = sum(taken for _, taken in done)
    found: Found = judge(np.stack([image for image, _ in batches]), single, case.expected(), seconds, factor)
    return Line(case, method, found)


def rendered(case: Case, method: str, part: int, effort: Effort, share: float) -> tuple[np.ndarray, float]:
    """One image and the seconds it took."""
    start = time.perf_counter()
    if part == 0:
        image = raw(case.scene, method, 1, SINGLE_SEED, SINGLE if share >= 0.1 else None)
    else:
        # Lines have seeds of their own, whichever of them are rendered: what chance does to one it does not do to others.
        seed = effort.seed + 1000 * (zlib.crc32(f"{case.row} {case.name}".encode()) % 100_000) + part
        image = raw(case.scene, method, max(1, round(share * effort.spp)), seed)
    return image, time.perf_counter() - start


def raw(scene: Scene, method: str, spp: int, seed: int, size: int | None = None) -> np.ndarray:
    """An image as it is in the file, NaN and infinities included."""
    integrator, _, tracker = method.partition(":")
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        output = Path(folder, "image.exr")
        path = tyndall.scene_file(Scene(changed(scene.source, single_precision), scene.name, {}, scene.base), Path(folder))
        options = {"-o": output, "--integrator": integrator, "--tracker": tracker, "--spp": spp, "--seed": seed, "--threads": 1}
        options["--size"] = f"{size}x{size}" if size else ""
        arguments = [str(part) for option, value in options.items() if value != "" for part in (option, value)]
        call([str(tyndall.binary()), "render", str(path), *arguments])
        return mitsuba.read_exr(output)


def call(command: list[str]) -> None:
    """Runs the program, but not for ever."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        raise Failure(f"{' '.join(command)}: not done after {PATIENCE} s", "see what does not end") from None
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip()[-2000:]
        raise Failure(f"{' '.join(command)}\n  exit code {done.returncode}: {said}", "run the command by hand")


def single_precision(o: dict) -> dict:
    """Films that can hold 1e20; Mitsuba's default is half precision."""
    return {**o, "component_format": "float32"} if o["type"] == "hdrfilm" else o
