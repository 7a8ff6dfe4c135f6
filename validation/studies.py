"""Studies of error against run time with Mitsuba among the contenders: `tyndall study`, its command line assembled."""

import argparse
import json
import math
import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation import mitsuba
from validation.contender import INTEGRATORS, VARIANTS
from validation.places import CROSSCHECK, OUTPUT, SCENES

OURS = ("bdpt", "pt", "lt")
MITSUBA = tuple(f"{kind}:{variant}" for kind in INTEGRATORS for variant in VARIANTS)
SIX = (
    SCENES / "lampbox_down.xml",  # a closed room of fog, lit directly
    SCENES / "lampbox_up.xml",  # the same room, all light indirect
    CROSSCHECK / "grid_sparse.json",  # puffs of smoke on a grid, lamp and sky
    CROSSCHECK / "grid_dense_white.json",  # a dense cloud that absorbs nothing
    CROSSCHECK / "fog_chromatic.json",  # extinction 1 : 3 : 10 between red, green and blue
    SCENES / "foggy_room.json",  # a glass ball and gold in a foggy room, two lamps
)
SIX_SIZE = "96x96"
REFERENCE = 4
"""A reference takes as long as so many contenders."""
USED = 0.8
"""Of the minutes; the rest is for pilots, starting programs, and files."""
CLAIM = 100
"""What bdpt is worth against pt where light enters through frosted glass only, at least."""


def contender(name: str) -> list[str]:
    """The options of `tyndall study` for a contender of Mitsuba's, KIND:VARIANT, or the variant of volpath alone."""
    kind, variant = name.split(":") if ":" in name else ("volpath", name)
    if kind not in INTEGRATORS or variant not in VARIANTS:
        raise Failure(f"{name}: no such contender", f"choose among {', '.join(OURS + MITSUBA)}")
    words = [os.path.relpath(sys.executable), "-m", "validation.contender", "{scene}", "{definitions}"]
    words += ["--integrator", kind, "--variant", variant, "--size", "{size}", "--threads", "{threads}"]
    words += ["--seed", "{seed}", "--spp", "{budgets}", "--folder", "{folder}"]
    return ["--external", f"mitsuba {kind} {variant}: {shlex.join(words)}"]


def usual() -> list[str]:
    """Contenders where none are named: compiled variants only where LLVM is."""
    return [*OURS[:2], *(name for name in MITSUBA if mitsuba.libllvm() or "llvm" not in name)]


def words(scenes: list[Path], contenders: list[str], options: dict[str, Any], more: list[str]) -> list[str]:
    """The command line. Mitsuba's come first: efficiencies are compared with that of the first contender."""
    ours = [name for name in contenders if name in OURS]
    theirs = [word for name in contenders if name not in OURS for word in contender(name)]
    integrators = ["--integrators", ",".join(ours)] if ours else []
    return ["study", *map(os.path.relpath, scenes), *theirs, *integrators, *program.flags(options), *more]


def run(line: list[str]) -> bool:
    """Runs the study; it prints its table and says where its page is."""
    return subprocess.run([str(program.binary()), *line], env={**os.environ, "TYNDALL_BINARY": str(program.binary())}).returncode == 0


def add_options(command: argparse.ArgumentParser, contenders: str, output: str) -> None:
    """What all studies share."""
    command.add_argument("--contenders", help=f"any of {', '.join(OURS + MITSUBA)} (default: {contenders})")
    command.add_argument("--threads", type=int, default=2, help="of all contenders alike (default %(default)s)")
    command.add_argument("--reference", type=Path, action="append", default=[], help="image (.exr, .pfm) to measure errors against, one a scene (default: one is made)")
    command.add_argument("--output", type=Path, default=OUTPUT / output, help="the study's folder (default %(default)s)")
    command.add_argument("-D", metavar="NAME=VALUE", action="append", default=[], help="a parameter of the scenes")


def common(options: argparse.Namespace) -> list[str]:
    """Those options as words."""
    references = [word for file in options.reference for word in ("--reference", str(file))]
    return [*references, *(word for pair in options.D for word in ("-D", pair)), "-o", os.path.relpath(options.output)]


def convergence(options: argparse.Namespace) -> bool:
    """Error against run time; without scenes, of six that show different things."""
    contenders = options.contenders.split(",") if options.contenders else usual()
    if not 0 < options.minutes < math.inf:
        raise Failure(f"--minutes is {options.minutes}: nothing could be done", "give a positive number of minutes")
    scenes = options.scenes or list(SIX)
    renders = len(scenes) * options.seeds * (len(contenders) + (0 if options.reference else REFERENCE))
    given = {"seconds": f"{USED * 60 * options.minutes / max(renders, 1):.3g}", "seeds": options.seeds, "doublings": options.points,
             "threads": options.threads, "size": options.size or (None if options.scenes else SIX_SIZE)}  # fmt: skip
    return run(words(scenes, contenders, given, common(options)))


def race(options: argparse.Namespace) -> bool:
    """relMSE x seconds side by side with Mitsuba; without scenes, in both lamp boxes."""
    contenders = options.contenders.split(",") if options.contenders else ["llvm_ad_rgb", "scalar_rgb", "bdpt", "pt"]
    size = [] if options.scenes else ["-D", "res=256"]
    given = {"seconds": options.seconds, "seeds": options.rounds, "doublings": 1, "threads": options.threads}
    scenes = options.scenes or [SCENES / "lampbox_down.xml", SCENES / "lampbox_up.xml"]
    return run(words(scenes, contenders, given, [*size, *common(options)]))


def pane(options: argparse.Namespace) -> bool:
    """LW96 fig. 6, light through frosted glass only: true if bdpt is at least CLAIM times as efficient as pt."""
    given = {"seconds": options.seconds, "seeds": options.rounds, "doublings": 1, "threads": options.threads, "reference_by": "--integrator bdpt"}
    if not run(words([options.scene], ["bdpt", "pt"], given, common(options))):
        return False
    [scene] = json.loads((options.output / "study.json").read_text())["scenes"]
    pt = scene["contenders"][1]
    low, mean, high = (1 / pt["ratio"][end] for end in ("high", "mean", "low"))
    print(f"bdpt against pt, relMSE in equal time: x{mean:.0f} [{low:.0f}, {high:.0f}]; claimed: at least x{CLAIM}")
    print(f"pt shows {100 * (1 + pt['points'][-1]['difference']['mean']):.1f} % of the light that there is")
    return low >= CLAIM
