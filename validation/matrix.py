"""Every cross-check scene through Mitsuba and through each of Tyndall's integrators that can render it."""

from collections.abc import Callable, Iterable

import numpy as np

from validation import cells, compare, coverage, references
from validation.cases import CASES, Case
from validation.compare import Effort
from validation.places import OUTPUT
from validation.scene import Scene

Batches = Callable[[Effort], np.ndarray]
"""A reference's, by effort."""


def run(effort: Effort, chosen: Iterable[cells.Cell], cell_effort: Effort, only: str = "") -> bool:
    """Compares every case and the chosen generated cells whose names contain `only`, printing as it goes; true if all
    agree and, where all were asked for, no shared plugin is in none of the scenes."""
    print(compare.HEADER, flush=True)
    passed = [one for case in CASES if only in case.scene().name for one in run_case(case, effort)]
    passed += [one for cell in chosen if only in cell.name for one in run_cell(cell, cell_effort)]
    print(f"{sum(passed)} of {len(passed)} comparisons agree; pictures are in {OUTPUT}")
    return all(passed) and (bool(only) or coverage.run())


def run_case(case: Case, effort: Effort) -> list[bool]:
    """All comparisons of one scene: which of them agree."""
    reference = own(case) if case.own else references.cached(case.truth(), variant=case.variant)
    return agreements(case.scene(), tuple(case.all_methods()), effort.times(case.effort), reference)


def own(case: Case) -> Batches:
    """Batches of Tyndall's by another method, with other seeds."""
    render = compare.candidate_renderer(case.scene(), case.own)
    return lambda effort: compare.render_batches(lambda spp, seed: render(spp, seed + 500), effort)


def run_cell(cell: cells.Cell, effort: Effort) -> list[bool]:
    """All comparisons of one generated scene."""
    return agreements(cell.scene(), cell.methods(), effort.times(cell.effort()), references.cached(cell.scene()))


def agreements(scene: Scene, methods: tuple[str, ...], effort: Effort, reference: Batches) -> list[bool]:
    """One scene by several methods."""
    return [compare.tested(scene, method, effort, reference, OUTPUT) for method in methods]
