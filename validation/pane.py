"""LW96 fig. 6: light that reaches a dusty interior only through frosted glass. What is joining both ends worth?

The reference is a long run of `bdpt`, its own error told and taken off. A path tracer that finds almost no light is
nearly black, and then its relMSE says less than its variance would: the ratio is a lower bound.
"""

from validation import race
from validation.contenders import contenders
from validation.errors import FLOOR
from validation.places import OUTPUT
from validation.race import Runs
from validation.scene import Scene
from validation.statistics import Estimate, bootstrap_median, estimate

CLAIM = 100
REFERENCE_TIMES = 8
"""The reference's time in rounds' times, for each of its batches."""
REFERENCE_BATCHES = 8


def run(scene: Scene, rounds: int, seconds: float, threads: int) -> bool:
    """Prints the table; true if bdpt is at least CLAIM times as efficient as pt."""
    both = contenders(scene, ("bdpt", "pt"), threads)
    [long_run] = race.take_turns(both[:1], REFERENCE_BATCHES, REFERENCE_TIMES * seconds, first_seed=10_001)
    reference = estimate(long_run.images)
    all_runs = race.take_turns(both, rounds, seconds)
    bdpt, pt = race.report(scene.name, all_runs, reference, OUTPUT / "pane")
    ratio, low, high = bootstrap_median(pt.cost / bdpt.cost)
    print(f"bdpt against pt, relMSE in equal time: x{ratio:.0f} [{low:.0f}, {high:.0f}]; claimed: at least x{CLAIM}")
    print(f"pt shows {100 * shown(all_runs[1], reference):.1f} % of the light that there is")
    return low >= CLAIM


def shown(runs: Runs, reference: Estimate) -> float:
    """The part of the reference's light that the renders show on average, pixels weighted as in relMSE."""
    weight = reference.mean / (reference.mean**2 + FLOOR)
    return float((runs.images.mean(axis=0) * weight).sum() / (reference.mean * weight).sum())
