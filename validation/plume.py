"""Nanoseconds per transmittance query on a plume of 256^3 voxels.

The experiment: a wall beside a plume is lit by a point on the other side, and a camera between both looks at the wall.
Paths have two edges, so that every sample makes one query: the connection of a point of the wall with the light,
through the plume. Mitsuba's time for it is the difference between this render and the same one with next to no smoke. Its own
loop over the medium, compiled alone, is timed on the same connections besides; that is what a query costs without rays
against boundaries. The connections, cut to the plume's box, are written to a file for others to be timed on.
"""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy import ndimage

from validation import assets, mitsuba
from validation.places import OUTPUT
from validation.scene import Scene

FOLDER = OUTPUT / "plume"
VOXELS = 256
BOX = np.array([[-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]])
SCALE = 12.0
"""Extinction where the plume is densest [1/m]."""
NEXT_TO_NOTHING = 1e-6
LIGHT = (3.5, 1.2, 0.2)
WALL = -1.5
SIZE = 128
CHORDS = 1 << 18


@dataclass(frozen=True)
class Timing:
    """Nanoseconds of one query, one number for each repetition."""

    name: str
    nanoseconds: np.ndarray

    def row(self) -> str:
        middle, error = self.nanoseconds.mean(), self.nanoseconds.std(ddof=1) / np.sqrt(len(self.nanoseconds))
        return f"{self.name:44} {middle:10.1f} +- {error:.1f} ns per query"


def run(rounds: int, spp: int) -> bool:
    """Prints Mitsuba's times; one thread."""
    dr.set_thread_count(1)
    files = write(FOLDER)
    print(f"{VOXELS}^3 voxels, {files.told}; scene {files.scene}, connections {files.chords}")
    for variant in ("scalar_rgb", "llvm_ad_rgb"):
        print(rendered(files, variant, rounds, spp).row(), flush=True)
    timing, mean, error = looped(files, rounds)
    print(timing.row())
    print(f"mean transmittance {mean:.3f}; one query of Mitsuba's is off by {error:.2f} of it (root mean square)")
    return True


# The plume


def smoke(voxels: int = VOXELS, seed: int = 8) -> np.ndarray:
    """A rising, widening, billowing column, (z, y, x), from 0 to 1; what is around it is empty."""
    at = (np.arange(voxels, dtype=np.float32) + 0.5) / voxels
    z, y, x = np.meshgrid(2 * at - 1, at, 2 * at - 1, indexing="ij", sparse=True)
    sway_x, sway_z = 0.16 * np.sin(5 * y) * y, 0.12 * np.cos(4 * y + 1) * y
    distance = np.hypot(x - sway_x, z - sway_z) / (0.1 + 0.45 * y**0.8)
    body = 1 - distance + 0.9 * (turbulence(voxels, seed) - 0.35) * (0.3 + y)
    return (np.clip(2 * body, 0, 1) * np.exp(-1.2 * y) * np.clip(12 * (1 - y), 0, 1)).astype(np.float32)


def turbulence(voxels: int, seed: int) -> np.ndarray:
    """Octaves of smooth noise, from 0 to about 1."""
    random = np.random.default_rng(seed)
    total = np.zeros((voxels,) * 3, np.float32)
    for octave, points in enumerate((5, 10, 20, 40, 80)):
        values = random.uniform(-1, 1, (points,) * 3).astype(np.float32)
        smooth = ndimage.zoom(values, voxels / points, order=3 if points < 80 else 1, mode="nearest", grid_mode=True)
        total += np.abs(smooth) * 0.5**octave
    return total


@dataclass(frozen=True)
class Files:
    """What the experiment consists of."""

    scene: Path
    chords: Path
    told: str


def write(folder: Path) -> Files:
    """The grid, the scene and the connections."""
    folder.mkdir(parents=True, exist_ok=True)
    samples = smoke()
    (folder / "plume.vol").write_bytes(assets.vol(samples))
    (folder / "plume.json").write_text(json.dumps(tree(folder / "plume.vol"), indent=1))
    ends = chords(CHORDS)
    (folder / "chords.f32").write_bytes(ends.astype("<f4").tobytes())
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=-1).mean()
    told = f"{100 * (samples == 0).mean():.0f} % of them empty; {CHORDS} connections of {length:.2f} m on average"
    return Files(folder / "plume.json", folder / "chords.f32", told)


def tree(grid: Path, scale: float = SCALE) -> dict:
    """The experiment as a scene."""
    extent = (BOX[1] - BOX[0]).tolist()
    to_world = [{"type": "scale", "value": extent}, {"type": "translate", "value": BOX[0].tolist()}]
    half, middle = (BOX[1] - BOX[0]) / 2, BOX.mean(axis=0)
    place = [{"type": "scale", "value": half.tolist()}, {"type": "translate", "value": middle.tolist()}]
    density = {"type": "gridvolume", "filename": str(grid), "to_world": to_world}
    medium = {"type": "heterogeneous", "sigma_t": density, "albedo": 0.0, "scale": scale, "has_spectral_extinction": False}
    turned = [{"type": "scale", "value": 20}, {"type": "rotate", "axis": [0, 1, 0], "angle": 90}]
    white = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.5, 0.5, 0.5]}}
    return {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 2, "rr_depth": 100},
        "sensor": sensor(),
        "wall": {"type": "rectangle", "to_world": [*turned, {"type": "translate", "value": [WALL, 0, 0]}], "bsdf": white},
        "light": {"type": "point", "position": list(LIGHT), "intensity": {"type": "rgb", "value": [10, 10, 10]}},
        "plume": {"type": "cube", "to_world": place, "bsdf": {"type": "null"}, "interior": medium},
    }


EYE, TARGET, FOV = (-1.05, 1.0, 0.0), (WALL, 1.0, 0.0), 120.0
"""The camera stands between the plume's box and the wall."""


def sensor() -> dict:
    """A pinhole, square image, box filter."""
    look = {"type": "lookat", "origin": list(EYE), "target": list(TARGET), "up": [0, 1, 0]}
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "pixel_format": "rgb", "rfilter": {"type": "box"}}
    return {"type": "perspective", "fov": FOV, "to_world": [look], "film": film, "sampler": {"type": "independent"}}


def chords(count: int, seed: int = 9) -> np.ndarray:
    """The connections that the camera's samples make, (count, 2, 3), cut to the box; all meet it."""
    forward = unit(np.subtract(TARGET, EYE))
    left = unit(np.cross([0, 1, 0], forward))
    up = np.cross(forward, left)
    u, v = np.tan(np.radians(FOV) / 2) * (1 - 2 * np.random.default_rng(seed).uniform(size=(2, count, 1)))
    directions = unit(forward + u * left + v * up)
    points = np.asarray(EYE) + directions * ((WALL - EYE[0]) / directions[:, :1])
    across = np.asarray(LIGHT) - points
    ends = np.sort((BOX[:, None] - points) / across, axis=0)
    first, last = np.clip(ends[0].max(axis=-1), 0, 1), np.clip(ends[1].min(axis=-1), 0, 1)
    return points[:, None] + np.stack([first, np.maximum(first, last)], axis=1)[..., None] * across[:, None]


def unit(v: np.ndarray) -> np.ndarray:
    """The vectors at length 1."""
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


# Mitsuba's times


def rendered(files: Files, variant: str, rounds: int, spp: int) -> Timing:
    """By the difference of two renders, which take turns; the first of each, which compiles, is not counted."""
    grid = files.scene.with_name("plume.vol")
    full, empty = (timed_render(Scene(tree(grid, scale), "plume"), variant, spp) for scale in (SCALE, NEXT_TO_NOTHING))
    full(0), empty(0)
    differences = [full(seed) - empty(seed) for seed in range(1, rounds + 1)]
    return Timing(f"mitsuba {variant}, volpath's shadow rays", np.array(differences) / (SIZE * SIZE * spp) * 1e9)


def timed_render(scene: Scene, variant: str, spp: int) -> Callable[[int], float]:
    """Seconds by seed."""
    loaded = mitsuba.load(scene, variant)

    def render(seed: int) -> float:
        mitsuba.use(variant)
        start = time.perf_counter()
        mitsuba.image(loaded, spp, seed)
        dr.sync_thread()
        return time.perf_counter() - start

    return render


def looped(files: Files, rounds: int) -> tuple[Timing, float, float]:
    """Ratio tracking by Mitsuba's own medium in one compiled loop, all connections at once; the mean transmittance, and
    how far from the truth one query is, relative to that mean."""
    loaded = mitsuba.load(Scene(json.loads(files.scene.read_text()), "plume"), "llvm_ad_rgb")
    [medium] = [shape.interior_medium() for shape in loaded.shapes() if shape.interior_medium() is not None]
    ends = np.fromfile(files.chords, "<f4").reshape(-1, 2, 3)
    origin, target = (mi.Point3f(ends[:, i].T) for i in range(2))
    dr.eval(origin, target)
    seconds, results = [], []
    for seed in range(rounds + 1):
        start = time.perf_counter()
        transmittance = ratio_tracked(medium, origin, target, seed)
        dr.eval(transmittance)
        dr.sync_thread()
        seconds.append(time.perf_counter() - start)
        results.append(np.array(transmittance))
    off = np.std(results, axis=0, ddof=1)
    mean = float(np.mean(results))
    timing = Timing("mitsuba llvm_ad_rgb, its medium alone", np.array(seconds[1:]) / len(ends) * 1e9)
    return timing, mean, float(np.sqrt((off**2).mean())) / mean


@dr.syntax
def ratio_tracked(medium, origin, target, seed: int):
    """An estimate of each connection's transmittance, as Mitsuba's integrators make it: at every tentative collision
    the weight is multiplied by what part of the majorant is empty."""
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, dr.width(origin))
    direction = target - origin
    length = dr.norm(direction)
    ray = mi.Ray3f(origin, dr.select(length > 0, direction / length, mi.Vector3f(0, 1, 0)))
    left, weight, active = mi.Float(length), dr.full(mi.Float, 1, dr.width(origin)), length > 0
    while active:
        ray.maxt = left
        collision = medium.sample_interaction(ray, sampler.next_1d(active), mi.UInt32(0), active)
        hit = active & collision.is_valid()
        weight[hit] = weight * collision.sigma_n[0] / collision.combined_extinction[0]
        ray.o[hit] = collision.p
        left[hit] = left - collision.t
        active &= hit & (weight > 0)
    return weight
