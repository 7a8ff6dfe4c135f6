"""Makes the small files of `scenes/crosscheck/assets/` that scenes name; run once, its results are kept by git."""

import struct
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tyndall.volume_file import UNIT, vol
from validation import mitsuba
from validation.places import CROSSCHECK

SERIALIZED_FORMAT, SERIALIZED_VERSION = 0x041C, 4
NORMALS, TEXTURE_COORDINATES, SINGLE_PRECISION = 0x0001, 0x0002, 0x1000


def run(folder: Path = CROSSCHECK / "assets") -> bool:
    """Writes all of them anew."""
    mitsuba.use("scalar_rgb")
    images = {
        "dusk.exr": dusk(),
        "slide.hdr": slide(),
        "tiles.exr": tiles(),
        "tiles.png": eight_bits(tiles()),
        "poster.jpg": eight_bits(poster()),
        "holes.png": eight_bits(holes()),
        "dimples.png": eight_bits(dimples()),
        "dunes.png": eight_bits(dunes()),
    }
    for name, pixels in images.items():
        kind = np.uint8 if pixels.dtype == np.uint8 else np.float32
        mitsuba.package().Bitmap(np.ascontiguousarray(pixels, dtype=kind)).write(str(folder / name))
    solids = [(*pyramid(), 0), (*lantern(), NORMALS | TEXTURE_COORDINATES)]
    (folder / "solids.serialized").write_bytes(serialized(solids))
    (folder / "tent.obj").write_text(TENT)
    (folder / "gem.ply").write_text(gem())
    for name, (samples, box) in grids().items():
        (folder / name).write_bytes(vol(samples, box))
    return True


def grid(width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """The positions of an image's pixels, 0 to 1 each way."""
    y, x = np.mgrid[:height, :width]
    return (x + 0.5) / width, (y + 0.5) / height


def colours(*channels: npt.ArrayLike) -> np.ndarray:
    """One RGB image of three."""
    return np.stack(np.broadcast_arrays(*channels), axis=-1).astype(np.float32)


def eight_bits(image: np.ndarray) -> np.ndarray:
    """As sRGB bytes of the same numbers: what they stand for is the file's own affair."""
    return np.round(255 * image).astype(np.uint8)


def dusk() -> np.ndarray:
    """An environment: a sky that reddens towards the horizon, dark ground, a low sun, nothing symmetric."""
    x, y = grid(32, 16)
    sky = colours(0.15 + 0.5 * y, 0.25 + 0.15 * y, 0.6 - 0.3 * y) * (y < 0.55)[..., None]
    sun = np.exp(-((x - 0.3) ** 2 + 0.25 * (y - 0.35) ** 2) / 0.0015)
    return sky + colours(0.06, 0.05, 0.03 + 0.05 * x) + sun[..., None] * np.array([30, 18, 8], np.float32)


def slide() -> np.ndarray:
    """A window's light: coloured bars, one corner dark."""
    x, y = grid(12, 8)
    bars = colours(0.3 + 0.7 * (x < 0.34), 0.3 + 0.9 * (abs(x - 0.5) < 0.17), 0.3 + 0.5 * (x > 0.66))
    return bars * np.where((x > 0.7) & (y < 0.4), 0.1, 0.8 - 0.5 * y)[..., None].astype(np.float32)


def tiles() -> np.ndarray:
    """Six by five colours without any symmetry."""
    return np.random.default_rng(3).uniform(0.05, 0.9, (5, 6, 3)).astype(np.float32)


def poster() -> np.ndarray:
    """Smooth colours, so that one JPEG decoder differs little from another."""
    x, y = grid(32, 24)
    return colours(0.3 + 0.5 * x, 0.8 - 0.5 * y, 0.35 + 0.4 * x * y)


def holes() -> np.ndarray:
    """Grey: nothing, half and all."""
    rows = ["#..#-.", ".##.--", "#.-#.#", "-#..##", "..#-#."]
    return np.array([[{"#": 1, "-": 0.5, ".": 0}[c] for c in row] for row in rows], np.float32)[..., None]


def dimples() -> np.ndarray:
    """Normals, from -1 as 0 to 1 as 1: a few smooth hollows, deeper to the right."""
    x, y = grid(24, 24)
    depth = 0.4 + 0.8 * x
    tilt = (depth * np.sin(4 * np.pi * x), depth * np.cos(6 * np.pi * y + 1))
    length = np.sqrt(tilt[0] ** 2 + tilt[1] ** 2 + 1)
    return colours(*(0.5 + 0.5 * t / length for t in (*tilt, 1)))


def dunes() -> np.ndarray:
    """Heights, grey: smooth waves that meet at the edges, not alike either way."""
    x, y = (2 * np.pi * a for a in grid(24, 24))
    return (0.5 + 0.2 * np.sin(2 * x + np.cos(y)) + 0.2 * np.cos(y) * np.sin(x + 1))[..., None].astype(np.float32)


def gem() -> str:
    """A PLY ball of few triangles with colours of corners and of faces, named each way that Mitsuba reads."""
    corners, normals, uvs, triangles = lantern(8, 4)
    random = np.random.default_rng(5)
    vertices = np.hstack([corners, normals, uvs, random.uniform(0.1, 0.9, (len(corners), 4))])
    faces = random.uniform(0.1, 0.9, (len(triangles), 4))
    header = ["ply", "format ascii 1.0", f"element vertex {len(corners)}"]
    header += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz", "u", "v", "r", "g", "b", "wear_0")]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
    header += [f"property float {name}" for name in ("color_0", "color_1", "color_2", "gold_x")]
    rows = [" ".join(f"{x:.4f}" for x in vertex) for vertex in vertices]
    rows += [f"3 {a} {b} {c} " + " ".join(f"{x:.4f}" for x in face) for (a, b, c), face in zip(triangles, faces, strict=True)]
    return "\n".join([*header, "end_header", *rows]) + "\n"


def pyramid() -> tuple[np.ndarray, ...]:
    """A closed four-sided pyramid: corners and triangles."""
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0.2, 1.6, -0.1]], np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]], np.uint32)
    empty = np.zeros((5, 0), np.float32)
    return corners, empty, empty, triangles


def lantern(around: int = 12, up: int = 6) -> tuple[np.ndarray, ...]:
    """A closed ball with a waist: corners, normals, texture coordinates, triangles; a seam of doubled corners."""
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, around + 1), np.linspace(0, 1, up + 1)))
    angle, theta = 2 * np.pi * u, np.pi * v
    waist = 1 - 0.3 * np.sin(theta) ** 4
    outwards = np.stack([np.sin(theta) * np.cos(angle), np.cos(theta), -np.sin(theta) * np.sin(angle)], axis=1)
    first = (np.arange(up)[:, None] * (around + 1) + np.arange(around)).ravel()
    below = first + around + 1
    upper = np.stack([first, below, first + 1], axis=1)[around:]
    lower = np.stack([first + 1, below, below + 1], axis=1)[:-around]
    corners = outwards * np.stack([waist, np.ones_like(waist), waist], axis=1)
    triangles = np.concatenate([upper, lower]).astype(np.uint32)
    return corners.astype(np.float32), outwards.astype(np.float32), np.stack([u, v], 1).astype(np.float32), triangles


def serialized(solids: list[tuple]) -> bytes:
    """Mitsuba's container as its documentation of the plugin describes it: compressed meshes, then their places."""
    parts: list[bytes] = []
    places: list[int] = []
    for number, (corners, normals, uvs, triangles, kind) in enumerate(solids):
        places.append(sum(map(len, parts)))
        name = f"solid {number}".encode() + b"\0"
        sizes = struct.pack("<QQ", len(corners), len(triangles))
        arrays = b"".join(a.tobytes() for a in (corners, normals, uvs, triangles))
        header = struct.pack("<HH", SERIALIZED_FORMAT, SERIALIZED_VERSION)
        parts.append(header + zlib.compress(struct.pack("<I", kind | SINGLE_PRECISION) + name + sizes + arrays))
    return b"".join(parts) + struct.pack(f"<{len(places)}QI", *places, len(places))


def grids() -> dict[str, tuple[np.ndarray, tuple]]:
    """Volumes, (z, y, x) or (z, y, x, channel), and the boxes that their files name."""
    random = np.random.default_rng(4)
    return {
        "even.vol": (np.ones((4, 2, 3)), UNIT),
        "smoke.vol": (random.uniform(0, 1, (4, 5, 6)) ** 2, (-0.5, 0.2, -0.6, 0.4, 1.2, 0.1)),
        "smoke_colours.vol": (random.uniform(0, 1, (3, 4, 5, 3)) ** 1.5, UNIT),
        "albedo_colours.vol": (random.uniform(0.3, 1, (4, 3, 4, 3)), UNIT),
        "puffs.vol": (puffs(), UNIT),
        "felt.vol": (felt(), UNIT),
    }


def puffs() -> np.ndarray:
    """Three round puffs, far apart; most of the box is empty, and so are whole blocks of 8 x 8 x 8."""
    z, y, x = np.mgrid[:12, :18, :20] + 0.5
    centres = ((3.5, 3, 3, 3.2), (16, 6, 8.5, 3.5), (9, 15.2, 5, 2.6))
    distances = [np.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / r for a, b, c, r in centres]
    return sum(np.maximum(0, 1 - d) for d in distances)


def felt() -> np.ndarray:
    """Matrices of microflakes that lie another way in every voxel: xx, yy, zz, xy, xz, yz; no area is above 1."""
    random = np.random.default_rng(6)
    axes, _ = np.linalg.qr(random.normal(size=(2, 3, 4, 3, 3)))
    squared = random.uniform(0.02, 0.95, (2, 3, 4, 3))
    matrices = np.einsum("...ik,...k,...jk->...ij", axes, squared, axes)
    return np.stack([matrices[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], axis=-1)


TENT = """# a closed roof of two slopes and two gables: polygons of four and of three corners, no normals
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 1 0
v 1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 4/1 3/2 6/3 5/4
f 2/1 1/2 5/3 6/4
f 1/1 4/2 5/3
f 3/1 2/2 6/3
f 1/1 2/2 3/3 4/4
"""
