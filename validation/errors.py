"""Error measures of renderings: relMSE = mean((x - ref)^2 / (ref^2 + 0.01)), and what it costs."""

from dataclasses import dataclass

import numpy as np

from validation.statistics import Estimate

FLOOR = 0.01
"""Keeps black pixels from deciding everything."""
TRIM = 0.001
"""The part of the values, the worst, that the trimmed measure leaves out: it shows what fireflies do."""


@dataclass(frozen=True)
class Errors:
    """relMSE and trimmed relMSE of each of several renders of one method."""

    whole: np.ndarray
    trimmed: np.ndarray


def against_reference(images: np.ndarray, reference: Estimate) -> Errors:
    """The errors against a reference, less what the reference's own error adds on average."""
    squared = (images - reference.mean) ** 2 - reference.variance
    return measured(squared, reference.mean)


def among_themselves(images: np.ndarray, reference: np.ndarray) -> Errors:
    """The errors of unbiased renders, each against the mean of the others; the reference only scales."""
    count = len(images)
    others = (images.sum(axis=0) - images) / (count - 1)
    return measured((images - others) ** 2 * (count - 1) / count, reference)


def measured(squared: np.ndarray, reference: np.ndarray) -> Errors:
    """Both measures from squared errors, (renders, height, width, channels)."""
    relative = (squared / (reference**2 + FLOOR)).reshape(len(squared), -1)
    kept = relative.shape[1] - int(TRIM * relative.shape[1])
    return Errors(relative.mean(axis=1), np.partition(relative, kept - 1, axis=1)[:, :kept].mean(axis=1))


def own_error(reference: Estimate) -> float:
    """The relMSE that the reference itself has."""
    return float((reference.variance / (reference.mean**2 + FLOOR)).mean())
