"""What progressive pictures are compared with."""

import numpy as np

from validation.progressive import gridded


def test_a_grid_has_its_part_of_the_pixels_and_finds_linear_pictures() -> None:
    down, across = np.mgrid[0:48, 0:64]
    linear = np.stack([across + 1.0, 2.0 * down, across - 0.5 * down], axis=2)
    assert np.allclose(gridded(linear, 0.1), linear)
    noise = np.random.default_rng(1).random((48, 64, 3))
    kept = (np.abs(gridded(noise, 0.1) - noise).max(axis=2) < 1e-12).mean()
    assert 0.085 < kept <= 0.1
