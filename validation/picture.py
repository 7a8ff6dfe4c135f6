"""Pictures for the eye: tone mapping, enlargement, and maps of disagreement; 8-bit pixels are (height, width, 3)."""

from pathlib import Path

import numpy as np

from tyndall import display


def displayed(image: np.ndarray, white: float) -> np.ndarray:
    """Linear RGB as 8-bit sRGB, `white` becoming full white."""
    return display.encoded(display.shown(image / white))


def white_of(image: np.ndarray) -> float:
    """A white level that leaves all but the brightest pixels within range."""
    return max(float(np.quantile(image, 0.98)), 1e-12)


def diverging(z: np.ndarray, limit: float = 4) -> np.ndarray:
    """Blue where z is negative, white at 0, red where positive; one value a pixel, the channels' greatest."""
    strongest = np.take_along_axis(z, np.abs(z).argmax(axis=2)[:, :, None], axis=2)[:, :, 0]
    x = np.clip(strongest / limit, -1, 1)
    rgb = np.stack([1 - np.maximum(-x, 0), 1 - np.abs(x), 1 - np.maximum(x, 0)], axis=2)
    return np.round(255 * rgb).astype(np.uint8)


def enlarged(pixels: np.ndarray, least: int = 240) -> np.ndarray:
    """Whole-number enlargement to at least `least` pixels of height."""
    factor = max(1, -(-least // pixels.shape[0]))
    return pixels.repeat(factor, axis=0).repeat(factor, axis=1)


def side_by_side(*pictures: np.ndarray, gap: int = 4) -> np.ndarray:
    """Pictures of one height in a row."""
    large = [enlarged(p) for p in pictures]
    rule = np.full((large[0].shape[0], gap, 3), 255, dtype=np.uint8)
    return np.concatenate([part for p in large for part in (p, rule)][:-1], axis=1)


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Writes 8-bit pixels."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(display.png(pixels))
