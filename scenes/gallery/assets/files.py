"""Files that the scripts of this folder write beside themselves: meshes and images of the surroundings."""

from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent


def ply(name: str, points: np.ndarray, triangles: np.ndarray) -> None:
    """A mesh of points (n, 3) and triangles (m, 3)."""
    wide = len(points) > 65535
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar {'uint' if wide else 'ushort'} vertex_indices\nend_header\n"
    )
    faces = np.zeros(len(triangles), [("count", "u1"), ("corners", "<u4" if wide else "<u2", 3)])
    faces["count"], faces["corners"] = 3, triangles
    (FOLDER / name).write_bytes(header.encode() + np.asarray(points, "<f4").tobytes() + faces.tobytes())


def hdr(name: str, image: np.ndarray) -> None:
    """An image (height, width, 3) in Radiance's format, every pixel by itself."""
    height, width, _ = image.shape
    fraction, exponent = np.frexp(np.maximum(image.max(axis=2), 1e-30))
    mantissas = np.clip(image * (fraction * 256 / np.maximum(image.max(axis=2), 1e-30))[..., None], 0, 255)
    pixels = np.concatenate([mantissas, (exponent + 128)[..., None]], axis=2).astype(np.uint8)
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    (FOLDER / name).write_bytes(header.encode() + pixels.tobytes())


def lattice(rows: int, columns: int, around: bool = False) -> np.ndarray:
    """Triangles of a lattice of points, row by row; `around` joins the last column with the first."""
    row, column = np.mgrid[: rows - 1, : columns - (not around)]
    right = (column + 1) % columns
    a, b, c, d = (r * columns + s for r, s in ((row, column), (row, right), (row + 1, column), (row + 1, right)))
    return np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], -2).reshape(-1, 3)


def turned(profile: np.ndarray, around: int) -> tuple[np.ndarray, np.ndarray]:
    """A profile (n, 2) of radii and heights, from below, turned about the y axis; facing outwards."""
    angle = 2 * np.pi * np.arange(around) / around
    radius, height = np.asarray(profile, float).T[..., None]
    points = np.stack([radius * np.cos(angle), height + 0 * angle, radius * np.sin(angle)], -1)
    return points.reshape(-1, 3), lattice(len(profile), around, around=True)


def joined(*meshes: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Several meshes as one."""
    starts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    return np.concatenate([points for points, _ in meshes]), np.concatenate([t + start for (_, t), start in zip(meshes, starts)])


def noise(at: np.ndarray, seed: int, octaves: int = 5) -> np.ndarray:
    """Smooth random values of about -1 to 1 at points (..., 2): waves of random directions, shorter and lower by octaves."""
    random = np.random.default_rng(seed)
    total = np.zeros(at.shape[:-1])
    for octave in range(octaves):
        for _ in range(6):
            angle, phase = random.uniform(0, 2 * np.pi, 2)
            total += 0.5**octave / 3 * np.sin(2**octave * (at @ [np.cos(angle), np.sin(angle)]) + phase)
    return total
