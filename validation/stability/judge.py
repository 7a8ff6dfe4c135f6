"""The verdicts: every row against its truth, corrected for how many rows there are.

A row is tested twice, each test at half of its significance: the means of the whole image in each channel, and the means of
tiles, which see what cancels over the whole. Rows are then judged together by Holm's rule.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from tyndall.judging import tiled
from tyndall.statistics import SIGNIFICANCE, Estimate, estimate, freedom, standard_score

SLACK = 5e-5
"""Relative difference that is not what the table is about: where nearly nothing is random, the few samples that are leave
their mark on the mean and not yet on its error."""
TILES = 4
"""A side."""
NOTICED = 3
"""How many standard errors beyond the limit a difference lies that is refused almost surely (99.9 %)."""
FEW = 0.2
"""Tiles whose relative standard error is greater hold too few events for their means to be normal."""


@dataclass(frozen=True)
class Found:
    """What was found in one row."""

    expected: float
    found: float
    error: float
    """Standard error of the difference."""
    probability: float
    """That so great a difference comes by chance, for this row alone."""
    freedom: float
    not_finite: int
    """Values of all images that are NaN or infinite."""
    worst: float
    """The greatest pixel value over the expected mean, in images of one sample per pixel."""
    seconds: float

    @property
    def difference(self) -> float:
        """Relative; of a truth that is 0 the value itself."""
        return (self.found - self.expected) / self.expected if self.expected else self.found

    def resolution(self, rows: int) -> float:
        """The relative difference that is all but surely refused among so many rows; infinite where the truth is 0."""
        return self.limit(self.freedom, rows) * self.error / abs(self.expected) if self.expected else np.inf

    @staticmethod
    def limit(freedom: float, rows: int) -> float:
        """The same in standard errors."""
        each = -np.expm1(np.log1p(-SIGNIFICANCE) / rows) / 2 / 3
        return float(stats.t.isf(each / 2, freedom)) + NOTICED


def judge(batches: np.ndarray, single: np.ndarray, truth: Estimate, seconds: float, factor: float = 1) -> Found:
    """The test of one row: `batches` of images against the truth, `single` an image of one sample per pixel."""
    lost = int((~np.isfinite(batches)).sum() + (~np.isfinite(single)).sum())
    batches = factor * batches.astype(float)
    truth = Estimate(truth.mean, truth.variance + (SLACK * truth.mean) ** 2, truth.freedom)
    grey = all(np.ptp(values, axis=-1).max() == 0 for values in (batches, truth.mean) if np.isfinite(values).all())
    channels = slice(0, 1) if grey else slice(None)
    whole, whole_truth = estimate(batches.mean(axis=(1, 2))[:, channels]), pooled(truth, 1, channels)
    z = standard_score(whole, whole_truth)
    channel = int(np.nan_to_num(np.abs(z), nan=np.inf).argmax())
    tiles, tiles_truth = estimate(tiled(batches, TILES)[..., channels]), pooled(truth, TILES, channels)
    # A tile that nothing fell into tells no error of its own: it has the average tile's at least.
    tiles = Estimate(tiles.mean, np.maximum(tiles.variance, TILES**2 * whole.variance), tiles.freedom)
    z_tiles = standard_score(tiles, tiles_truth)
    normal = ~(tiles.error > FEW * np.abs(whole_truth.mean))
    expected = float(whole_truth.mean[channel])
    mean = truth.mean.mean(axis=(0, 1))
    worst = np.nanmax(np.where(np.isfinite(single), single, np.nan) / np.where(mean, mean, 1), initial=0)
    return Found(
        expected=expected,
        found=float(whole.mean[channel]),
        error=float(np.hypot(whole.error, whole_truth.error)[channel]),
        probability=0.0 if lost else min(1, 2 * min(chance(z), chance(z_tiles[normal]))),
        freedom=float(freedom(whole, whole_truth)[channel]),
        not_finite=lost,
        worst=float(worst),
        seconds=seconds,
    )


def pooled(truth: Estimate, tiles: int, channels: slice) -> Estimate:
    """The truth as means of tiles a side. Its pixels' errors are independent if it was rendered and one if it was not: the
    greater of the two is taken."""
    mean, variance = (tiled(values[None], tiles)[0][..., channels] for values in (truth.mean, truth.variance))
    whole = Estimate(mean, variance, truth.freedom)
    return Estimate(whole.mean[0, 0], whole.variance[0, 0], whole.freedom) if tiles == 1 else whole


def chance(z: np.ndarray) -> float:
    """That the greatest of so many independent normal scores is as great as this."""
    if z.size == 0:
        return 1.0
    if np.isnan(z).any():
        return 0.0
    each = 2 * stats.norm.sf(np.abs(z).max())
    return float(-np.expm1(z.size * np.log1p(-each))) if each < 1 else 1.0


def refused(probabilities: list[float], significance: float = SIGNIFICANCE) -> list[bool]:
    """Which rows differ, by Holm's rule: the chance of any wrong refusal is `significance`."""
    verdicts = [False] * len(probabilities)
    for rank, index in enumerate(sorted(range(len(probabilities)), key=probabilities.__getitem__)):
        if probabilities[index] > -np.expm1(np.log1p(-significance) / (len(probabilities) - rank)):
            break
        verdicts[index] = True
    return verdicts
