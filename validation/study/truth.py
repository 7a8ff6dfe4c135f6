"""The image that errors are measured against: given, or pooled from long renders of both renderers."""

import math
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from validation import exr
from validation.errors import own_error
from validation.failure import Failure
from validation.race import read_reference
from validation.statistics import Estimate, estimate, standard_score

APART = 4.0
"""How many standard errors the halves' image means may be apart before one is mistrusted."""


@dataclass(frozen=True)
class Truth:
    """A reference."""

    image: np.ndarray
    how: str
    own_relmse: float | None
    """None if nobody knows."""
    warning: str = ""


def given(path: Path) -> Truth:
    """From a file: an .exr, or an .npz with `mean` and `se`."""
    if not path.is_file():
        raise Failure(f"{path}: no such reference", "name an .exr, or an .npz with mean and se")
    if path.suffix != ".npz":
        return usable(Truth(exr.read_image(path), f"read from {path.name}", None), path)
    try:
        found = read_reference(path)
    except (KeyError, ValueError, OSError, BadZipFile) as error:
        raise Failure(f"{path}: {error}", "write it by numpy.savez(path, mean=image, se=standard_error)")
    return usable(Truth(found.mean, f"read from {path.name}", own_error(found)), path)


def usable(truth: Truth, path: Path) -> Truth:
    """A reference that errors can be measured against."""
    image = truth.image
    if image.ndim != 3 or image.shape[2] != 3:
        raise Failure(f"{path}: an array of shape {image.shape} is no image", "give (height, width, 3)")
    if not np.isfinite(image).all() or not math.isfinite(truth.own_relmse or 0):
        raise Failure(f"{path}: holds NaN or infinite values", "give a reference whose values are all finite")
    if not image.any():
        raise Failure(f"{path}: is black: no error can be relative to it", "light the scene")
    return truth


def of_size(truth: Truth, size: tuple[int, int] | None) -> Truth:
    """The reference, refused if its (width, height) is another one; None: nobody knows."""
    height, width = truth.image.shape[:2]
    if size and size != (width, height):
        problem = f"the reference has {width} x {height} pixels, the scene {size[0]} x {size[1]}"
        raise Failure(problem, "give a reference of the size at which the scene is rendered, or --size")
    return truth


def pooled(batches: dict[str, np.ndarray], samples: dict[str, int]) -> Truth:
    """The mean of all contenders' batches (batches, height, width, 3), each weighted by its precision in the whole
    image. If the two are not of one mind, the brighter is taken alone: both should be unbiased, but what a short run of rare,
    bright paths has not found yet makes it darker, and lets it look less noisy than it is."""
    broken = [name for name, images in batches.items() if not np.isfinite(images).all()]
    batches = {name: images for name, images in batches.items() if name not in broken}
    if not batches:
        raise Failure(f"the reference by {' and '.join(broken)} holds NaN or infinite values", "give a --reference")
    parts = {name: estimate(images) for name, images in batches.items()}
    told = "; ".join(f"{len(batches[name])} x {samples[name]} samples per pixel of {name}" for name in parts)
    warning = disagreement(batches)
    unfit = f"{' and '.join(broken)} took no part in the reference: what it renders holds NaN or infinite values" if broken else ""
    if warning:
        name = max(parts, key=lambda name: float(parts[name].mean.mean()))
        return Truth(parts[name].mean, f"{told}; {name} alone, as they disagree", own_error(parts[name]), warning)
    whole = weighted(list(parts.values()))
    return Truth(whole.mean, f"pooled by precision: {told}" if len(parts) > 1 else told, own_error(whole), unfit)


def weighted(parts: list[Estimate]) -> Estimate:
    """The mean of estimates, weighted by the precision of each in the whole image, dark places counting as in relMSE."""
    precision = np.array([1 / max(own_error(part), 1e-300) for part in parts])
    weights = precision / precision.sum()
    mean = sum((w * part.mean for w, part in zip(weights, parts)), np.zeros(1))
    variance = sum((w**2 * part.variance for w, part in zip(weights, parts)), np.zeros(1))
    return Estimate(mean, variance, min(part.freedom for part in parts))


def disagreement(batches: dict[str, np.ndarray]) -> str:
    """What there is to say if two contenders' image means are too far apart."""
    if len(batches) < 2:
        return ""
    (first, a), (second, b) = batches.items()
    score = float(standard_score(estimate(a.mean(axis=(1, 2, 3))), estimate(b.mean(axis=(1, 2, 3)))))
    if abs(score) <= APART:
        return ""
    return (
        f"the image means of {first} and {second} are {abs(score):.1f} standard errors apart: one of them misses light; "
        "see `python3 -m validation compare`"
    )
