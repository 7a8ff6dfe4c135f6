"""Mitsuba's grid files (.vol): voxels as 32-bit floats."""

import struct

import numpy as np

UNIT = (0.0, 0.0, 0.0, 1.0, 1.0, 1.0)
"""The box that a file names where nobody looks at it: lower corner, upper corner."""


def vol(samples: np.ndarray, box: tuple[float, ...] = UNIT) -> bytes:
    """The file, version 3, of voxels (z, y, x) or (z, y, x, channel)."""
    data = np.asarray(samples, dtype="<f4")
    z, y, x, channels = data.shape if data.ndim == 4 else (*data.shape, 1)
    return b"VOL" + struct.pack("<B5i6f", 3, 1, x, y, z, channels, *box) + data.tobytes()
