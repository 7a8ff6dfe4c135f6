"""Error measures against sums done by hand."""

import numpy as np
import pytest

from validation.failure import Failure
from validation.study.measures import measures, trimmed


def test_measures_are_those_of_their_formulas() -> None:
    reference = np.array([[[1.0, 0.0, 2.0]]])
    image = np.array([[[1.5, 0.1, 1.0]]])
    found = measures(image, reference)
    assert found.mse == pytest.approx((0.25 + 0.01 + 1) / 3)
    assert found.relmse == pytest.approx((0.25 / 1.01 + 0.01 / 0.01 + 1 / 4.01) / 3)
    assert found.mape == pytest.approx((0.5 / 1.01 + 0.1 / 0.01 + 1 / 2.01) / 3)
    assert found.smape == pytest.approx((1 / 2.51 + 0.2 / 0.11 + 2 / 3.01) / 3)
    assert found.difference == pytest.approx(2.6 / 3 - 1)


def test_an_image_has_no_error_against_itself() -> None:
    image = np.random.default_rng(1).uniform(0, 9, (4, 5, 3))
    assert set(vars(measures(image, image)).values()) == {0.0}


def test_the_worst_of_a_thousand_values_is_trimmed_and_no_other() -> None:
    values = np.ones(1000)
    values[17] = 1e6
    assert trimmed(values) == 1
    values[18] = 2
    assert trimmed(values) == pytest.approx(1 + 1 / 999)
    assert trimmed(np.array([1.0, 3.0])) == 2  # a part of a value cannot be left out


def test_what_is_no_number_makes_the_measures_none() -> None:
    image = np.ones((2, 2, 3))
    broken = image.copy()
    broken[0, 1, 2] = np.nan
    assert np.isnan(measures(broken, image).relmse)


def test_what_cannot_be_measured_is_refused() -> None:
    with pytest.raises(Failure, match="shape"):
        measures(np.ones((2, 2, 3)), np.ones((2, 3, 3)))
    with pytest.raises(Failure, match="black"):
        measures(np.ones((2, 2, 3)), np.zeros((2, 2, 3)))
