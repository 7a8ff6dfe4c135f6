"""Time to equal error against Mitsuba, on the scenes of `scenes/efficiency/` and the lamp boxes."""

import argparse

import numpy as np

from validation import plume
from validation.places import SCENES
from validation.volume_file import vol

FOLDER = SCENES / "efficiency"
VOXELS = 256


def run(_: argparse.Namespace) -> bool:
    """Writes the grids."""
    volumes()
    return True


def volumes() -> None:
    """Writes the grids that the scenes name, too large for the repository."""
    folder = FOLDER / "assets"
    folder.mkdir(exist_ok=True)
    for name, samples in (("plume", plume.smoke), ("cloud", cloud)):
        path = folder / f"{name}.vol"
        if not path.is_file():
            partial = path.with_suffix(".partial")
            partial.write_bytes(vol(samples(VOXELS)))
            partial.replace(path)


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
    billows = body + 0.9 * (plume.turbulence(voxels, 11) - 0.45)
    return (np.clip(4 * billows, 0, 1) * np.clip(20 * (y - 0.12), 0, 1)).astype(np.float32)
