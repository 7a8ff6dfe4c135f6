"""The flask of ../milk_and_laser.json. Run it in any folder; it needs numpy."""

import numpy as np

from files import ply, turned


def flask() -> np.ndarray:
    """A conical flask full to the lip, its edges rounded: radii and heights, closed at both ends."""
    angle = np.linspace(-np.pi / 2, 0.3, 9)
    foot = np.stack([0.046 + 0.008 * np.cos(angle), 0.009 + 0.008 * np.sin(angle)], -1)
    bend = np.linspace(0, 1, 12)[:, None]
    shoulder = (1 - bend) ** 2 * [0.027, 0.079] + 2 * bend * (1 - bend) * [0.0165, 0.108] + bend**2 * [0.0165, 0.122]
    lip = np.array([[0.0165, 0.136], [0.0185, 0.1385], [0.0185, 0.1405], [0.017, 0.1425], [0.0002, 0.1428]])
    return np.concatenate([[[0.0002, 0.001]], foot, shoulder, lip])


ply("milk_and_laser_flask.ply", *turned(flask(), 72))
