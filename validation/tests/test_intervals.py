"""Intervals against scipy's, against closed forms, and against how often they hold."""

import numpy as np
import pytest
from scipy import stats

from validation.study import intervals
from validation.study.outcome import Interval


def test_the_interval_of_a_mean_is_scipys() -> None:
    values = np.random.default_rng(2).gamma(2, size=9)
    found = intervals.of_mean(values, 0.9)
    truth = stats.ttest_1samp(values, 0).confidence_interval(0.9)
    assert (found.mean, found.low, found.high) == pytest.approx((values.mean(), truth.low, truth.high))


def test_intervals_hold_as_often_as_they_say() -> None:
    random, trials = np.random.default_rng(3), 4000
    found = [intervals.of_mean(random.normal(5, 2, 8)) for _ in range(trials)]
    held = sum(one.low <= 5 <= one.high for one in found)
    assert stats.binomtest(held, trials, 0.95).pvalue > 1e-4


def test_the_interval_of_a_positive_mean_is_of_its_logarithm() -> None:
    values = np.array([1.0, 2, 3, 4])  # mean 2.5, standard error sqrt(5/12); t for 95 % and 3 degrees of freedom 3.1824
    found = intervals.of_positive(values)
    factor = np.exp(3.1824 * np.sqrt(5 / 12) / 2.5)
    assert (found.mean, found.low, found.high) == pytest.approx((2.5, 2.5 / factor, 2.5 * factor), rel=1e-4)
    assert intervals.of_positive(np.zeros(4)) == Interval(0, 0, 0)
    wild = intervals.of_positive(np.array([0, 0, 0, 1e9]))
    assert 0 < wild.low < wild.mean < wild.high


def test_efficiency_is_one_over_mean_error_times_mean_time() -> None:
    found = intervals.of_efficiency(np.stack([np.full(8, 0.02), np.full(8, 5.0)]))
    assert (found.mean, found.low, found.high) == pytest.approx((10, 10, 10))
    # A seed with much error that took long counts once, not as the mean of products.
    spread = intervals.of_efficiency(np.array([[0.01, 0.03, 0.01, 0.03], [4.0, 6, 4, 6]]))
    assert spread.mean == pytest.approx(1 / (0.02 * 5)) and 0 < spread.low < spread.mean < spread.high


def test_efficiency_without_error_is_not_finite() -> None:
    assert not np.isfinite(intervals.of_efficiency(np.stack([np.zeros(8), np.ones(8)])).mean)


@pytest.mark.parametrize("power", [-1.0, -0.5, 0.0])
def test_the_slope_of_a_power_law_is_its_power(power: float) -> None:
    seconds = np.array([[1.0, 2, 4, 8], [0.5, 1.1, 1.9, 4]])
    found = intervals.of_slope(np.array([[3.0], [7.0]]) * seconds**power, seconds)
    assert found and (found.mean, found.low, found.high) == pytest.approx((power, power, power))


def test_one_time_has_no_slope() -> None:
    seconds = np.array([[1.0, 2, 4], [0.1, 0.1, 0.1]])  # whose mean is not exactly any of them
    assert intervals.of_slope(1 / np.array([[1.0, 2, 4], [1, 2, 4]]), seconds) is None


def test_two_points_have_no_slope() -> None:
    assert intervals.of_slope(np.ones((8, 2)), np.ones((8, 2))) is None


def test_a_bootstrap_of_a_mean_is_as_wide_as_its_error() -> None:
    values = np.arange(100.0)
    found = intervals.bootstrap(100, lambda picks: values[picks].mean(axis=-1))
    error = stats.sem(values) / values.mean()
    assert found.mean == 49.5
    assert np.log(found.high / found.mean) == pytest.approx(stats.t.ppf(0.975, 99) * error, rel=0.05)
    assert intervals.bootstrap(100, lambda picks: values[picks].mean(axis=-1)) == found


def test_ratios_are_paired() -> None:
    own = np.random.default_rng(5).gamma(3, size=(2, 8))
    found = intervals.of_ratio(own * np.array([[3.0], [2.0]]), own)
    assert (found.mean, found.low, found.high) == pytest.approx((6, 6, 6))


def test_the_ratio_holds_as_often_as_it_says() -> None:
    random, trials = np.random.default_rng(6), 300
    held = 0
    for _ in range(trials):
        errors = random.normal(5, 0.5, (2, 8))
        found = intervals.of_ratio(np.stack([2 * errors[0], np.ones(8)]), np.stack([errors[1], np.ones(8)]))
        held += found.low <= 2 <= found.high
    assert stats.binomtest(held, trials, 0.95).pvalue > 1e-4


def test_what_is_not_finite_stays_so() -> None:
    found = intervals.of_ratio(np.array([[1.0, np.nan], [1, 1]]), np.ones((2, 2)))
    assert np.isnan([found.mean, found.low, found.high]).all()
