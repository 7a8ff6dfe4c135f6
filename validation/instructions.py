"""Instructions per sample, counted by valgrind: a cost that needs no clock. They are recorded for three scenes. A test holds the counts
of vertices, connections and rays (src/analysis/strategies/timing.rs); instructions depend on the compiler. A table shows what is
saved by leaving out of the program what a scene does not need."""

import json
import re
import shutil
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tyndall
from tyndall import program
from tyndall.failure import Failure
from tyndall.scene import Scene, as_scene, derived, open_scene, scene_file
from validation.files import write_report
from validation.places import CROSSCHECK, EFFICIENCY, REPORTS, ROOT, SCENES

GUARDED = (SCENES / "lampbox_up.xml", EFFICIENCY / "glass_fog_sky.xml", CROSSCHECK / "grid_sparse.json")
RECORD = REPORTS / "instructions.json"
SIDE = 32
SAMPLES = (2, 6)
"""Per pixel, of two renders: their difference leaves out starting and loading."""
KEPT = 0.02
"""By what part a count may differ from the recorded one."""
LONG = (2, 26)
"""Where loading is most of the time: its instructions vary a little."""
GLOWING = "grid_sparse, glowing"
WAYS: dict[str, dict[str, Any]] = {
    "pt": {"integrator": "pt", "strategies": "hit,next-event"},
    "lt": {"integrator": "lt", "strategies": "lens"},
    "bdpt": {"integrator": "bdpt", "strategies": tyndall.ALL_STRATEGIES},
    "bdpt, guided": {"integrator": "bdpt", "strategies": tyndall.ALL_STRATEGIES, "guide": "always"},
}
"""All strategies by name: no pilot chooses."""


def run(record: bool) -> bool:
    """Prints all counts; true if they are as recorded, or are recorded now, or nothing can count them."""
    if shutil.which("valgrind") is None:
        print("valgrind was not found: instructions are not counted (Debian: apt install valgrind)")
        return True
    found = {str(path.relative_to(ROOT)): per_sample(path) for path in GUARDED}
    known = json.loads(RECORD.read_text()) if RECORD.is_file() and not record else {}
    for name, count in found.items():
        print(f"{name:36} {count:12.0f} instructions per sample {change(count, known.get(name))}")
    if not known:
        print(f"recorded now in {RECORD}" if record else "none are recorded: --record")
    if record:
        RECORD.write_text(json.dumps({name: round(count) for name, count in found.items()}, indent=1) + "\n")
    return all(abs(count / known.get(name, count) - 1) <= KEPT for name, count in found.items())


def change(count: float, known: float | None) -> str:
    """Against the recorded count."""
    return "" if known is None else f"{100 * (count / known - 1):+.2f} % of the recorded {known}"


def per_sample(scene: tyndall.AnyScene, samples: tuple[int, int] = SAMPLES, side: int = SIDE, **options: program.Option) -> float:
    """Of a pixel sample of `bdpt`, as a pilot chooses it or by other `options`, in an image of `side` x `side` pixels."""
    few, many = (instructions(scene, {"spp": spp, "size": f"{side}x{side}", **options}) for spp in samples)
    return (many - few) / ((samples[1] - samples[0]) * side * side)


def instructions(scene: tyndall.AnyScene, options: dict[str, program.Option]) -> int:
    """Of a whole render on one thread."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        usual: dict[str, program.Option] = {"integrator": "bdpt", "sampler": "independent", "threads": 1, "output": Path(folder, "image.exr")}
        count = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", str(program.binary()), "render"]
        path = scene_file(as_scene(scene), Path(folder))
        return collected(program.call([*count, str(path), *program.flags({**usual, **options})]).stderr)


def collected(text: str) -> int:
    """What valgrind says it counted."""
    [count] = re.findall(r"Collected : (\d+)", text)
    return int(count)


def scenes() -> list[Scene]:
    """One for each profile, in order."""
    smoke = open_scene(CROSSCHECK / "grid_sparse.json")
    few = (CROSSCHECK / "vacuum_room.json", SCENES / "lampbox_up.xml", EFFICIENCY / "glass_fog_sky.xml")
    fire = replace(derived(smoke, lambda o: {**o, "radiance": 1.0} if o["type"] == "heterogeneous" else o), name=GLOWING)
    coloured = (EFFICIENCY / "chromatic_fog.xml", EFFICIENCY / "pool.xml")
    return [*map(open_scene, few), smoke, fire, *map(open_scene, coloured)]


@dataclass(frozen=True)
class Cell:
    """Instructions per sample of a scene, by a profile that has what it needs and by the one that has everything."""

    profile: str
    scene: str
    way: str
    fitted: float
    everything: float

    @property
    def saved(self) -> float:
        return 1 - self.fitted / self.everything


def table(output: Path | None, workers: int = 2) -> bool:
    """Counts, and writes instructions.md."""
    if shutil.which("valgrind") is None:
        raise Failure("valgrind was not found", "apt install valgrind")
    with ThreadPoolExecutor(workers) as pool:
        cells = list(pool.map(lambda asked: cell(*asked), [(scene, way) for scene in scenes() for way in WAYS]))
    write_report("instructions", "What leaving out saves", page(cells), None, output or REPORTS)
    return True


def cell(scene: Scene, way: str) -> Cell:
    """One of the table."""
    samples = LONG if scene.name == GLOWING else SAMPLES
    fitted, everything = (per_sample(scene, samples, profile=profile, **WAYS[way]) for profile in ("fitted", "everything"))
    return Cell(profile_of(scene), scene.name, way, fitted, everything)


def profile_of(scene: Scene) -> str:
    """What `tyndall info` names."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        told = program.call([str(program.binary()), "info", str(scene_file(scene, Path(folder))), "--json"]).stdout
    return json.loads(told)["profile"]["name"]


def page(cells: list[Cell]) -> str:
    """The report."""
    return "\n".join([
        f"Instructions per sample, in thousands, by callgrind: {SIDE} x {SIDE} pixels, {SAMPLES[1]} samples a pixel less {SAMPLES[0]} (`{GLOWING}`: {LONG[1]}), so that starting, loading and learning are "
        "left out. Estimators are compiled for profiles, which leave out parts that a scene may not need; `fitted` is the one that `tyndall info` names, "
        "`everything` is `--profile everything`. Under a guide several profiles share one (src/passes/compiled.rs).\n",
        f"| profile | scene | {' | '.join(WAYS)} |", f"|---|---|{'---|' * len(WAYS)}",
        *rows(cells), "",
    ])  # fmt: skip


def rows(cells: list[Cell]) -> Iterator[str]:
    """A line for each scene: fitted, everything, and what part is saved."""
    for scene in dict.fromkeys(one.scene for one in cells):
        those = [one for one in cells if one.scene == scene]
        told = " | ".join(f"{one.fitted / 1000:.1f} of {one.everything / 1000:.1f}: {100 * one.saved:.1f} %" for one in those)
        yield f"| `{those[0].profile}` | {scene} | {told} |"
