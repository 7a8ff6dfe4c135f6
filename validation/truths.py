"""The closed forms as tests: every case through every method that can render it."""

from validation import compare
from validation.closed_forms import furnace, glowing, point_light, slab, varying
from validation.closed_forms.case import Case
from validation.compare import Effort, Measured
from validation.places import OUTPUT


def run(effort: Effort, methods: tuple[str, ...] = (), only: str = "") -> bool:
    """Tests all cases whose name contains `only`, by the given methods or by all that apply; true if all hold."""
    print(compare.HEADER, flush=True)
    every = (*furnace.cases(), *slab.cases(), *point_light.cases(), *varying.cases(), *glowing.cases())
    cases = [case for case in every if only in case.scene.name]
    passed = [test(case, method, effort) for case in cases for method in methods or case.methods]
    print(f"{sum(passed)} of {len(passed)} images are as theory says; pictures are in {OUTPUT}")
    return all(passed)


def test(case: Case, method: str, effort: Effort) -> bool:
    """One case by one method."""
    scaled = Effort(effort.batches, max(1, round(effort.spp * case.effort)), effort.seed)
    truth = Measured.exactly(case.image())
    candidate = compare.candidate_renderer(case.scene, method)
    return compare.agree(compare.tested(case.scene, method, scaled, lambda _: truth, candidate, OUTPUT))
