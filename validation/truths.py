"""The closed forms as tests: every case through every method that can render it."""

from functools import partial

from tyndall.failure import Failure
from tyndall.judging import Measured, Verdict
from validation import compare
from validation.closed_forms import furnace, glowing, point_light, slab, varying
from validation.closed_forms.case import Case
from validation.compare import Effort
from validation.places import OUTPUT


def run(effort: Effort, methods: tuple[str, ...] = (), only: str = "", quick: bool = False) -> bool:
    """Tests all cases whose name contains `only`, by the given methods or by all that apply; true if all hold. `quick`
    takes only those samples that a case grants the quick level."""
    every = (*furnace.cases(), *slab.cases(), *point_light.cases(), *varying.cases(), *glowing.cases())
    cases = [case for case in every if only in case.scene.name]
    tests = [
        partial(test, case, method, effort.times(case.effort * share))
        for case in cases
        for method in methods or case.methods
        if (share := case.quick.get(method, 1) if quick else 1)
    ]
    return compare.all_agree(tests, "images are as theory says")


def test(case: Case, method: str, effort: Effort) -> Verdict | Failure:
    """One case by one method."""
    truth = Measured.exactly(case.image())
    candidate = compare.candidate_renderer(case.scene, method, threads=1)
    return compare.tested(case.scene, method, effort, lambda _: truth, candidate, OUTPUT)
