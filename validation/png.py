"""PNG files of 8-bit RGB, for pages that hold their pictures."""

import base64
import struct
import zlib
from pathlib import Path

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"
RGB_OF_8_BITS = (8, 2, 0, 0, 0)


def encoded(pixels: np.ndarray) -> bytes:
    """The file of (height, width, 3) bytes."""
    height, width, _ = pixels.shape
    unfiltered = np.zeros((height, 1), np.uint8)
    rows = np.hstack([unfiltered, np.ascontiguousarray(pixels, dtype=np.uint8).reshape(height, 3 * width)])
    header = struct.pack(">II5B", width, height, *RGB_OF_8_BITS)
    return SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)) + chunk(b"IEND", b"")


def write(path: Path, pixels: np.ndarray) -> None:
    """Writes the file and the folders that it needs."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(encoded(pixels))


def chunk(kind: bytes, data: bytes) -> bytes:
    """A part of the file with its checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def data_url(pixels: np.ndarray) -> str:
    """The file as the address of an image that a page holds itself."""
    return "data:image/png;base64," + base64.b64encode(encoded(pixels)).decode("ascii")
