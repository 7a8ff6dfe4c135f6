"""The pixel-by-pixel test of one scene: independent batches from both renderers, Welch's test for each value."""

import os
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import tyndall
from tyndall.failure import Failure
from tyndall.scene import Scene, derived
from validation import mitsuba, picture
from validation.places import OUTPUT
from validation.statistics import Estimate, estimate, exact, sidak_limit, standard_score

ACCEPTED = 0.9975
"""Share of pixel values that must pass, as in Mitsuba's own render tests."""
TILES = 6
"""The image is also compared as so many tiles a side, all of which must pass: what is wrong in one place only."""
IMAGE_ERRORS = 3
"""How many standard errors the image means may be apart."""
NAME_WIDTH, METHOD_WIDTH = 36, 19
"""Of the printed table's first columns [characters]."""
RETRY = 4
"""A disagreement is tried again with so many times the samples and new seeds: a bias stays, bad luck does not."""
TRIALS = 3
"""The last one decides. Of a thousand images some have light that comes by rare, bright paths: their batches say too little of
their own errors, twice by chance."""

MEDIA = ("homogeneous", "heterogeneous")

Size = tuple[int, int] | None
"""Width and height, or the scene's own."""


@dataclass(frozen=True)
class Effort:
    """How much is rendered: independent batches, samples a pixel in each, the first seed."""

    batches: int = 16
    spp: int = 64
    seed: int = 1

    def harder(self) -> "Effort":
        """The effort of the next trial."""
        return Effort(self.batches, RETRY * self.spp, self.seed + 1000)

    def times(self, factor: float) -> "Effort":
        """The effort with so many times the samples."""
        return Effort(self.batches, max(1, round(factor * self.spp)), self.seed)


@dataclass(frozen=True)
class Measured:
    """An image as it is compared: its pixels (height, width, 3), the means of its tiles, and that of the whole (3,)."""

    pixels: Estimate
    tiles: Estimate
    whole: Estimate

    @staticmethod
    def of(batches: np.ndarray) -> "Measured":
        """The mean of independent images."""
        return Measured(estimate(batches), estimate(tiled(batches)), estimate(batches.mean(axis=(1, 2))))

    @staticmethod
    def exactly(image: np.ndarray) -> "Measured":
        """An image known without error."""
        return Measured(exact(image), exact(tiled(image[None])[0]), exact(image.mean(axis=(0, 1))))


Renderer = Callable[[Effort], Measured]
"""One scene by one program and method."""


@dataclass(frozen=True)
class Verdict:
    """What a comparison found."""

    scene: str
    integrator: str
    accepted: float
    """Share of pixel values within the limit for all of them."""
    tile_score: float
    """The worst tile's z, over the limit for all tiles: above 1 is refused."""
    image_score: float
    """Difference of the image means in standard errors, the worst channel, with its sign."""
    difference: float
    """The same, relative to the mean."""
    resolution: float
    """The relative difference that would have been refused."""
    worst: tuple[int, int]
    """The pixel (x, y) that disagrees most."""
    seconds: float
    trials: int = 1
    map: np.ndarray | None = None
    """z of each value."""
    reference: np.ndarray | None = None
    """The mean of Mitsuba's batches."""
    found: np.ndarray | None = None
    """The mean of the candidate's."""
    reference_seconds: float | None = None
    expected: tuple[str, ...] = ()
    """Light that only one of both sides reaches: a disagreement is no fault then."""

    @property
    def passed(self) -> bool:
        return self.accepted >= ACCEPTED and self.tile_score <= 1 and abs(self.image_score) <= IMAGE_ERRORS

    @property
    def word(self) -> str:
        """The verdict in a word."""
        return "agree" if self.passed else "DIFFER" if self.expected else "DISAGREE"

    @property
    def why(self) -> str:
        """Why a difference is no fault, on lines of its own."""
        return "" if self.passed else "".join(f"\n  no fault: {reason}" for reason in self.expected)

    def row(self) -> str:
        where = "" if self.passed else f"  worst pixel {self.worst}"
        again = "" if self.trials == 1 else f"  ({self.trials} trials)"
        return (
            f"{self.scene:{NAME_WIDTH}} {self.integrator:{METHOD_WIDTH}} {100 * self.accepted:8.2f} % {self.tile_score:6.2f} {self.image_score:+8.2f}"
            f" {100 * self.difference:+8.2f} % {100 * self.resolution:7.2f} % {self.seconds:7.1f} s"
            f"  {self.word}{where}{again}{self.why}"
        )


HEADER = (
    f"{'scene':{NAME_WIDTH}} {'method':{METHOD_WIDTH}} {'accepted':>10} {'tiles':>6} {'mean, se':>8} {'mean, rel':>10} {'resolves':>9} {'time':>9}  verdict"
)


def mitsuba_renderer(scene: Scene, variant: str = "scalar_rgb", size: Size = None) -> Renderer:
    """Mitsuba on this scene."""

    def measured(effort: Effort) -> Measured:
        with mitsuba.ALONE:
            loaded = mitsuba.load(scene, variant, size)
            return Measured.of(np.stack([mitsuba.image(loaded, effort.spp, effort.seed + i) for i in range(effort.batches)]))

    return measured


def tyndall_renderer(scene: Scene, method: str, size: Size = None, threads: int | None = None) -> Renderer:
    """Tyndall on this scene."""
    # Samples that are spread evenly leave so little noise that the test would be one of Mitsuba's own approximations,
    # such as filters in tables, and of how independent the batches of its even samplers are.
    options = {**options_of(method), "size": size, "sampler": "independent", "threads": threads}
    render = lambda effort: tyndall.render_batches(scene, effort.batches, spp=effort.spp, seed=effort.seed, **options)
    return lambda effort: Measured.of(render(effort))


def options_of(method: str) -> dict[str, Any]:
    """A method's options: it is an integrator, with strategies after a slash, `+guide` if walks shall follow one, and, after a colon, a
    tracker that all media shall use. `bdpt` takes all strategies, whether or not a pilot finds them worth their time."""
    walks, _, tracker = method.partition(":")
    walks, _, guide = walks.partition("+")
    integrator, _, strategies = walks.partition("/")
    usual = tyndall.ALL_STRATEGIES if integrator == "bdpt" else None
    return {"integrator": integrator, "strategies": strategies or usual, "tracker": tracker or None, "guide": "always" if guide else None}


def candidate_renderer(scene: Scene, method: str, size: Size = None, threads: int | None = None) -> Renderer:
    """One of Tyndall's methods, or `mitsuba`: Mitsuba itself with other seeds, to test the test."""
    if method != "mitsuba":
        return tyndall_renderer(scene, method, size, threads)
    return other_seeds(mitsuba_renderer(scene, size=size))


def other_seeds(renderer: Renderer) -> Renderer:
    """The same renderer as if it were another one."""
    return lambda effort: renderer(replace(effort, seed=effort.seed + 500))


def judge(scene: str, method: str, ours: Measured, theirs: Measured, seconds: float) -> Verdict:
    """The test itself."""
    z = standard_score(ours.pixels, theirs.pixels)
    tiles = standard_score(ours.tiles, theirs.tiles)
    score = standard_score(ours.whole, theirs.whole)
    channel = int(np.abs(score).argmax())
    y, x = np.unravel_index(np.abs(z).max(axis=2).argmax(), z.shape[:2])
    return Verdict(
        scene=scene,
        integrator=method,
        accepted=float((np.abs(z) <= sidak_limit(z.size)).mean()),
        tile_score=float(np.abs(tiles).max() / sidak_limit(tiles.size)),
        image_score=float(score[channel]),
        difference=relative_difference(ours.whole, theirs.whole, channel),
        resolution=IMAGE_ERRORS * float(np.hypot(ours.whole.error, theirs.whole.error).max() / theirs.whole.mean.max()),
        worst=(int(x), int(y)),
        seconds=seconds,
        map=z,
        reference=theirs.pixels.mean,
        found=ours.pixels.mean,
    )


def tiled(batches: np.ndarray, tiles: int = TILES) -> np.ndarray:
    """The batches as images of tiles x tiles means (what is left over at the right and below is dropped)."""
    count, height, width, channels = batches.shape
    tall, wide = max(1, height // tiles), max(1, width // tiles)
    rows, columns = height // tall, width // wide
    cut = batches[:, : rows * tall, : columns * wide]
    return cut.reshape(count, rows, tall, columns, wide, channels).mean(axis=(2, 4))


def relative_difference(a: Estimate, b: Estimate, channel: int) -> float:
    """By what part of b the mean of a is greater."""
    return float(a.mean[channel] / b.mean[channel] - 1) if b.mean[channel] else float(a.mean[channel])


def compare(
    scene: Scene,
    method: str,
    effort: Effort,
    reference: Renderer,
    candidate: Renderer,
    output: Path | None = None,
    expected: Sequence[str] = (),
) -> Verdict:
    """Tests a candidate against a reference; a disagreement gets harder trials, the last of which decides. One that is
    `expected`, because a side does not reach all light, gets none."""
    trials = 0
    while True:
        trials += 1
        theirs = reference(effort)
        start = time.perf_counter()
        ours = candidate(effort)
        verdict = judge(scene.name, method, ours, theirs, time.perf_counter() - start)
        if verdict.passed or expected or trials == TRIALS:
            break
        effort = effort.harder()
    if output:
        save_picture(output / f"{scene.name}-{slug(method)}.png", theirs.pixels.mean, ours.pixels.mean, z_of(verdict))
    return replace(verdict, trials=trials, expected=tuple(expected), reference_seconds=getattr(reference, "seconds", None))


def z_of(verdict: Verdict) -> np.ndarray:
    """The map of a verdict that `judge` gave."""
    return np.zeros((1, 1, 3)) if verdict.map is None else verdict.map


def slug(method: str) -> str:
    """A method as in file names."""
    return method.replace(":", "-")


def tested(scene: Scene, method: str, effort: Effort, reference: Renderer, candidate: Renderer, output: Path, expected: Sequence[str] = ()) -> Verdict | Failure:
    """Compares and prints the row: the verdict, or why there is none."""
    try:
        verdict = compare(scene, method, effort, reference, candidate, output, expected)
    except Failure as failure:
        print(f"{scene.name:{NAME_WIDTH}} {method:{METHOD_WIDTH}} CANNOT: {failure}", flush=True)
        return failure
    print(verdict.row(), flush=True)
    return verdict


def agree(found: Verdict | Failure) -> bool:
    """What cannot be rendered is a disagreement too; what one side cannot reach is none."""
    return isinstance(found, Verdict) and (found.passed or bool(found.expected))


def all_agree(tests: Iterable[Callable[[], Verdict | Failure]], claim: str) -> bool:
    """Runs tests on all processors, their renders on one thread each; true if all agree."""
    print(HEADER, flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        passed = list(pool.map(lambda test: agree(test()), tests))
    print(f"{sum(passed)} of {len(passed)} {claim}; pictures are in {OUTPUT}")
    return all(passed)


def save_picture(path: Path, reference: np.ndarray, found: np.ndarray, z: np.ndarray) -> None:
    """Mitsuba, Tyndall, and where they differ."""
    white = picture.white_of(reference)
    row = picture.side_by_side(picture.displayed(reference, white), picture.displayed(found, white), picture.diverging(z))
    picture.write_png(path, row)


def perturbed(scene: Scene, amount: float) -> Scene:
    """The scene with every extinction greater by the part `amount`; the test must notice."""

    def denser(o: dict) -> dict:
        return {**o, "scale": (1 + amount) * o.get("scale", 1)} if o["type"] in MEDIA else o

    return derived(scene, denser)
