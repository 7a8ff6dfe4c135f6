"""Instructions per sample of three scenes, counted by valgrind: a cost that needs no clock. The counts of vertices, connections
and rays are held by a test (src/analysis/strategies/timing.rs); instructions depend on the compiler, so they are recorded here."""

import json
import re
import shutil
import tempfile
from pathlib import Path

import tyndall
from tyndall import program
from tyndall.scene import as_scene, scene_file
from validation.places import CROSSCHECK, EFFICIENCY, REPORTS, ROOT, SCENES

GUARDED = (SCENES / "lampbox_up.xml", EFFICIENCY / "glass_fog_sky.xml", CROSSCHECK / "grid_sparse.json")
RECORD = REPORTS / "instructions.json"
SIDE = 32
SAMPLES = (2, 6)
"""Per pixel, of two renders: their difference leaves out starting and loading."""
KEPT = 0.02
"""By what part a count may differ from the recorded one."""


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
