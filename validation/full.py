"""Everything that can be checked, at full depth: what the tests sample."""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tyndall import program
from tyndall.failure import Failure
from validation import matrix, package_tests, page, truths, viewing
from validation.compare import Effort
from validation.places import CROSSCHECK, OUTPUT
from validation.stability import run as stability

TEXT = "Scenes against Mitsuba as it renders now, closed forms, stability and two pages in a browser, at full depth: about an hour of two cores."


def run() -> bool:
    """Runs every part, whatever the others find; true if all hold."""
    parts: dict[str, Callable[[], bool]] = {
        "package": package_tests.run,
        "page in a browser": study_page,
        "view in a browser": lambda: viewing.run(OUTPUT / "view", if_possible=True),
        "closed forms": lambda: truths.run(Effort(batches=16, spp=512)),
        "stability": lambda: stability.run(stability.Effort(), OUTPUT / "stability"),
        "matrix": lambda: matrix.live(count=matrix.DEEP_CELLS),
    }
    found = {name: timed(name, part) for name, part in parts.items()}
    for name, (holds, seconds) in found.items():
        print(f"{name:24} {'holds' if holds else 'FAILS':8} {seconds:7.0f} s")
    failing = [name for name, (holds, _) in found.items() if not holds]
    minutes = sum(seconds for _, seconds in found.values()) / 60
    print(f"{', '.join(failing)}: FAILS" if failing else "everything holds", f"({minutes:.0f} minutes)")
    return not failing


def timed(name: str, part: Callable[[], bool]) -> tuple[bool, float]:
    """What a part finds and how long it takes; one that cannot be run does not hold."""
    print(f"\n{name}:", flush=True)
    start = time.perf_counter()
    try:
        holds = part()
    except Failure as failure:
        print(failure, flush=True)
        holds = False
    return holds, time.perf_counter() - start


def study_page() -> bool:
    """The page of a small study."""
    scenes = [str(CROSSCHECK / name) for name in ("cube_in_room.json", "vacuum_room.json")]
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        effort = ["--spp", "8", "--doublings", "4", "--seeds", "2", "--reference-spp", "64", "--size", "24x18"]
        program.call([str(program.binary()), "study", *scenes, "-o", folder, *effort])
        return page.run(Path(folder, "study.html"), OUTPUT / "page", if_possible=True)
