"""Means, their uncertainty, and the tests that decide. Arrays of any shape, the batches along the first axis."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import stats

SIGNIFICANCE = 0.01
"""Probability that one whole test refuses what is right."""
ROUNDING = 1e-5
"""Relative difference that single precision may make where nothing is random."""
CONFIDENCE = 0.95
"""Of the interval of a ratio."""


@dataclass(frozen=True)
class Estimate:
    """A mean of independent batches: value, variance of that value, degrees of freedom."""

    mean: np.ndarray
    variance: np.ndarray
    freedom: float

    @property
    def error(self) -> np.ndarray:
        """The standard error."""
        return np.sqrt(self.variance)


def estimate(batches: np.ndarray) -> Estimate:
    """The mean over the first axis."""
    count = len(batches)
    return Estimate(batches.mean(axis=0), batches.var(axis=0, ddof=1) / count, count - 1)


def exact(value: npt.ArrayLike) -> Estimate:
    """A value known without error."""
    value = np.asarray(value, dtype=float)
    return Estimate(value, np.zeros_like(value), np.inf)


def standard_score(a: Estimate, b: Estimate) -> np.ndarray:
    """The normal score z with the tail probability of Welch's t: few batches make t, not z, normal."""
    rounding = (ROUNDING * np.maximum(np.abs(a.mean), np.abs(b.mean))) ** 2
    difference = a.mean - b.mean
    with np.errstate(invalid="ignore", divide="ignore"):
        t = np.where(difference == 0, 0, difference / np.sqrt(a.variance + b.variance + rounding))
    return np.sign(t) * score_of_log_tail(stats.t.logsf(np.abs(t), freedom(a, b, rounding)))


def freedom(a: Estimate, b: Estimate, rounding: np.ndarray | float = 0.0) -> np.ndarray:
    """Welch's degrees of freedom of the difference."""
    with np.errstate(invalid="ignore", divide="ignore"):
        found = (a.variance + b.variance + rounding) ** 2 / (a.variance**2 / a.freedom + b.variance**2 / b.freedom)
    return np.where(np.isfinite(found), found, 1e9)


def score_of_log_tail(log_tail: np.ndarray) -> np.ndarray:
    """The normal score whose upper tail has this (logarithmic) probability."""
    from scipy.special import ndtri_exp

    return -ndtri_exp(log_tail)


def sidak_limit(tests: int, significance: float = SIGNIFICANCE) -> float:
    """The |z| that the greatest of so many independent tests exceeds with probability `significance`."""
    each = -np.expm1(np.log1p(-significance) / tests)
    return float(stats.norm.isf(each / 2))


@dataclass(frozen=True)
class Ratio:
    """A ratio of means, and the ends of its interval."""

    low: float
    mean: float
    high: float

    @staticmethod
    def of(above: Sequence[float], below: Sequence[float]) -> "Ratio":
        """Of the means of independent numbers, by Student's t for the logarithm."""
        a, b = (np.asarray(numbers, dtype=float) for numbers in (above, below))
        spread = sum(values.var(ddof=1) / len(values) / values.mean() ** 2 for values in (a, b))
        return Ratio.within(a.mean() / b.mean(), stats.t.ppf((1 + CONFIDENCE) / 2, len(a) + len(b) - 2) * math.sqrt(spread))

    @staticmethod
    def geometric(ratios: "Sequence[Ratio]") -> "Ratio":
        """The geometric mean of independent ones."""
        off = math.sqrt(sum(math.log(ratio.high / ratio.low) ** 2 for ratio in ratios)) / 2
        return Ratio.within(math.exp(np.mean([math.log(ratio.mean) for ratio in ratios])), off / len(ratios))

    @staticmethod
    def within(mean: float, off: float) -> "Ratio":
        """A ratio whose logarithm is known up to `off`."""
        return Ratio(float(mean * math.exp(-off)), float(mean), float(mean * math.exp(off)))

    def __str__(self) -> str:
        return f"{self.mean:.3g} [{self.low:.3g}, {self.high:.3g}]"
