"""Moving pictures: PNG files put together as one animated PNG (https://www.w3.org/TR/png-3/, 4.9)."""

import struct
from collections.abc import Iterator, Sequence

from tyndall.display import SIGNATURE, chunk


def animation(frames: Sequence[bytes], fps: float) -> bytes:
    """An endless animated PNG from PNG files of one size, without their metadata."""
    header = next(data for kind, data in chunks(frames[0]) if kind == b"IHDR")
    parts = [SIGNATURE, chunk(b"IHDR", header), chunk(b"acTL", struct.pack(">II", len(frames), 0))]
    for number, frame in enumerate(frames):
        parts += [chunk(b"fcTL", control(max(0, 2 * number - 1), header, fps)), *image(frame, 2 * number)]
    return b"".join([*parts, chunk(b"IEND", b"")])


def still(frame: bytes) -> bytes:
    """A PNG file without its metadata: where it was made is nobody's business."""
    kept = [chunk(kind, data) for kind, data in chunks(frame) if kind not in (b"tEXt", b"zTXt", b"iTXt")]
    return b"".join([SIGNATURE, *kept])


def control(sequence: int, header: bytes, fps: float) -> bytes:
    """Where a frame is, all over the picture, and for how long: in place of the one before."""
    milliseconds = round(1000 / fps)
    return struct.pack(">I", sequence) + header[:8] + struct.pack(">IIHHBB", 0, 0, milliseconds, 1000, 0, 0)


def image(frame: bytes, sequence: int) -> list[bytes]:
    """The pixels of a frame, as they are compressed: those of the first are the picture where nothing can move."""
    pixels = b"".join(data for kind, data in chunks(frame) if kind == b"IDAT")
    return [chunk(b"fdAT", struct.pack(">I", sequence) + pixels) if sequence else chunk(b"IDAT", pixels)]


def chunks(file: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Kinds and contents."""
    at = len(SIGNATURE)
    while at < len(file):
        length, kind = struct.unpack(">I4s", file[at : at + 8])
        yield kind, file[at + 8 : at + 8 + length]
        at += length + 12
