"""Pictures for a screen: the program's tone curve (Reinhard et al. 2002, eq. 4; src/film/png.rs), and PNG files."""

import struct
import zlib

import numpy as np

LUMINANCE = np.array([0.212671, 0.715160, 0.072169])
"""Of linear sRGB."""
BELOW_WHITE = 0.995
"""The share of pixels that are not brighter than the white point."""
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def tone_mapped(image: np.ndarray) -> np.ndarray:
    """Linear RGB (height, width, 3) as 8-bit sRGB, as the program's PNG files show it."""
    pixels = shown(image)
    luminance = pixels @ LUMINANCE
    white = max(1.0, float(np.sort(luminance, axis=None)[int(np.ceil(luminance.size * BELOW_WHITE)) - 1]))
    mapped = np.minimum(luminance * (1 + luminance / white**2) / (1 + luminance), 1)
    scaled = pixels * np.divide(mapped, luminance, out=np.zeros_like(mapped), where=luminance > 0)[..., None]
    return encoded(in_range(scaled, mapped))


def shown(image: np.ndarray) -> np.ndarray:
    """The pixels as if nothing had gone wrong with them: NaN and negative values are black."""
    return np.minimum(np.where(np.asarray(image) > 0, image, 0), 1e18)


def in_range(scaled: np.ndarray, luminance: np.ndarray) -> np.ndarray:
    """Colours mixed with grey of the same luminance until no channel exceeds 1."""
    most = scaled.max(axis=-1)
    room = np.divide(1 - luminance, most - luminance, out=np.ones_like(most), where=most > 1)
    grey = luminance[..., None]
    return np.where(grey >= 1, 1, grey + (scaled - grey) * room[..., None])


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
