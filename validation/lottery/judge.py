"""What a choice of strategies costs in one scene: relMSE x seconds of the processor, of all that a render takes before its first
sample too. Every image is one process with one thread."""

import json
import os
import subprocess
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import exr, program, rendering
from validation import statistics
from validation.guide import Gain

FLOOR = 0.01
"""Of relMSE: this part of the squared mean is added to a pixel's square."""
CLOSE = 0.7
"""A render of this part of the wanted seconds is long enough to tell how many samples take all of them."""
STEPS = 6
"""It is tried so often."""
TILES = 4
"""Means of this many by this many tiles must agree."""


@dataclass(frozen=True)
class Shot:
    """One image, seconds of the processor (user), what `--report` says, and warnings."""

    image: np.ndarray
    seconds: float
    report: dict[str, Any]
    warnings: list[str]

    def unreached(self) -> set[str]:
        """Light that these strategies leave out."""
        return {entry["light"] for entry in self.report["plan"]["unreached"]}


def shot(scene: Path, words: str, spp: int, seed: int) -> Shot:
    """Renders one."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as name:
        image, report, said = (Path(name, file) for file in ("image.exr", "report.json", "said"))
        given = program.flags({"output": image, "report": report, "threads": 1, "spp": spp, "seed": seed})
        command = [str(program.binary()), "--quiet", "render", str(scene), *given, *words.split()]
        with said.open("w") as stream:
            process = subprocess.Popen(command, stdout=stream, stderr=stream, env=program.environment())
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise program.failure(command, process.returncode, said.read_text())
        return Shot(exr.read_image(image), used.ru_utime, json.loads(report.read_text()), rendering.warnings_in(said.read_text()))


def spp_for(scene: Path, words: str, seconds: float) -> int:
    """So many samples a pixel take about that long: by renders that become longer, as what precedes the first sample may take
    most of the time."""
    before, spp = (0, 0.0), 4
    for _ in range(STEPS):
        taken = shot(scene, words, spp, 1).seconds
        rate = (spp - before[0]) / max(taken - before[1], 1e-3)
        wanted = max(1, round(spp + (seconds - taken) * rate))
        if taken > (CLOSE if before[0] else 1) * seconds:  # one time alone does not tell what precedes the first sample
            break
        before, spp = (spp, taken), min(max(wanted, 2 * spp), 16 * spp)
    return wanted


def shots(scene: Path, words: str, seconds: float, seeds: Iterable[int]) -> list[Shot]:
    """Images of about so many seconds each."""
    spp = spp_for(scene, words, seconds)
    return [shot(scene, words, spp, seed) for seed in seeds]


@dataclass(frozen=True)
class Reference:
    """Independent images, of which the mean is what errors are relative to, and what others must agree with."""

    images: np.ndarray

    @staticmethod
    def of(shots: list[Shot]) -> "Reference":
        return Reference(np.array([one.image for one in shots]))

    @property
    def mean(self) -> np.ndarray:
        return self.images.mean(axis=0)

    def relmse(self, images: np.ndarray) -> list[float]:
        """Of independent images without bias, by how they differ from each other: measured against the reference, its own few
        bright pixels would decide. Whether there is bias, `score` tells."""
        squares = (images - images.mean(axis=0)) ** 2 / (1 - 1 / len(images))
        parts = squares / (self.mean**2 + FLOOR * self.mean.mean() ** 2)
        return [float(part.mean()) for part in parts]

    def score(self, shots: list[Shot]) -> float:
        """How far those are off: the greatest z of tiles, over what it may be where nothing is wrong."""
        ours, theirs = (statistics.estimate(tiles(images)) for images in (self.images, np.array([one.image for one in shots])))
        scores = statistics.standard_score(ours, theirs)
        return float(np.abs(scores).max() / statistics.sidak_limit(scores.size, 1e-3))


def tiles(images: np.ndarray) -> np.ndarray:
    """Grey means of tiles, (image, tile)."""
    count, height, width, _ = images.shape
    parts = images.mean(axis=3).reshape(count, TILES, height // TILES, TILES, width // TILES)
    return parts.mean(axis=(2, 4)).reshape(count, -1)


@dataclass(frozen=True)
class Cost:
    """relMSE x seconds of independent renders."""

    costs: list[float]

    def over(self, other: "Cost") -> Gain:
        """How many times that of the other."""
        return Gain.of(self.costs, other.costs)

    @property
    def mean(self) -> float:
        return float(np.mean(self.costs))


@dataclass(frozen=True)
class Judge:
    """A scene, its reference, and how long renders are."""

    scene: Path
    reference: Reference
    seconds: float

    def cost(self, words: str, seeds: Iterable[int]) -> Cost:
        """Of these options."""
        found = shots(self.scene, words, self.seconds, seeds)
        errors = self.reference.relmse(np.array([one.image for one in found]))
        return Cost([error * one.seconds for error, one in zip(errors, found)])
