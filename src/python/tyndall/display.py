"""Pictures for a screen: PNG files as the program writes them (its views and exposures: `tyndall convert -h`), and the sRGB
transfer function."""

import struct
import tempfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import exr, program

SIGNATURE = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class Display:
    """How a picture is shown: `view` and `exposure` are those of `tyndall render`."""

    view: str = "standard"
    exposure: float | str = 0.0

    def png(self, image: np.ndarray, metadata: Mapping[str, Any]) -> bytes:
        """The PNG file of linear RGB, (height, width, 3)."""
        with tempfile.TemporaryDirectory(prefix="tyndall-") as name:
            source, goal = Path(name, "image.exr"), Path(name, "image.png")
            exr.write(source, {exr.ROOT: {channel: np.asarray(image[..., i]) for i, channel in enumerate("RGB")}}, metadata)
            options = program.flags({"view": self.view, "exposure": self.exposure})
            program.call([str(program.binary()), "--quiet", "convert", str(source), str(goal), *options])
            return goal.read_bytes()


def shown(image: np.ndarray) -> np.ndarray:
    """The pixels as if nothing had gone wrong with them: NaN and negative values are black."""
    return np.minimum(np.where(np.asarray(image) > 0, image, 0), 1e18)


def encoded(linear: np.ndarray) -> np.ndarray:
    """Linear values from 0 to 1 as bytes, by the sRGB transfer function (IEC 61966-2-1)."""
    linear = np.clip(linear, 0, 1)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.floor(255 * curve + 0.5).astype(np.uint8)


def png(pixels: np.ndarray) -> bytes:
    """A PNG file of 8-bit pixels, (height, width, 3)."""
    height, width, _ = pixels.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")


def chunk(kind: bytes, data: bytes) -> bytes:
    """A part of a PNG file."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
