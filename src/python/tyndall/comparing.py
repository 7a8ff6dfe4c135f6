"""Tyndall against Mitsuba on one scene, within a minute."""

import json
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from tqdm import tqdm

from tyndall.commands import info
from tyndall.failure import Failure
from tyndall.picture import Picture
from tyndall.rendering import ALL_STRATEGIES, run
from tyndall.scene import AnyScene, Scene, as_scene

SIDE = 32
"""Pixels of the longer side, unless another size is wanted."""
BATCHES = 8
"""Independent images by each."""
TRIALS = 2
"""A disagreement is tried again with new seeds, and the last one decides: a bias stays, bad luck does not."""
GROWTH = 4
"""By so many times the samples grow until an image takes a good part of its time, by which the time of more is foretold."""
FEWEST, MOST = 4, 4096
"""Samples per pixel of an image."""
ENOUGH = 256
"""Samples per pixel below which images of rare bright paths say too little of their own errors: they may seem to disagree."""

Image = Callable[[int, int], np.ndarray]
"""One image, of so many samples per pixel, by a seed."""


@dataclass(frozen=True)
class Comparison:
    """What was found."""

    verdict: Any
    """`tyndall.judging.Verdict`: how many of the values pass Welch's test, how far the means are apart, what would have been seen."""
    tyndall: Picture
    mitsuba: Picture
    seconds: float
    samples: tuple[int, int]
    """Samples per pixel in each image, by Tyndall and by Mitsuba."""

    @property
    def agrees(self) -> bool:
        """True if nothing tells the images apart."""
        return bool(self.verdict.passed)

    @property
    def scores(self) -> np.ndarray:
        """How far the values of pixels are apart, in standard errors: (height, width, 3)."""
        return np.asarray(self.verdict.map)

    @property
    def advice(self) -> str:
        """What to do about a disagreement that few samples may have made."""
        if self.agrees or min(self.samples) >= ENOUGH:
            return ""
        return "\nSo few samples may have missed rare bright paths of one of both: seconds=600 decides."

    def __str__(self) -> str:
        found, width, height = self.verdict, self.tyndall.shape[1], self.tyndall.shape[0]
        word = "agree" if self.agrees else "differ so far" if self.advice else "DISAGREE"
        return (
            f"{found.scene}, {width} x {height}: Tyndall ({found.integrator}) and Mitsuba {word}.\n"
            f"{100 * found.accepted:.2f} % of the values are within the limit. The means differ by {100 * found.difference:+.2f} %, "
            f"which is {found.image_score:+.1f} standard errors; {100 * found.resolution:.2f} % would have been seen.\n"
            f"{BATCHES} images by each, of {self.samples[0]} and {self.samples[1]} samples per pixel, in {self.seconds:.0f} s.{self.advice}"
        )


def compare(
    scene: AnyScene,
    *,
    parameters: Mapping[str, object] | None = None,
    integrator: str = "bdpt",
    size: tuple[int, int] | None = None,
    seconds: float = 45,
    variant: str | None = None,
    progress: bool | None = None,
) -> Comparison:
    """Renders a scene by Tyndall and by Mitsuba, and tests each value of one against the other; `print` tells what was found.

    The images are small, 32 pixels on the longer side unless `size=(width, height)` is given, and have as many samples as
    half of the `seconds` allow, for a disagreement is tried again. What Mitsuba does not have is refused. Without `variant`, Mitsuba's is
    `llvm_ad_rgb` where LLVM 19 is installed, else `scalar_rgb`. It needs `pip install tyndall[compare]`."""
    from tyndall import judging, mitsuba  # their packages are an extra

    started, found = time.monotonic(), as_scene(scene, parameters)
    size = size or small(found)
    variant = variant or ("llvm_ad_rgb" if mitsuba.libllvm() else "scalar_rgb")
    show = sys.stderr.isatty() if progress is None else progress
    with mitsuba.ALONE:
        loaded = mitsuba.load(found, variant, size)
        by = {"Tyndall": tyndall_image(found, integrator, size), "Mitsuba": lambda spp, seed: mitsuba.image(loaded, spp, seed)}
        each = seconds / TRIALS / len(by) / BATCHES
        samples = {name: affordable(image, each) for name, image in by.items()}
        for trial in range(TRIALS):
            with tqdm(total=len(by) * BATCHES, disable=not show, desc=f"about {seconds / TRIALS:.0f} s") as bar:
                images = {name: batches(image, samples[name], trial, bar.update) for name, image in by.items()}
            took = time.monotonic() - started
            ours, theirs = (judging.Measured.of(images[name]) for name in by)
            verdict = judging.judge(found.name, integrator, ours, theirs, took)
            if verdict.passed:
                break
    means = {name: Picture(images[name].mean(axis=0)) for name in by}
    return Comparison(verdict, means["Tyndall"], means["Mitsuba"], took, (samples["Tyndall"], samples["Mitsuba"]))


def small(scene: Scene) -> tuple[int, int]:
    """The size of its film, made small."""
    told = json.loads(info(scene, json=True))
    width, height = told["width"], told["height"]
    factor = min(1.0, SIDE / max(width, height))
    return max(1, round(factor * width)), max(1, round(factor * height))


def tyndall_image(scene: Scene, integrator: str, size: tuple[int, int]) -> Image:
    """Images by Tyndall: with samples as independent as Mitsuba's, and with all strategies, so that all are tested."""
    options: dict[str, Any] = {"integrator": integrator, "size": size, "sampler": "independent", "film_samples": "own"}
    options |= {"strategies": ALL_STRATEGIES} if integrator == "bdpt" else {}
    return lambda spp, seed: run(scene, spp=spp, seed=seed, **options).image


def affordable(image: Image, seconds: float) -> int:
    """The samples per pixel with which an image takes so many seconds, or the fewest that say anything."""
    image(1, 0)  # what is loaded and compiled once
    spp, took = FEWEST, 0.0
    while took < seconds / GROWTH and spp < MOST:
        spp *= GROWTH if took else 1
        begun = time.monotonic()
        image(spp, 0)
        took = max(time.monotonic() - begun, 1e-6)
    return int(np.clip(spp * seconds / took, FEWEST, MOST))


def batches(image: Image, spp: int, trial: int, done: Callable[[], object]) -> np.ndarray:
    """Independent images: (batches, height, width, 3)."""
    found = []
    for seed in range(1, BATCHES + 1):
        found.append(image(spp, 1000 * trial + seed))
        done()
    if len({one.shape for one in found}) != 1:
        raise Failure("the images differ in size", "give size=(width, height)")
    return np.stack(found)
