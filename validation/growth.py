"""How the cost of a sample grows with the scene and with what is asked for: depth, triangles, voxels, lights, pixels, samples,
threads; and how long the program takes to start. Instructions, counted by valgrind, where that says enough; seconds else."""

import argparse
import math
import os
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import tyndall
from tyndall import program
from tyndall.failure import Failure
from tyndall.volume_file import vol
from validation import instructions
from validation.closed_forms.case import diffuse, film, rgb
from validation.files import write_report
from validation.places import REPORTS, SCENES

SAMPLES = (1, 3)
"""Per pixel, of two renders whose difference is counted."""
MANY_SAMPLES = (1, 41)
"""Where loading is most of the time: hashing makes its instructions vary a little."""


@dataclass(frozen=True)
class Curve:
    """What a cost depends on, and the cost."""

    over: str
    of: str
    points: list[tuple[float, float]]
    remark: str = ""
    most: float = math.inf
    """How many times the first point the last may be, at most."""

    @property
    def growth(self) -> float:
        return self.points[-1][1] / self.points[0][1]

    @property
    def holds(self) -> bool:
        return self.growth <= self.most


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--threads", action="store_true", help="only the speed by threads, beside as many processes: threads.md; needs an idle machine")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for growth.md or threads.md, and .json (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures, writes the report, and judges."""
    if options.threads:
        curves = list(threads())
        write_report("threads", "How speed grows with threads", "\n".join(map(line, curves)), {"curves": [asdict(curve) for curve in curves]}, options.output)
        return True
    if shutil.which("valgrind") is None:
        raise Failure("valgrind was not found", "apt install valgrind")
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        curves = list(curves_in(Path(folder)))
    start = starting()
    write_report("growth", "How cost grows", page(curves, start), {"curves": [asdict(curve) for curve in curves], "start_seconds": start}, options.output)
    return all(curve.holds for curve in curves) and start < LONGEST_START


def depth(most: int, _: Path) -> float:
    """A closed room of fog that absorbs nothing: every walk is as long as it may be."""
    return counted(white_room(), SAMPLES, side=6, max_depth=most) / most


def triangles(count: int, folder: Path) -> float:
    """A rough ball in fog."""
    path = folder / f"ball_{count}.ply"
    path.write_bytes(ball(max(2, round(math.sqrt(count / 2)))))
    return counted(box_of_fog({"ball": {"type": "ply", "filename": str(path), "bsdf": grey(0.6)}}), MANY_SAMPLES)


def voxels(side: int, folder: Path) -> float:
    """The same smoke in ever finer voxels."""
    path = folder / f"smoke_{side}.vol"
    path.write_bytes(vol(smoke(side)))
    return counted(box_of_smoke(path), SAMPLES)


def lights(count: int, _: Path) -> float:
    """Small lamps all over a box of fog."""
    at = np.random.default_rng(1).uniform(-1, 1, (count, 3))
    lamps = {f"lamp{i}": {"type": "point", "position": [float(x) for x in place], "intensity": rgb(1 / count)} for i, place in enumerate(at)}
    return counted(box_of_fog(lamps), MANY_SAMPLES)


def pixels(side: int, _: Path) -> float:
    """One scene in ever larger images."""
    return counted(SCENES / "lampbox_up.xml", SAMPLES, side=side)


def counted(scene: tyndall.AnyScene, samples: tuple[int, int], **options: Any) -> float:
    """Instructions of a sample by all strategies."""
    return instructions.per_sample(scene, samples, strategies=tyndall.ALL_STRATEGIES, **options)


def memory(spp: int, folder: Path) -> float:
    """Of ever more samples."""
    command = [str(program.binary()), "--quiet", "render", str(SCENES / "lampbox_up.xml"), "-o", str(folder / "image.exr")]
    return most_memory([*command, "--spp", str(spp), "--size", "256x256", "--threads", "1", "--strategies", tyndall.ALL_STRATEGIES])


COUNT = "instructions per sample"
COSTS: tuple[tuple[Callable[[int, Path], float], Sequence[int], tuple[str, str, str, float]], ...] = (
    (depth, (8, 32, 128, 512, 2000), ("greatest depth", f"{COUNT} over the depth", "white fog in a white room", 1.1)),
    (triangles, (200, 2_000, 20_000, 200_000, 2_000_000), ("triangles", COUNT, "a rough ball in fog", math.inf)),
    (voxels, (16, 32, 64, 128, 256), ("voxels along a side", COUNT, "the same smoke under a sky and a sun", math.inf)),
    (lights, (1, 10, 100, 1_000, 10_000, 100_000), ("lights", COUNT, "point lights all over a box of fog", math.inf)),
    (pixels, (8, 16, 32, 64, 128, 256), ("pixels along a side", COUNT, "lampbox_up", 1.1)),
    (memory, (1, 4, 16, 64), ("samples per pixel", "greatest memory in MB", "lampbox_up, 256 x 256", 1.05)),
)
"""What costs, where it is measured, and what the curve says of it."""
TURNS = 3
LONGEST_START = 0.01
"""Seconds from the command to its end, where there is nothing to do."""


def curves_in(folder: Path) -> Iterator[Curve]:
    """All that is counted, printed as they come."""
    for cost, at, (over, of, remark, most) in COSTS:
        yield told(Curve(over, of, [(x, cost(x, folder)) for x in at], remark, most))


def told(found: Curve) -> Curve:
    """Printed."""
    print(line(found), flush=True)
    return found


def threads() -> Iterator[Curve]:
    """Samples per second over those of one thread: by more threads in a process, and by as many processes of one thread each. Losses that
    processes have too are the machine's: shared caches, clocks, two threads to a core."""
    counts = [2**i for i in range((os.cpu_count() or 1).bit_length())]
    turns = [(seconds(1), [seconds(n) for n in counts], [at_once(n) for n in counts]) for _ in range(TURNS)]
    remark = f"lampbox_up, 256 x 256; the median of {TURNS} turns, seconds by a clock"
    for over, speeds in (
        ("threads", [[alone / each for each in by] for alone, by, _ in turns]),
        ("processes", [[n * alone / each for n, each in zip(counts, by)] for alone, _, by in turns]),
    ):
        yield told(Curve(over, "times the speed of one", [(n, float(np.median(of))) for n, of in zip(counts, zip(*speeds))], remark))


def seconds(count: int) -> float:
    """Of a render on so many threads."""
    options: dict[str, Any] = {"spp": 12, "size": (256, 256), "strategies": tyndall.ALL_STRATEGIES}
    return tyndall.run(SCENES / "lampbox_up.xml", threads=count, **options).render_seconds


def at_once(count: int) -> float:
    """Of the same render on one thread, the mean of so many processes that run together."""
    with ThreadPoolExecutor(count) as pool:
        return float(np.mean(list(pool.map(lambda _: seconds(1), range(count)))))


def most_memory(command: list[str]) -> float:
    """Of a command, in MB, as the kernel has it while it runs: what a process may be told afterwards is no less than this one had."""
    most = 0
    with subprocess.Popen(command) as process:
        while process.poll() is None:
            told = re.search(r"VmHWM:\s+(\d+)", Path(f"/proc/{process.pid}/status").read_text())
            most = max(most, int(told[1])) if told else most
            time.sleep(0.002)
    if process.returncode:
        raise Failure(f"{' '.join(command)}: failed", "run the command by hand")
    return most / 1024


def starting() -> float:
    """The least seconds of many starts."""
    found = []
    for _ in range(50):
        start = time.perf_counter()
        program.call([str(program.binary()), "--version"])
        found.append(time.perf_counter() - start)
    return min(found)


def grey(value: float) -> dict[str, Any]:
    return {"type": "twosided", "bsdf": diffuse(value)}


def view(medium: str | None = None) -> dict[str, Any]:
    """From outside, or in a medium."""
    inside = {"medium": {"type": "ref", "id": medium}} if medium else {}
    origin = [0.2, 0.1, 0.9] if medium else [0.3, 0.4, 4]
    looking = [{"type": "lookat", "origin": origin, "target": [0, 0, 0], "up": [0, 1, 0]}]
    return {"type": "perspective", "fov": 40, "to_world": looking, "film": film(instructions.SIDE, instructions.SIDE), "sampler": {"type": "independent"}, **inside}


def white_room() -> dict[str, Any]:
    """Nothing absorbs, and nothing gets out; the lamp reflects what it does not emit."""
    lamp = {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.3}, {"type": "translate", "value": [0, 0, -0.5]}]}
    return {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 8},
        "fog": {"type": "homogeneous", "id": "fog", "sigma_t": 1.0, "albedo": 1.0},
        "sensor": view("fog"),
        "room": {"type": "cube", "bsdf": grey(1.0), "interior": {"type": "ref", "id": "fog"}},
        "lamp": {**lamp, "bsdf": grey(1.0), "emitter": {"type": "area", "radiance": rgb(1.0)}},
    }


def box_of_fog(more: dict[str, Any]) -> dict[str, Any]:
    """A box of thin fog around what there is more, under a sky."""
    fog = {"type": "homogeneous", "id": "fog", "sigma_t": 0.5, "albedo": 0.9}
    box = {"type": "cube", "to_world": [{"type": "scale", "value": 1.2}], "bsdf": {"type": "null"}, "interior": fog}
    sky = {"sky": {"type": "constant", "radiance": rgb(0.2)}} if not any(o["type"] == "point" for o in more.values()) else {}
    return {"type": "scene", "integrator": {"type": "volpath", "max_depth": 8}, "sensor": view(), "box": box, **sky, **more}


def box_of_smoke(path: Path) -> dict[str, Any]:
    """A box of voxels under a sky and a sun."""
    to_world = [{"type": "translate", "value": [-0.5, -0.5, -0.5]}, {"type": "scale", "value": 2}]
    grid = {"type": "gridvolume", "filename": str(path), "to_world": to_world}
    smoke = {"type": "heterogeneous", "sigma_t": grid, "albedo": 0.9, "scale": 4.0}
    box = {"type": "cube", "bsdf": {"type": "null"}, "interior": smoke}
    sun = {"type": "directional", "direction": [-1, -1, -0.5], "irradiance": rgb(1.0)}
    sky = {"type": "constant", "radiance": rgb(0.2)}
    return {"type": "scene", "integrator": {"type": "volpath", "max_depth": 8}, "sensor": view(), "box": box, "sun": sun, "sky": sky}


def smoke(side: int) -> np.ndarray:
    """A ball with billows, sampled at the voxels' centres."""
    at = (np.arange(side, dtype=np.float32) + 0.5) / side - 0.5
    z, y, x = np.meshgrid(at, at, at, indexing="ij", sparse=True)
    radius = np.sqrt(x * x + y * y + z * z)
    waves = np.sin(19 * x) * np.sin(23 * y + 1) * np.sin(17 * z + 2)
    return np.clip(8 * (0.36 - radius) + 1.2 * waves, 0, 1).astype(np.float32)


def ball(side: int) -> bytes:
    """A PLY file of 2 side^2 triangles."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, side + 1), np.linspace(0, np.pi, side + 1))
    radius = 0.8 + 0.05 * np.sin(7 * u) * np.sin(9 * v)
    places = np.stack([radius * np.sin(v) * np.cos(u), radius * np.cos(v), radius * np.sin(v) * np.sin(u)], axis=-1).astype("<f4")
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    corners = np.stack([first, first + 1, first + side + 1, first + 1, first + side + 2, first + side + 1], axis=-1).reshape(-1, 3)
    faces = np.empty(len(corners), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, corners
    vertices = places.reshape(-1, 3)
    names = "".join(f"property float {name}\n" for name in "xyz")
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{names}element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    return header.encode() + vertices.tobytes() + faces.tobytes()


def page(curves: list[Curve], start: float) -> str:
    """All curves in Markdown."""
    wanted = "at most" if start < LONGEST_START else "MORE than"
    return "\n".join([
        *(line(curve) + "\n" for curve in curves),
        f"Start of the program: {1000 * start:.1f} ms ({wanted} {1000 * LONGEST_START:g} ms).", "",
    ])  # fmt: skip


def line(curve: Curve) -> str:
    """A curve in Markdown, with how much it grows."""
    x = " | ".join(f"{at:,.0f}" for at, _ in curve.points)
    y = " | ".join(f"{value:,.4g}" if value < 1000 else f"{value:,.0f}" for _, value in curve.points)
    bound = "" if math.isinf(curve.most) else f"; at most {curve.most:g}: {'holds' if curve.holds else 'FAILS'}"
    rule = "|---" * (len(curve.points) + 1) + "|"
    return f"{curve.remark}: x {curve.growth:.3g} from first to last{bound}\n\n| {curve.over} | {x} |\n{rule}\n| {curve.of} | {y} |\n"
