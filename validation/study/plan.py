"""How much each contender renders: pilots tell how fast it is, the time there is tells the rest."""

import math
from dataclasses import dataclass

from validation.errors import FLOOR
from validation.study.rivals import Rival

PILOT_SEED = 20_001
REFERENCE_SEED = 10_001
FIRST_SEED = 1
"""Pilots, the reference and the contenders share no random numbers. Mitsuba's seeds have 32 bits, of which each of
these takes 100 000 numbers: below 42 000."""
REFERENCE_PART, CONTENDERS_PART = 0.25, 0.65
"""Of the time there is; what is left is for starting programs and writing files."""
REFERENCE_BATCHES = 8
ROBUST = {"bdpt", "volpathmis"}
"""The last to have rare bright paths, of light that is hard to find and of colours whose extinctions differ."""


@dataclass(frozen=True)
class Pilot:
    """What a short run told."""

    rate: float
    """Samples per pixel and second."""
    cost: float
    """relMSE x seconds, roughly; infinite where an image holds what is not finite."""


def pilot(rival: Rival, seconds: float) -> Pilot:
    """Renders ever more samples until that takes about `seconds`, then as many once more."""
    spp = 1
    while True:
        image, taken = rival.render(spp, PILOT_SEED)
        taken = max(taken, 1e-4)
        if taken >= seconds / 2 or spp >= 1 << 20:
            break
        spp = max(2 * spp, round(spp * seconds / taken / 2))
    other, again = rival.render(spp, PILOT_SEED + 1)
    middle = (image + other) / 2
    relative = float(((image - other) ** 2 / 2 / (middle**2 + FLOOR)).mean())
    both = (taken + max(again, 1e-4)) / 2
    return Pilot(spp / both, relative * both if math.isfinite(relative) else math.inf)


def budgets(rate: float, top: float, points: int) -> list[int]:
    """Doubling samples per pixel of which the last take about `top` seconds; fewer where a sample takes long."""
    most = rate * top
    count = min(points, max(1, math.floor(math.log2(max(most, 1))) + 1))
    first = max(1, round(most / 2 ** (count - 1)))
    return [first << k for k in range(count)]


def top_seconds(seconds: float, contenders: int, seeds: int, points: int) -> float:
    """The time of each contender's last budget, if all renders of all seeds shall take this long together."""
    return CONTENDERS_PART * seconds / (seeds * contenders * sum(0.5**k for k in range(points)))


def best(pilots: dict[str, Pilot], prefix: str) -> str | None:
    """Who makes the reference for this renderer: one of its most robust integrators, if there is one; among equals
    whoever needs the least time for an error. A short pilot flatters whoever has rare bright paths and found none."""
    own = [name for name in pilots if name.startswith(prefix)]
    return min(own, key=lambda name: (ROBUST.isdisjoint(name.split()), pilots[name].cost), default=None)


def reference_samples(pilots: dict[str, Pilot], seconds: float) -> dict[str, int]:
    """Samples per pixel in each batch of the reference, by contender: the best of each renderer, both as long."""
    chosen = [name for name in (best(pilots, "tyndall"), best(pilots, "mitsuba")) if name]
    each = REFERENCE_PART * seconds / (REFERENCE_BATCHES * len(chosen))
    return {name: max(1, round(pilots[name].rate * each)) for name in chosen}
