"""FLIP, the perceived difference of two images (Andersson et al. 2021, for high dynamic range), by NVIDIA's package."""

import flip_evaluator
import numpy as np

from validation.failure import Failure

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
FULL = 2.119
"""What the ACES curve of the package shows at 85 %."""
NARROWEST = 0.01
"""Stops between the first and the last exposure, at least."""


def compared(reference: np.ndarray, image: np.ndarray) -> tuple[np.ndarray, float]:
    """The map of differences as 8-bit colours (magma, black 0 to white 1), and its mean, of linear RGB."""
    if not (np.isfinite(reference).all() and np.isfinite(image).all()):
        raise Failure("FLIP knows no images that are not finite", "mend the renderer")
    start, stop = exposures(reference)
    shown = [np.ascontiguousarray(np.maximum(pixels, 0), dtype=np.float32) for pixels in (reference, image)]
    asked = {"startExposure": start, "stopExposure": stop}
    colours, mean, _ = flip_evaluator.evaluate(*shown, "HDR", parameters=asked)
    return np.round(255 * np.clip(colours, 0, 1)).astype(np.uint8), float(mean)


def exposures(reference: np.ndarray) -> tuple[float, float]:
    """In stops: from where the brightest is almost white to where the median is. The package finds them itself, but
    ends the whole process where they are equal or, most of the image being black, infinite."""
    luminance = np.maximum(reference, 0) @ LUMINANCE
    lit = luminance[luminance > 0]
    if not lit.size:
        return 0.0, NARROWEST
    start = float(np.log2(FULL / lit.max()))
    return start, max(float(np.log2(FULL / np.median(lit))), start + NARROWEST)
