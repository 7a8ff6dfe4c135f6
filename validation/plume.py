"""Nanoseconds per transmittance query on a plume of 256^3 voxels.

The experiment: a wall beside a plume is lit by a point on the other side, and a camera between both looks at the wall.
Paths have two edges, so that every sample makes one query: the connection of a point of the wall with the light,
through the plume. Mitsuba's time for it is the difference between this render and the same one with next to no smoke. Its own
loop over the medium, compiled alone, is timed on the same connections besides; that is what a query costs without rays
against boundaries. The connections, cut to the plume's box, are written to a file, and Tyndall's trackers are timed on
them by a test of theirs (src/medium/distance/tests/plume.rs).

Times differ, and so does what is got for them: a random query's standard deviation is told too, and its variance times
its time.
"""

import json
import os
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy import ndimage

from tyndall.failure import Failure
from tyndall.scene import Scene
from tyndall.volume_file import vol
from validation import mitsuba
from validation.places import OUTPUT, ROOT

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
    """A renderer's nanoseconds, and how far from the truth one query of it is."""

    name: str
    query: list[float]
    """The least and the middle of the repetitions [ns]."""
    off: float | None = None
    """Standard deviation of one query over the mean transmittance."""
    flight: list[float] | None = None
    """The same for a sampled flight [ns]."""
    told: str = ""

    def row(self, rival: "Timing") -> str:
        """A line of the table; `rival` has the time that others are compared with."""
        least, middle = self.query
        flight = f"{self.flight[1]:10.0f}" if self.flight else " " * 10
        off = f"{self.off:8.3f}" if self.off is not None else " " * 8
        return f"{self.name:44} {least:10.0f} {middle:10.0f} {rival.query[1] / middle:8.1f} {off} {flight}  {self.told}"


HEADER = f"{'':44} {'ns, least':>10} {'middle':>10} {'faster':>8} {'off':>8} {'flight':>10}"


def run(rounds: int, spp: int) -> bool:
    """Prints all times; one thread."""
    dr.set_thread_count(1)
    files = write(FOLDER)
    print(f"{VOXELS}^3 voxels, {files.told}; scene {files.scene}, connections {files.chords}")
    print(f"load of the machine's {os.cpu_count()} processors before: {os.getloadavg()[0]:.1f}", flush=True)
    loop, mean = looped(files, rounds)
    print(HEADER)
    for variant in ("scalar_rgb", "llvm_ad_rgb"):
        print(rendered(files, variant, rounds, spp).row(loop), flush=True)
    print(loop.row(loop), flush=True)
    told, ours = tyndalls(FOLDER)
    for one in ours:
        print(one.row(loop))
    print("faster: than Mitsuba's medium alone; off: standard deviation of one query over the mean transmittance,")
    print(f"which is {mean:.5f} by Mitsuba (all connections), {told['truth']:.5f} by quadrature ({told['sought']} of them)")
    for one in ours:
        if one.off and loop.off:
            ratio = loop.query[1] * loop.off**2 / (one.query[1] * one.off**2)
            print(f"{one.name}: time x variance is {1 / ratio:.2f} times that of Mitsuba's medium alone")
    print(f"load of the machine afterwards: {os.getloadavg()[0]:.1f}")
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
    (folder / "plume.vol").write_bytes(vol(samples))
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
    return Timing(f"mitsuba {variant}, volpath's shadow rays", middle(np.array(differences) / (SIZE * SIZE * spp)))


def middle(seconds: np.ndarray) -> list[float]:
    """The least and the middle, in ns."""
    return [1e9 * float(of(seconds)) for of in (np.min, np.median)]


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


def looped(files: Files, rounds: int) -> tuple[Timing, float]:
    """Ratio tracking by Mitsuba's own medium in one compiled loop, all connections at once; and the mean
    transmittance."""
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
    deviation = np.sqrt((np.std(results, axis=0, ddof=1) ** 2).mean())
    mean = float(np.mean(results))
    times = middle(np.array(seconds[1:]) / len(ends))
    return Timing("mitsuba llvm_ad_rgb, its medium alone", times, float(deviation) / mean), mean


@dr.syntax
def ratio_tracked(medium: Any, origin: Any, target: Any, seed: int) -> Any:
    """An estimate of each connection's transmittance, as Mitsuba's integrators make it: at every tentative collision
    the weight is multiplied by what part of the majorant is empty."""
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, dr.width(origin))
    direction = target - origin
    length: Any = dr.norm(direction)
    ray: Any = mi.Ray3f(origin, dr.select(length > 0, direction / length, mi.Vector3f(0, 1, 0)))
    left: Any = mi.Float(length)
    weight, active = dr.full(mi.Float, 1, dr.width(origin)), length > 0
    while active:
        ray.maxt = left
        collision = medium.sample_interaction(ray, sampler.next_1d(active), mi.UInt32(0), active)
        hit = active & collision.is_valid()
        weight[hit] = weight * collision.sigma_n[0] / collision.combined_extinction[0]
        ray.o[hit] = collision.p
        left[hit] = left - collision.t
        active &= hit & (weight > 0)
    return weight


# Tyndall's times

TEST = "medium::distance::tests::plume"
COMMAND = ["cargo", "test", "--release", "--lib", TEST, "--", "--ignored", "--nocapture"]
MARK = "plume {"
"""What the test has to tell stands on lines that begin with this."""


def tyndalls(folder: Path) -> tuple[dict, list[Timing]]:
    """All trackers on the connections; what the test tells of these, and the times."""
    variables = {**os.environ, "TYNDALL_PLUME": str(folder)}
    done = subprocess.run(COMMAND, cwd=ROOT, env=variables, capture_output=True, text=True)
    told = [json.loads(line.removeprefix("plume ")) for line in done.stdout.splitlines() if line.startswith(MARK)]
    if done.returncode != 0 or not told:
        raise Failure(f"{' '.join(COMMAND)}\n  {done.stderr.strip()[-4000:]}", "run the command by hand")
    [facts, overhead, *trackers] = told
    return facts, [timing(tracker, overhead["overhead"][0]) for tracker in trackers]


def timing(tracker: dict, overhead: float) -> Timing:
    """A tracker's times without what it costs to ask."""
    name, less = tracker["tracker"], lambda times: [time - overhead for time in times]
    bias = f"mean off by {100 * tracker['bias']:+.4f} +- {100 * tracker['error']:.4f} %"
    if name == "march":
        bias += f"; step {tracker['step']:.2g} m, largest error {tracker['worst']:.1e}"
    off = tracker["off"] or None
    return Timing(f"tyndall {name}, with what weights need", less(tracker["query"]), off, less(tracker["flight"]), bias)
