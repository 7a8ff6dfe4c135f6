"""The verdicts: every row against its truth, corrected for how many rows of its kind there are.

A row is tested twice, each test at half of its significance: the means of the whole image in each channel, and the means of
tiles, which see what cancels over the whole. The rows of a kind are then judged together by Holm's rule.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from tyndall.judging import tiled
from tyndall.statistics import SIGNIFICANCE, Estimate, estimate, exact, freedom, standard_score

SLACK = 5e-5
"""Relative difference that is not what the table is about: where nearly nothing is random, the few samples that are leave
their mark on the mean and not yet on its error."""
REQUIRED = 0.1
"""The relative difference that no line may leave unseen: one that might is not decided."""
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
    relative_error: float
    """The same over what is expected, of the worst channel; 0 where all are black."""
    probability: float
    """That so great a difference comes by chance, for this row alone."""
    freedom: float
    not_finite: int
    """Values of all images that are NaN or infinite."""
    samples: int = 0
    """A pixel, in each of the independent images."""
    seconds: float = 0
    """Of processor time."""
    worst: float | None = None
    """The greatest pixel value over the expected mean, in images of one sample per pixel."""

    @property
    def difference(self) -> float:
        """Relative; of a truth that is 0 the value itself."""
        return (self.found - self.expected) / self.expected if self.expected else self.found

    def resolution(self, rows: int) -> float:
        """The relative difference that is all but surely refused among so many rows; 0 where the truth is 0: nothing may
        be found there."""
        return self.limit(self.freedom, rows) * self.relative_error

    @staticmethod
    def limit(freedom: float, rows: int) -> float:
        """The same in standard errors."""
        each = level(rows) / 2 / 3
        return float(stats.t.isf(each / 2, freedom)) + NOTICED


def judge(batches: np.ndarray, truth: np.ndarray) -> Found:
    """The test of one row: `batches` of images against those of the truth."""
    lost = int((~np.isfinite(batches)).sum())
    grey = all(np.ptp(values, axis=-1).max() == 0 for values in (batches, truth) if np.isfinite(values).all())
    channels = slice(0, 1) if grey else slice(None)
    batches, truth = batches[..., channels], truth[..., channels]
    whole, whole_truth = estimate(batches.mean(axis=(1, 2))), known(truth.mean(axis=(1, 2)))
    z = standard_score(whole, whole_truth)
    channel = int(np.nan_to_num(np.abs(z), nan=np.inf).argmax())
    tiles, tiles_truth = estimate(tiled(batches, TILES)), known(tiled(truth, TILES))
    # A tile that nothing fell into tells no error of its own: it has the average tile's at least.
    tiles = Estimate(tiles.mean, np.maximum(tiles.variance, TILES**2 * whole.variance), tiles.freedom)
    z_tiles = standard_score(tiles, tiles_truth)
    normal = ~(tiles.error > FEW * np.abs(whole_truth.mean))
    error, lit = np.hypot(whole.error, whole_truth.error), whole_truth.mean != 0
    return Found(
        expected=float(whole_truth.mean[channel]),
        found=float(whole.mean[channel]),
        error=float(error[channel]),
        relative_error=float((error[lit] / np.abs(whole_truth.mean[lit])).max(initial=0)),
        probability=0.0 if lost else min(1, 2 * min(chance(z), chance(z_tiles[normal]))),
        freedom=float(freedom(whole, whole_truth)[channel]),
        not_finite=lost,
    )


def known(truth: np.ndarray) -> Estimate:
    """The truth of a value from its batches; of one alone, without error."""
    found = estimate(truth) if len(truth) > 1 else exact(truth[0])
    return Estimate(found.mean, found.variance + (SLACK * found.mean) ** 2, found.freedom)


def worst(single: np.ndarray, truth: np.ndarray) -> float:
    """The greatest value of images of one sample per pixel over the expected mean."""
    mean = truth.mean(axis=(0, 1, 2))
    return float(np.nanmax(np.where(np.isfinite(single), single, np.nan) / np.where(mean, mean, 1), initial=0))


def chance(z: np.ndarray) -> float:
    """That the greatest of so many independent normal scores is as great as this."""
    if z.size == 0:
        return 1.0
    if np.isnan(z).any():
        return 0.0
    each = 2 * stats.norm.sf(np.abs(z).max())
    return float(-np.expm1(z.size * np.log1p(-each))) if each < 1 else 1.0


def level(rows: int, significance: float = SIGNIFICANCE) -> float:
    """The chance below which the least likely of so many rows is refused: that any is, by chance, is `significance`."""
    return float(-np.expm1(np.log1p(-significance) / rows))


def refused(probabilities: list[float], rows: int) -> list[bool]:
    """Which rows differ, by Holm's rule, if these are the known ones of so many: the others are taken to be as expected."""
    verdicts = [False] * len(probabilities)
    for rank, index in enumerate(sorted(range(len(probabilities)), key=probabilities.__getitem__)):
        if probabilities[index] > level(rows - rank):
            break
        verdicts[index] = True
    return verdicts
