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
from tyndall.judging import HEADER, METHOD_WIDTH, NAME_WIDTH, Measured, Verdict, judge
from tyndall.scene import Scene, derived
from validation import mitsuba, picture
from validation.places import OUTPUT

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


Renderer = Callable[[Effort], Measured]
"""One scene by one program and method."""


def mitsuba_renderer(scene: Scene, variant: str = "scalar_rgb", size: Size = None) -> Renderer:
    """Mitsuba on this scene."""

    def measured(effort: Effort) -> Measured:
        with mitsuba.ALONE:
            loaded = mitsuba.load(scene, variant, size)
            return Measured.of(np.stack([mitsuba.image(loaded, effort.spp, effort.seed + i) for i in range(effort.batches)]))

    return measured


def tyndall_renderer(scene: Scene, method: str, size: Size = None, threads: int | None = None) -> Renderer:
    """Tyndall on this scene."""
    # Evenly spread samples leave so little noise that the test would measure Mitsuba's own approximations, such as
    # filters in tables, and how independent the batches of its even samplers are.
    # Where only film positions vary, shared samples would make the errors of all pixels one: no share of them can be judged.
    options = {**options_of(method), "size": size, "sampler": "independent", "film_samples": "own", "threads": threads}
    render = lambda effort: tyndall.render_batches(scene, effort.batches, spp=effort.spp, seed=effort.seed, **options)
    return lambda effort: Measured.of(render(effort))


def options_of(method: str) -> dict[str, Any]:
    """A method's options. It is an integrator, then strategies after a slash, any of `CHOICES` after a plus each, and a tracker
    for all media after a colon. `bdpt` takes all strategies, whether or not a pilot finds them worth their time."""
    walks, _, tracker = method.partition(":")
    walks, *choices = walks.split("+")
    integrator, _, strategies = walks.partition("/")
    usual = tyndall.ALL_STRATEGIES if integrator == "bdpt" else None
    options: dict[str, Any] = {"integrator": integrator, "strategies": strategies or usual, "tracker": tracker or None}
    return options | {name: value for choice in choices for name, value in CHOICES[choice].items()}


CHOICES: dict[str, dict[str, Any]] = {
    "guide": {"guide": "always"},
    "aimed": {"starts": "aimed"},
    "learnt": {"starts": "learnt"},
    "sky": {"sky": "hit"},
    "pilot": {"strategies": None},
}
"""Of how paths are sampled: walks that follow a guide, light subpaths that start at targets or where it pays, a sky that is only hit, and all
that a pilot of `bdpt` finds worth its time."""


def candidate_renderer(scene: Scene, method: str, size: Size = None, threads: int | None = None) -> Renderer:
    """One of Tyndall's methods, or `mitsuba`: Mitsuba itself with other seeds, to test the test."""
    if method != "mitsuba":
        return tyndall_renderer(scene, method, size, threads)
    return other_seeds(mitsuba_renderer(scene, size=size))


def other_seeds(renderer: Renderer) -> Renderer:
    """The same renderer as if it were another one."""
    return lambda effort: renderer(replace(effort, seed=effort.seed + 500))


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
