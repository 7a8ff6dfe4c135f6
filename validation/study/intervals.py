"""Confidence intervals over seeds, made as `src/study/interval.rs` makes them: what can be negative gets Student's t, what
is positive gets it for the logarithm of its mean, which stays the estimate."""

import math
from collections.abc import Callable

import numpy as np
from scipy import stats

from validation.study.outcome import Interval

CONFIDENCE = 0.95
DRAWS = 4000
"""Resamples of a bootstrap."""


def student(count: int, confidence: float = CONFIDENCE) -> float:
    """How many standard errors the ends of a t-interval lie from the mean of so many values."""
    return float(stats.t.ppf((1 + confidence) / 2, count - 1))


def of_mean(values: np.ndarray, confidence: float = CONFIDENCE) -> Interval:
    """The t-interval of the mean of independent values."""
    values = np.asarray(values, dtype=np.float64)
    half = student(len(values), confidence) * values.std(ddof=1) / math.sqrt(len(values))
    return Interval(float(values.mean()), float(values.mean() - half), float(values.mean() + half))


def of_positive(values: np.ndarray, confidence: float = CONFIDENCE) -> Interval:
    """Of the mean of values that are not negative: the t-interval of its logarithm, so that no end is negative."""
    values = np.asarray(values, dtype=np.float64)
    mean = float(values.mean())
    if mean == 0:
        return Interval(mean, mean, mean)
    half = student(len(values), confidence) * values.std(ddof=1) / math.sqrt(len(values)) / mean
    with np.errstate(over="ignore"):
        return Interval(mean, float(mean * np.exp(-half)), float(mean * np.exp(half)))


def of_efficiency(done: np.ndarray, confidence: float = CONFIDENCE) -> Interval:
    """1 / (mean relMSE x mean seconds) of errors and seconds, (2, seeds). What has no error has no finite one."""
    return bootstrap(done.shape[1], lambda picks: 1 / cost(done, picks), confidence)


def bootstrap(count: int, estimate: Callable[[np.ndarray], np.ndarray], confidence: float = CONFIDENCE) -> Interval:
    """Of a positive number that `estimate` makes of seeds: of indices (..., count) it reduces the last axis. Student's t for
    its logarithm, whose error is found by drawing seeds anew; plain percentiles of few seeds are too narrow. The same
    seeds give the same interval."""
    picks = np.random.default_rng(0).integers(count, size=(DRAWS, count))
    with np.errstate(all="ignore"):  # of infinite or missing errors everything is NaN, which is told as such
        mean, draws = float(estimate(np.arange(count))), np.log(estimate(picks))
        # The draws vary as n - 1 of n values do.
        half = student(count, confidence) * draws.std(ddof=1) * math.sqrt(count / (count - 1))
        return Interval(mean, float(mean * np.exp(-half)), float(mean * np.exp(half)))


def of_ratio(first: np.ndarray, own: np.ndarray, confidence: float = CONFIDENCE) -> Interval:
    """How many times the first one's efficiency the own one is. Both are errors and seconds, (2, seeds), of the same seeds:
    what a seed or the state of the machine does to both cancels."""

    def ratio(picks: np.ndarray) -> np.ndarray:
        return cost(first, picks) / cost(own, picks)

    return bootstrap(own.shape[1], ratio, confidence)


def cost(done: np.ndarray, picks: np.ndarray) -> np.ndarray:
    """Mean error times mean seconds of the seeds that `picks` names."""
    return done[0][picks].mean(axis=-1) * done[1][picks].mean(axis=-1)


def of_slope(relmse: np.ndarray, seconds: np.ndarray, confidence: float = CONFIDENCE) -> Interval | None:
    """Of log relMSE over log seconds, arrays (seeds, budgets): a line is fitted to each seed's own renders, which are
    independent; none from fewer than three budgets, where an error is 0 or none, or
    where times do not differ."""
    if relmse.shape[1] < 3 or not (np.isfinite(relmse) & (relmse > 0)).all():
        return None
    x, y = np.log(seconds), np.log(relmse)
    if (x == x[:, :1]).all(axis=1).any():
        return None
    x = x - x.mean(axis=1, keepdims=True)
    return of_mean((x * y).sum(axis=1) / (x**2).sum(axis=1), confidence)
