"""The closed forms as tests: every case through every method that can render it."""

import numpy as np

from validation import compare
from validation.closed_forms import furnace, point_light, slab
from validation.closed_forms.case import Case
from validation.compare import Effort, Verdict
from validation.places import OUTPUT


def run(effort: Effort, methods: tuple[str, ...] = (), only: str = "") -> list[Verdict]:
    """Tests all cases whose name contains `only`, by the given methods or by all that apply."""
    print(compare.HEADER, flush=True)
    verdicts = []
    for case in (*furnace.cases(), *slab.cases(), *point_light.cases()):
        if only in case.scene.name:
            verdicts += [test(case, method, effort) for method in methods or case.methods]
    failed = [v for v in verdicts if not v.passed]
    print(f"{len(verdicts) - len(failed)} of {len(verdicts)} images are as theory says; pictures are in {OUTPUT}")
    return verdicts


def test(case: Case, method: str, effort: Effort) -> Verdict:
    """One case by one method."""
    scaled = Effort(effort.batches, max(1, round(effort.spp * case.effort)), effort.seed)
    truth = np.stack([case.image()] * 2)  # two equal batches: a mean without variance
    candidate = compare.candidate_renderer(case.scene, method)
    verdict = compare.compare(case.scene, method, scaled, lambda _: truth, candidate, OUTPUT)
    print(verdict.row(), flush=True)
    return verdict
