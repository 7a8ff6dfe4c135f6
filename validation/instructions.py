"""Instructions per sample of three scenes, counted by valgrind: a cost that needs no clock. The counts of vertices, connections
and rays are held by `cargo test` (src/render/timing.rs); instructions depend on the compiler, so they are recorded here."""

import json
import re
import shutil
import tempfile
from pathlib import Path

from validation import efficiency, tyndall
from validation.places import CROSSCHECK, REPORTS, ROOT, SCENES

GUARDED = (SCENES / "lampbox_up.xml", efficiency.FOLDER / "glass_fog_sky.xml", CROSSCHECK / "grid_sparse.json")
RECORD = REPORTS / "instructions.json"
WIDTH, HEIGHT = 32, 32
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


def per_sample(scene: Path) -> float:
    """Of a pixel sample of `bdpt`, as a pilot chooses it."""
    few, many = (instructions(scene, spp) for spp in SAMPLES)
    return (many - few) / ((SAMPLES[1] - SAMPLES[0]) * WIDTH * HEIGHT)


def instructions(scene: Path, spp: int) -> int:
    """Of a whole render on one thread."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        options = tyndall.flags({"integrator": "bdpt", "sampler": "independent", "spp": spp, "size": f"{WIDTH}x{HEIGHT}", "threads": 1, "output": Path(folder, "image.exr")})
        count = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", str(tyndall.binary()), "render", str(scene)]
        return collected(tyndall.call([*count, *options]).stderr)


def collected(text: str) -> int:
    """What valgrind says it counted."""
    [count] = re.findall(r"Collected : (\d+)", text)
    return int(count)
