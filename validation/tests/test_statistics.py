"""The tests that decide, against scipy and closed forms."""

import numpy as np
import pytest
from scipy import stats

from tyndall.statistics import Ratio, estimate, exact, sidak_limit, standard_score


def test_scores_have_the_tails_of_welchs_test() -> None:
    random = np.random.default_rng(4)
    a, b = random.normal(1, 2, (9, 20)), random.normal(0, 0.5, (5, 20))
    found = standard_score(estimate(a), estimate(b))
    truth = stats.ttest_ind(a, b, equal_var=False)
    assert 2 * stats.norm.sf(np.abs(found)) == pytest.approx(truth.pvalue, rel=1e-3)
    assert (np.sign(found) == np.sign(truth.statistic)).all()


def test_scores_against_an_exact_value_have_the_tails_of_students_test() -> None:
    a = np.random.default_rng(5).normal(1, 2, (9, 20))
    truth = stats.ttest_1samp(a, 0.8)
    found = standard_score(estimate(a), exact(np.full(20, 0.8)))
    assert 2 * stats.norm.sf(np.abs(found)) == pytest.approx(truth.pvalue, rel=1e-3)


def test_equal_values_without_variance_agree() -> None:
    assert standard_score(exact(3.0), exact(3.0)) == 0


def test_the_limit_of_many_tests_is_exceeded_as_rarely_as_it_says() -> None:
    assert 1 - stats.norm.cdf(sidak_limit(1, 0.05)) == pytest.approx(0.025)
    inside = 1 - 2 * stats.norm.sf(sidak_limit(500, 0.01))
    assert inside**500 == pytest.approx(0.99)


def test_the_interval_of_a_ratio_holds_the_truth_as_often_as_it_says() -> None:
    random = np.random.default_rng(6)
    found = [Ratio.of(*random.gamma(20, scale, (2, 6)).tolist()) for scale in np.full(500, 0.1)]
    assert 0.92 < np.mean([ratio.low < 1 < ratio.high for ratio in found]) < 0.98
    assert Ratio.of([2, 3], [1, 1]).mean == pytest.approx(2.5)


def test_the_mean_of_ratios_is_geometric_and_its_interval_narrows() -> None:
    found = Ratio.geometric([Ratio(1, 2, 4), Ratio(4, 8, 16)])
    assert (found.mean, found.high) == (pytest.approx(4), pytest.approx(4 * 2 ** (1 / 2**0.5)))
