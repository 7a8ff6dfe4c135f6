"""Whether intervals and noise are honest: what is made of studies and renders, and verdicts."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from validation import intervals
from validation.intervals import Coverage, Effort, Noise, coverage
from validation.places import CROSSCHECK


@pytest.mark.parametrize(("hits", "verdict"), [(190, "holds"), (184, "holds"), (182, "short"), (165, "FAILS"), (200, "long")])
def test_verdicts_on_coverage(hits: int, verdict: str) -> None:
    assert Coverage("a", "b", "relMSE", 1.0, hits, 200).verdict == verdict


def test_intervals_that_hold_the_truth_are_counted() -> None:
    told = [{"low": 0.0, "high": 1.0}, {"low": 1.1, "high": 2.0}, {"low": 1.0, "high": 1.0}]
    assert coverage("a", "b", "relMSE", told, 1.0).hits == 2


def test_noise_that_is_half_the_spread_fails() -> None:
    def of(printed: float) -> Noise:
        return Noise("a", 1, 2, printed, 1.0, 1.0, 1.0, 0)

    assert of(1.2).holds and of(0.81).holds and not of(0.5).holds and not of(1.3).holds


def test_variance_is_relative_to_the_reference_and_its_mean() -> None:
    images = np.array([[[1.0, 5.0]], [[3.0, 5.0]]])
    assert intervals.relative_variance(images, np.array([[1.0, 3.0]])) == pytest.approx(np.array([[2 / 1.04, 0.0]]))


def test_studies_and_renders_are_judged(tmp_path: Path) -> None:
    lamp = intervals.scenes()[2]
    with ThreadPoolExecutor(2) as workers:
        found = list(intervals.covered(lamp, Effort(studies=3, seeds=2), tmp_path, workers))
        noise = intervals.noise(CROSSCHECK / "vacuum_room.json", 4, 3, tmp_path, workers)
    assert [(one.contender, one.what) for one in found] == [
        ("hit", "difference"), ("hit", "relMSE"), ("bdpt", "difference"), ("bdpt", "relMSE"), ("bdpt", "ratio"),
    ]  # fmt: skip
    by_study = found[3]
    assert by_study.count == 3 and 0 < by_study.truth < 0.1
    assert found[4].truth > 10, "walks that run into a lamp by chance are noisier"
    assert 0.5 < noise.ratio < 2 and noise.trimmed < noise.spread
