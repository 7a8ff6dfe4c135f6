"""Measures of an image's error against a reference, as `src/study/outcome.rs` defines them: all channels alike, and
what the reference's own error adds is left in (it is told beside them)."""

import math
from dataclasses import dataclass, fields

import numpy as np

from validation.errors import FLOOR, TRIM
from validation.failure import Failure


@dataclass(frozen=True)
class Measures:
    """All of one image."""

    mse: float
    """Mean squared error [radiance^2]."""
    relmse: float
    """mean((x - r)^2 / (r^2 + 0.01))."""
    trimmed_relmse: float
    """The same without the worst 0.1 % of values."""
    mape: float
    """mean(|x - r| / (|r| + 0.01))."""
    smape: float
    """mean(2 |x - r| / (|x| + |r| + 0.01))."""
    difference: float
    """Mean of the image over that of the reference, less 1."""


NAMES = tuple(field.name for field in fields(Measures))


def measures(image: np.ndarray, reference: np.ndarray) -> Measures:
    """Of an image of the reference's shape; of one that holds a value that is not finite every measure is NaN."""
    if image.shape != reference.shape:
        problem = f"an image of shape {image.shape} cannot be held against a reference of shape {reference.shape}"
        raise Failure(problem, "give a reference of the size at which the scene is rendered")
    x, r = np.asarray(image, dtype=np.float64).ravel(), np.asarray(reference, dtype=np.float64).ravel()
    if not r.any():
        raise Failure("the reference is black: no error can be relative to it", "light the scene")
    if not np.isfinite(x).all():
        return Measures(*[math.nan] * len(NAMES))
    off, squared = np.abs(x - r), (x - r) ** 2
    relative = squared / (r**2 + FLOOR)
    return Measures(
        mse=float(squared.mean()),
        relmse=float(relative.mean()),
        trimmed_relmse=trimmed(relative),
        mape=float((off / (np.abs(r) + FLOOR)).mean()),
        smape=float((2 * off / (np.abs(x) + np.abs(r) + FLOOR)).mean()),
        difference=float(x.mean() / r.mean() - 1),
    )


def trimmed(values: np.ndarray) -> float:
    """The mean without the greatest 0.1 % (of fewer than a thousand values none is left out)."""
    kept = len(values) - int(TRIM * len(values))
    return float(np.partition(values, kept - 1)[:kept].mean())
