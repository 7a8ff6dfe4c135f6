"""Nanoseconds per ray, against Embree's queries of single rays, on one core: two meshes, rays that have nothing in common."""

import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from tyndall.failure import Failure
from validation import environment, growth
from validation.places import ROOT

REQUIREMENTS = ROOT / "validation" / "requirements-rays.txt"
SIDES = (250, 700)
"""Of balls of 125,000 and 980,000 triangles."""
COUNT, ROUNDS = 1 << 14, 100
"""Rays, and how they are timed: all in every round, of which the fastest counts, as other programs come and go."""
UNITS = {"ns": 1.0, "µs": 1e3, "ms": 1e6, "s": 1e9}
WANTED = 0.8
"""At least so many times as fast as Embree."""


def run() -> bool:
    """Prints a line a mesh; true if both are fast enough."""
    environment.extra(REQUIREMENTS)
    print("| triangles | query | Tyndall, ns | Embree 4, ns | times as fast |\n|---|---|---|---|---|")
    return all([measured(side) for side in SIDES])


def measured(side: int) -> bool:
    """Both queries of one mesh."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        mesh, rays = growth.ball(side), across(np.random.default_rng(side))
        Path(folder, "mesh.ply").write_bytes(mesh)
        Path(folder, "rays.f32").write_bytes(rays.tobytes())
        ours, hits = tyndall(folder)
        theirs, found = embree(mesh, rays)
    if abs(hits - found) > 2:
        raise Failure(f"{hits} of {COUNT} rays hit the ball in Tyndall, {found} in Embree", "find out which is wrong")
    for query, own, other in zip(("closest", "occluded"), ours, theirs):
        print(f"| {2 * side * side} | {query} | {own:.0f} | {other:.0f} | {other / own:.2f} |")
    return all(other / own >= WANTED for own, other in zip(ours, theirs))


def across(random: np.random.Generator) -> np.ndarray:
    """From anywhere around the ball in any direction."""
    rays = np.empty((COUNT, 6), dtype="<f4")
    rays[:, :3] = random.uniform(-1, 1, (COUNT, 3))
    direction = random.normal(size=(COUNT, 3))
    rays[:, 3:] = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    return rays


def tyndall(folder: str) -> tuple[tuple[float, float], int]:
    """Nanoseconds of both queries, and how many rays hit."""
    command = ["cargo", "bench", "--quiet", "--bench", "benches", "--", "closest", "occluded", "--sample-count", str(ROUNDS)]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, "TYNDALL_RAYS": folder}, capture_output=True, text=True)
    times = re.findall(rf"{re.escape(folder)} +([\d.]+) (ns|µs|ms|s) ", done.stdout)
    hits = re.search(rf"{re.escape(folder)}: (\d+) rays hit", done.stderr)
    if len(times) != 2 or hits is None:
        raise Failure(f"{' '.join(command)}: {done.stderr[-2000:]}", "run the command by hand")
    closest, occluded = (float(time) * UNITS[unit] / COUNT for time, unit in times)
    return (closest, occluded), int(hits[1])


def embree(mesh: bytes, rays: np.ndarray) -> tuple[tuple[float, float], int]:
    """The same; the loop over rays is compiled, and its own time counts."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    TriangleMesh(scene, corners(mesh))
    origins, directions = (np.ascontiguousarray(rays[:, half]) for half in (slice(0, 3), slice(3, 6)))
    hits = int((scene.run(origins, directions, query="DISTANCE") < 1e30).sum())
    return (timed(scene, origins, directions, "DISTANCE"), timed(scene, origins, directions, "OCCLUDED")), hits


def corners(mesh: bytes) -> np.ndarray:
    """Of every triangle of `growth.ball`, (triangle, corner, axis)."""
    header, body = mesh.split(b"end_header\n", 1)
    [count] = re.findall(rb"element vertex (\d+)", header)
    places = np.frombuffer(body[: 12 * int(count)], "<f4").reshape(-1, 3)
    faces = np.frombuffer(body[12 * int(count) :], dtype=[("count", "u1"), ("corners", "<i4", 3)])["corners"]
    return places[faces].astype(np.float32)


def timed(scene: object, origins: np.ndarray, directions: np.ndarray, query: str) -> float:
    """Nanoseconds per ray."""
    def time_of() -> float:
        start = time.perf_counter()
        scene.run(origins, directions, query=query)  # type: ignore[attr-defined]
        return time.perf_counter() - start

    return min(time_of() for _ in range(ROUNDS)) / COUNT * 1e9
