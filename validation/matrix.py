"""Every cross-check scene through Mitsuba and through each of Tyndall's integrators that can render it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial

from tyndall.failure import Failure
from tyndall.judging import Verdict
from tyndall.scene import Scene
from validation import cells, compare, coverage, references
from validation.cases import CASES, Case
from validation.compare import Effort, Renderer
from validation.places import OUTPUT, RECORDED

DEEP = Effort(batches=16, spp=80, seed=5001)
DEEP_CELLS = 120
"""Generated scenes that the deep matrix takes, out of nearly two thousand."""
RECORDED_EFFORT = Effort(batches=16, spp=192)
"""Of Mitsuba's images in the repository, times the scene's own factor."""


def quick_effort(method: str) -> Effort:
    """With Mitsuba's recorded images, 30 samples resolve more than 48 of both renderers: 1/30 + 1/192 < 1/48 + 1/48. Light
    tracing, which has the most noise, takes 40."""
    return Effort(batches=16, spp=40 if method.startswith("lt") else 30)


@dataclass(frozen=True)
class Job:
    """A scene, who is to render it, with how many samples relative to the common number, and what Mitsuba renders."""

    scene: Scene
    methods: tuple[str, ...]
    effort: float
    truth: Scene
    variant: str = "scalar_rgb"
    own: str = ""
    """A method of Tyndall's that stands in for Mitsuba."""

    def reference(self, recorded: bool) -> Renderer:
        """Mitsuba's image as the repository keeps it, or rendered now (unless it is kept under target/)."""
        if self.own:
            return compare.other_seeds(compare.tyndall_renderer(self.truth, self.own))
        if recorded:
            return references.recorded(self.truth, RECORDED_EFFORT.times(self.effort), self.variant)
        return references.cached(self.truth, variant=self.variant)


def of_case(case: Case, deep: bool = False) -> Job:
    """A cross-check scene; `deep`, by every method with every tracker."""
    return Job(case.scene(), tuple(case.all_methods(deep)), case.effort, case.truth(), case.variant, case.own)


def of_cell(cell: cells.Cell) -> Job:
    """A generated scene."""
    return Job(cell.scene(), cell.methods(), cell.effort(), cell.scene())


def fixed(seed: int = cells.SEED) -> list[Job]:
    """What every test run compares: all cross-check scenes and a sample of the generated ones."""
    return [*map(of_case, CASES), *map(of_cell, cells.sample(seed=seed))]


def quick(only: str = "", seed: int = cells.SEED, *, guide: bool = False) -> bool:
    """The fixed sample against Mitsuba's images in the repository, or the same by guided walks; no shared plugin may be in none of
    its scenes."""
    recorded = seed == cells.SEED
    effort = quick_effort if recorded else lambda _: DEEP
    jobs = fixed(seed)
    if guide:
        jobs = [replace(job, methods=tuple(f"{method}+guide" for method in job.methods if ":" not in method)) for job in jobs]
    return run(jobs, effort, only, recorded) and (bool(only) or coverage.run())


def live(only: str = "", count: int | None = None) -> bool:
    """All cross-check scenes and `count` of the generated ones, or all, against Mitsuba as it renders now, and so its images
    in the repository."""
    chosen = cells.cells() if count is None else cells.sample(count)
    deep = [of_case(case, deep=True) for case in CASES]
    return all([run([*deep, *map(of_cell, chosen)], lambda _: DEEP, only), still_recorded(only)])


def run(jobs: Iterable[Job], effort: Callable[[str], Effort], only: str = "", recorded: bool = False) -> bool:
    """Compares every scene whose name contains `only` by every method, with a method's `effort`; true if all agree."""
    tests = [partial(test, job, method, effort(method), recorded) for job in jobs if only in job.scene.name for method in job.methods]
    return compare.all_agree(tests, "comparisons agree")


def test(job: Job, method: str, effort: Effort, recorded: bool) -> Verdict | Failure:
    """One scene by one method."""
    candidate = compare.candidate_renderer(job.scene, method, threads=1)
    return compare.tested(job.scene, method, effort.times(job.effort), job.reference(recorded), candidate, OUTPUT)


def still_recorded(only: str = "") -> bool:
    """Mitsuba's images in the repository against new ones."""
    jobs = [job for job in fixed() if only in job.scene.name and not job.own]
    test = lambda job: compare.tested(job.truth, "recorded", DEEP.times(job.effort), job.reference(False), job.reference(True), OUTPUT)
    return compare.all_agree([partial(test, job) for job in jobs], "recorded images are those of new ones")


def record(only: str = "") -> bool:
    """Renders Mitsuba's images of the fixed sample again; those that no scene has any more go."""
    jobs = {job.truth.name: job for job in fixed() if not job.own}
    for path in RECORDED.glob("*.npz"):
        if path.stem not in jobs:
            path.unlink()
    for name, job in jobs.items():
        if only in name:
            references.record(job.truth, RECORDED_EFFORT.times(job.effort), job.variant)
            print(name, flush=True)
    return True
