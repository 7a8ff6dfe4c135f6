"""Writes a cumulus (cumulus.vdb) and two skies (cumulus_day.hdr, cumulus_sunset.hdr).

    python3 scenes/gallery/assets/make_cumulus.py

The cloud is a heap of spheres on spheres on spheres, roughened by noise, over a flat base (x to the right, y up; 100 m are 1).
"""

import struct
import zlib
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
VOXELS = np.array((192, 120, 128))
"""Voxels along x, y and z."""
SIDE = 0.0625
"""Of a voxel."""
LOW = np.array((-6.0, 0.0, -4.0))
"""Lower corner of the grid."""


def noise(at: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Perlin's gradient noise at positions in cells, (..., 3)."""
    cell = np.floor(at).astype(int)
    inside = at - cell
    gradients = random.normal(size=(32, 32, 32, 3)).astype(np.float32)
    fade = inside**3 * (inside * (6 * inside - 15) + 10)
    total = np.zeros(at.shape[:-1], np.float32)
    for corner in np.ndindex(2, 2, 2):
        gradient = gradients[tuple(((cell + corner) % 32)[..., axis] for axis in range(3))]
        weight = np.prod(np.where(corner, fade, 1 - fade), axis=-1)
        total += weight * np.sum(gradient * (inside - corner), axis=-1)
    return total


def heap(random: np.random.Generator) -> list[tuple[np.ndarray, float]]:
    """Spheres: a few large ones side by side, smaller ones on their upper sides, smaller ones still on these."""
    large = [
        ((-3.9, 1.1, 0.2), 0.9), ((-2.6, 1.7, 0.3), 1.2), ((-1.7, 3.3, -0.4), 1.25), ((-2.2, 4.5, -0.3), 0.85),
        ((-1.1, 5.3, -0.4), 0.95), ((-0.6, 1.9, 0.2), 1.5), ((-0.4, 3.9, -0.6), 1.1), ((1.2, 1.6, 0.6), 1.25),
        ((2.1, 2.9, -0.3), 1.15), ((2.9, 3.6, -0.4), 0.7), ((2.9, 1.4, 0.2), 1.1), ((4.1, 1.1, 0.0), 0.75),
        ((-1.5, 1.1, 1.7), 0.8), ((0.5, 1.0, 1.9), 0.75),
    ]  # fmt: skip
    level = [(np.array(centre), radius) for centre, radius in large]
    spheres = list(level)
    for count, shrink in ((16, 0.4), (14, 0.4)):
        level = [bud(centre, radius, shrink, random) for centre, radius in level for _ in range(count)]
        spheres += level
    return spheres


def bud(centre: np.ndarray, radius: float, shrink: float, random: np.random.Generator) -> tuple[np.ndarray, float]:
    """A smaller sphere half out of a larger one, not at its lower side."""
    direction = random.normal(size=3)
    direction[1] = abs(direction[1]) - 0.25
    direction /= np.linalg.norm(direction)
    smaller = radius * shrink * random.uniform(0.6, 1.15)
    return centre + direction * (radius - 0.1 * smaller), smaller


def cumulus() -> np.ndarray:
    """Densities from 0 to 1, (x, y, z)."""
    random = np.random.default_rng(7)
    at = [LOW[axis] + SIDE * (np.arange(VOXELS[axis], dtype=np.float32) + 0.5) for axis in range(3)]
    outside = np.full(VOXELS, 4.0, np.float32)
    for centre, radius in heap(random):
        window = tuple(slice(*np.searchsorted(at[i], (centre[i] - radius - 0.6, centre[i] + radius + 0.6))) for i in range(3))
        near = np.meshgrid(*(at[i][window[i]] - centre[i] for i in range(3)), indexing="ij", sparse=True)
        distance = np.sqrt(sum(x * x for x in near)) - radius
        outside[window] = np.minimum(outside[window], distance)
    positions = np.stack(np.meshgrid(*at, indexing="ij"), axis=-1).astype(np.float32)
    rough = sum(weight * noise(frequency * positions, random) for frequency, weight in ((0.7, 0.2), (1.7, 0.12), (3.7, 0.08), (7.3, 0.05)))
    base = 0.55 + 0.12 * noise(0.8 * positions, random) - positions[..., 1]
    return np.clip(-np.maximum(outside + rough, base) / 0.11, 0, 1)


def vdb(samples: np.ndarray) -> bytes:
    """An OpenVDB file of one grid of half numbers, packed; voxels of 0 are left out, blocks of 1 have one value."""
    text = lambda s: struct.pack("<I", len(s)) + s.encode()
    vector = lambda *v: struct.pack("<3d", *v)
    header = b" BDV\0\0\0\0" + struct.pack("<3IB", 224, 10, 0, 1) + b"0" * 36 + struct.pack("<2I", 0, 1)
    header += text("density") + text("Tree_float_5_4_3_HalfFloat") + text("")
    notes = text("class") + text("string") + text("fog volume")
    notes += text("is_saved_as_half_float") + text("bool") + struct.pack("<I?", 1, True)
    scales = np.full((5, 3), [[SIDE], [SIDE], [1 / SIDE], [1 / SIDE**2], [0.5 / SIDE]])
    place = text("UniformScaleTranslateMap") + vector(*(LOW + SIDE / 2)) + scales.astype("<f8").tobytes()
    tree, blocks = nodes(samples)
    grid = struct.pack("<2I", 3, 2) + notes + place + tree
    start = len(header) + 24
    return header + struct.pack("<3Q", start, start + len(grid), start + len(grid) + len(blocks)) + grid + blocks


def nodes(samples: np.ndarray) -> tuple[bytes, bytes]:
    """The tree without the values of its blocks, and these: a root, one node of 32^3 below it, of 16^3 blocks each below that."""
    bits = lambda mask: np.packbits(mask.ravel(), bitorder="little").tobytes()
    sides = -(-np.array(samples.shape) // 128)
    whole = np.zeros(128 * sides)
    whole[tuple(map(slice, samples.shape))] = samples
    children = np.zeros((32, 32, 32), bool)
    children[tuple(map(slice, sides))] = True
    tree = struct.pack("<If2I3i", 1, 0, 0, 1, 0, 0, 0) + bits(children) + bytes(4096 + 1)
    blocks = b""
    for corner in np.argwhere(children):
        part = whole[tuple(slice(128 * i, 128 * i + 128) for i in corner)]
        part = part.reshape(16, 8, 16, 8, 16, 8).transpose(0, 2, 4, 1, 3, 5).reshape(4096, 512)
        full, mixed = (part == 1).all(axis=1), (part > 0).any(axis=1) & (part < 1).any(axis=1)
        tree += bits(mixed) + bits(full) + packed(np.ones(full.sum()))
        tree += b"".join(bits(block > 0) for block in part[mixed])
        blocks += b"".join(bits(block > 0) + packed(block[block > 0]) for block in part[mixed])
    return tree, blocks


def packed(values: np.ndarray) -> bytes:
    """A node's values, all others being those of the background."""
    plain = values.astype("<f2").tobytes()
    short = zlib.compress(plain, 9)
    if not plain:
        return b"\0"
    return b"\0" + (struct.pack("<q", len(short)) + short if len(short) < len(plain) else struct.pack("<q", -len(plain)) + plain)


def sky(height: int, gradient: list, glow: tuple, ground: tuple) -> bytes:
    """A Radiance picture in latitude and longitude: colours by elevation [degrees], and a glow (colour, azimuth, elevation, width)."""
    elevation = 90 - 180 * (np.arange(height) + 0.5) / height
    azimuth = 360 * (np.arange(2 * height) + 0.5) / (2 * height)
    knots, colours = zip(*gradient)
    rows = np.stack([np.interp(elevation, knots, channel) for channel in np.transpose(colours)], axis=-1)
    rows[elevation < 0] = ground
    colour, to, up, width = glow
    a, e = np.radians(azimuth)[None, :], np.radians(elevation)[:, None]
    cosine = np.sin(e) * np.sin(np.radians(up)) + np.cos(e) * np.cos(np.radians(up)) * np.cos(a - np.radians(to))
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    image = rows[:, None] + np.where(e > 0, np.exp(-((angle / width) ** 1.2)), 0)[..., None] * np.array(colour)
    exponent = np.ceil(np.log2(np.maximum(image.max(axis=-1), 1e-9)) + 1e-9)
    mantissas = np.clip(image * 256 / 2.0 ** exponent[..., None], 0, 255).astype(np.uint8)
    pixels = np.concatenate([mantissas, (exponent[..., None] + 128).astype(np.uint8)], axis=-1)
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {2 * height}\n".encode() + pixels.tobytes()


DAY = [(0, (0.62, 0.74, 0.88)), (8, (0.42, 0.6, 0.85)), (25, (0.2, 0.38, 0.74)), (60, (0.09, 0.21, 0.55)), (90, (0.06, 0.16, 0.46))]
SUNSET = [(0, (0.85, 0.42, 0.2)), (5, (0.72, 0.38, 0.24)), (14, (0.4, 0.3, 0.34)), (30, (0.16, 0.19, 0.34)), (90, (0.05, 0.08, 0.2))]


def main() -> None:
    """Writes the files."""
    cloud = np.round(cumulus() * 16) / 16
    files = {"cumulus.vdb": vdb(cloud)}
    files["cumulus_day.hdr"] = sky(64, DAY, ((0.5, 0.5, 0.45), 140, 42, 18), (0.11, 0.12, 0.08))
    files["cumulus_sunset.hdr"] = sky(64, SUNSET, ((1.3, 0.62, 0.2), 44, 5, 22), (0.05, 0.04, 0.05))
    for name, content in files.items():
        (HERE / name).write_bytes(content)


if __name__ == "__main__":
    main()
