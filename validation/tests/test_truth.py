"""The reference: pooled by precision, mistrusted where its halves disagree, its own error told rightly."""

from pathlib import Path

import numpy as np
import pytest

from validation import exr
from validation.failure import Failure
from validation.statistics import Estimate
from validation.study import truth
from validation.study.measures import measures

RANDOM = np.random.default_rng(11)
TRUTH = RANDOM.uniform(0.2, 2, (6, 8, 3))


def noisy(spread: float, scale: float = 1.0) -> np.ndarray:
    """Batches around the truth."""
    return TRUTH * scale + RANDOM.normal(0, spread, (8, *TRUTH.shape))


def test_the_precise_half_counts_more() -> None:
    parts = [Estimate(np.full((2, 2, 3), value), np.full((2, 2, 3), variance), 7) for value, variance in ((1.0, 0.01), (2.0, 0.04))]
    found = truth.weighted(parts)
    relative = np.array([1.01 / 0.01, 4.01 / 0.04])  # precision as relMSE sees it
    weights = relative / relative.sum()
    assert found.mean == pytest.approx(weights @ [1, 2])
    assert found.variance == pytest.approx(weights**2 @ [0.01, 0.04])


def test_its_own_error_is_what_it_has_against_the_truth() -> None:
    told, had = [], []
    for _ in range(200):
        found = truth.pooled({"a": noisy(0.1), "b": noisy(0.3)}, {"a": 4, "b": 2})
        assert found.own_relmse is not None and not found.warning
        told.append(found.own_relmse)
        had.append(measures(found.image, TRUTH).relmse)
    assert np.mean(told) == pytest.approx(np.mean(had), rel=0.05)
    better = (0.1**2 / 8 / (TRUTH**2 + 0.01)).mean()
    assert np.mean(had) == pytest.approx(better / (1 + 1 / 9), rel=0.1)  # than the better half: by the worse one's precision


def test_halves_that_disagree_are_not_mixed() -> None:
    dark, bright = noisy(0.01, 0.9), noisy(0.3)
    found = truth.pooled({"dark": dark, "bright": bright}, {"dark": 1, "bright": 1})
    assert (found.image == bright.mean(axis=0)).all()
    assert "standard errors apart" in found.warning and "bright alone" in found.how


def test_what_is_not_finite_takes_no_part() -> None:
    good, broken = noisy(0.1), noisy(0.1)
    broken[1, 2, 3, 0] = np.inf
    found = truth.pooled({"good": good, "broken": broken}, {"good": 1, "broken": 1})
    assert (found.image == good.mean(axis=0)).all() and "broken took no part" in found.warning
    with pytest.raises(Failure, match="by broken holds NaN"):
        truth.pooled({"broken": broken}, {"broken": 1})


def test_references_that_do_not_serve_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    with_nan, infinite = TRUTH.copy(), TRUTH.copy()
    with_nan[1, 2, 0], infinite[3, 4, 1] = np.nan, np.inf
    for image, complaint in ((with_nan, "NaN"), (infinite, "NaN"), (0 * TRUTH, "black")):
        exr.write_image(path, image)
        with pytest.raises(Failure, match=complaint):
            truth.given(path)
    np.savez(tmp_path / "b.npz", mean=TRUTH, se=np.full(TRUTH.shape, np.nan))
    np.savez(tmp_path / "flat.npz", mean=TRUTH[0], se=TRUTH[0])
    (tmp_path / "c.npz").write_text("no archive")
    for name, complaint in (("b.npz", "NaN"), ("flat.npz", "no image"), ("c.npz", "c.npz")):
        with pytest.raises(Failure, match=complaint):
            truth.given(tmp_path / name)


def test_references_are_read_from_files(tmp_path: Path) -> None:
    exr.write_image(tmp_path / "a.exr", TRUTH)
    np.savez(tmp_path / "b.npz", mean=TRUTH, se=np.full(TRUTH.shape, 0.1))
    np.savez(tmp_path / "c.npz", image=TRUTH)
    image = truth.given(tmp_path / "a.exr")
    assert image.image == pytest.approx(TRUTH) and image.own_relmse is None
    known = truth.given(tmp_path / "b.npz")
    assert known.own_relmse == pytest.approx((0.01 / (TRUTH**2 + 0.01)).mean())
    with pytest.raises(Failure, match="mean"):
        truth.given(tmp_path / "c.npz")
    with pytest.raises(Failure, match="no such reference"):
        truth.given(tmp_path / "d.exr")
