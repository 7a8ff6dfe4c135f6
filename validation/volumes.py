"""The grids that scenes of `scenes/efficiency/` name, too large for the repository."""

import numpy as np
from scipy import ndimage

from tyndall.volume_file import vol
from validation.places import EFFICIENCY

FOLDER = EFFICIENCY / "assets"
VOXELS = 256


def write() -> None:
    """Writes those that are not there."""
    FOLDER.mkdir(exist_ok=True)
    for name, samples in (("plume", smoke), ("cloud", cloud)):
        path = FOLDER / f"{name}.vol"
        if not path.is_file():
            partial = path.with_suffix(".partial")
            partial.write_bytes(vol(samples(VOXELS)))
            partial.replace(path)


def smoke(voxels: int, seed: int = 8) -> np.ndarray:
    """A rising, widening, billowing column, (z, y, x), from 0 to 1; what is around it is empty."""
    at = (np.arange(voxels, dtype=np.float32) + 0.5) / voxels
    z, y, x = np.meshgrid(2 * at - 1, at, 2 * at - 1, indexing="ij", sparse=True)
    sway_x, sway_z = 0.16 * np.sin(5 * y) * y, 0.12 * np.cos(4 * y + 1) * y
    distance = np.hypot(x - sway_x, z - sway_z) / (0.1 + 0.45 * y**0.8)
    body = 1 - distance + 0.9 * (turbulence(voxels, seed) - 0.35) * (0.3 + y)
    return (np.clip(2 * body, 0, 1) * np.exp(-1.2 * y) * np.clip(12 * (1 - y), 0, 1)).astype(np.float32)


def turbulence(voxels: int, seed: int) -> np.ndarray:
    """Octaves of smooth noise, from 0 to about 1."""
    random = np.random.default_rng(seed)
    total = np.zeros((voxels,) * 3, np.float32)
    for octave, points in enumerate((5, 10, 20, 40, 80)):
        values = random.uniform(-1, 1, (points,) * 3).astype(np.float32)
        smooth = ndimage.zoom(values, voxels / points, order=3 if points < 80 else 1, mode="nearest", grid_mode=True)
        total += np.abs(smooth) * 0.5**octave
    return total


def cloud(voxels: int) -> np.ndarray:
    """Billows over a flat base, (z, y, x), from 0 to 1; what is around them is empty."""
    at = (np.arange(voxels, dtype=np.float32) + 0.5) / voxels
    z, y, x = np.meshgrid(at, at, at, indexing="ij", sparse=True)
    random = np.random.default_rng(6)
    body = np.full((voxels,) * 3, -1, np.float32)
    for radius in (0.27, 0.22, 0.2, 0.18, 0.16, 0.15, 0.13, 0.12):
        centre = random.uniform((0.3, 0.22, 0.3), (0.7, 0.75 - radius, 0.7))
        distance = np.sqrt((z - centre[0]) ** 2 + (y - centre[1]) ** 2 + (x - centre[2]) ** 2)
        body = np.maximum(body, 1 - distance / radius)
    billows = body + 0.9 * (turbulence(voxels, 11) - 0.45)
    return (np.clip(4 * billows, 0, 1) * np.clip(20 * (y - 0.12), 0, 1)).astype(np.float32)
