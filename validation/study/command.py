"""The command `convergence`."""

import argparse
import math
import os
import platform
import subprocess
import time
from collections import Counter
from importlib.metadata import version
from pathlib import Path
from typing import Any

from validation import tyndall
from validation.failure import Failure
from validation.files import write_text
from validation.places import OUTPUT
from validation.scene import open_scene
from validation.made_by import made_by_command
from validation.study import intervals, outcome, scenes, summary
from validation.study.conduct import Found, Settings, study
from validation.study.outcome import Outcome
from validation.study.rivals import known
from validation.study.scenes import Subject
from validation.study.store import Store

TEXT = "Error against run time of Tyndall and Mitsuba, side by side; without scenes, of six standing ones."
MOST_SEEDS, MOST_POINTS = 150, 20
"""More would run into the seeds of the reference; see `conduct.one_run`."""
REPORT_PART = 0.97
"""Of the minutes; the rest is for files and the page."""


def options(command: argparse.ArgumentParser) -> None:
    """What can be asked."""
    command.add_argument("scenes", nargs="*", type=Path, metavar="SCENE", help="default: six that show different things")
    command.add_argument("--minutes", type=float, default=25, help="time for everything (default %(default)s)")
    command.add_argument("--seeds", type=int, default=8, help="independent renders of each budget (default %(default)s)")
    command.add_argument("--points", type=int, default=5, help="budgets, each twice the one before (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="of all contenders alike (default %(default)s)")
    command.add_argument("--contenders", help=f"any of {', '.join(known())} (default: all that can render a scene)")
    command.add_argument("--reference", type=Path, help=".exr, or .npz with mean and se (default: pooled of both renderers)")
    command.add_argument("--output", type=Path, default=OUTPUT / "convergence", help="the study's folder (default %(default)s)")


def run(asked: Any, size: tuple[int, int] | None, parameters: dict[str, str]) -> bool:
    """Runs the command; finished renders in the folder are not done again."""
    started = time.monotonic()
    settings = checked(asked)
    refuse_other_studies(asked.output)
    subjects = [Subject(open_scene(path, parameters), size) for path in asked.scenes] or scenes.standing()
    threads_are_bound(settings.threads)
    found: list[Found] = []
    for number, subject in enumerate(subjects):
        left = REPORT_PART * 60 * asked.minutes - (time.monotonic() - started)
        share = max(left, 1.0) / (len(subjects) - number)
        print(f"{subject.scene.name} ({number + 1} of {len(subjects)}), {share:.0f} s", flush=True)
        found.append(study(subject, settings, store_of(asked.output, subject), share))
        publish(found, asked.output, settings)  # after each: what is done can be looked at
    report(asked.output)
    print(f"made in {(time.monotonic() - started) / 60:.1f} minutes by: {made_by_command()}")
    return True


def checked(asked: Any) -> Settings:
    """What was asked for, if it makes sense."""
    if asked.seeds < 2:
        raise Failure("--seeds is below 2: no interval can be known", "give 8 or more")
    if asked.seeds > MOST_SEEDS or asked.points > MOST_POINTS:
        raise Failure("--seeds or --points is too great", f"give at most {MOST_SEEDS} seeds and {MOST_POINTS} points")
    for name in ("points", "threads", "minutes"):
        if not 0 < getattr(asked, name) < math.inf:
            raise Failure(f"--{name} is {getattr(asked, name)}: nothing could be done", f"give a positive --{name}")
    if asked.reference and len(asked.scenes) != 1:
        raise Failure("--reference belongs to one scene", "name just that scene")
    if asked.reference and not asked.reference.is_file():
        raise Failure(f"{asked.reference}: no such reference", "name an .exr, or an .npz with mean and se")
    if not asked.scenes and (asked.size or asked.D):
        raise Failure("--size and -D belong to scenes that are named", "name scenes; the six standing ones are as they are")
    names = [path.stem for path in asked.scenes]
    if len(set(names)) < len(names):
        raise Failure("two scenes have one name, which would be that of their folders too", "study them one at a time")
    contenders = asked.contenders.split(",") if asked.contenders else None
    twice = [name for name, count in Counter(contenders or []).items() if count > 1]
    if twice:
        raise Failure(f"--contenders names {' and '.join(twice)} more than once", "name everyone once")
    return Settings(contenders, asked.seeds, asked.points, asked.threads, asked.reference)


def refuse_other_studies(folder: Path) -> None:
    """A folder of `tyndall study`, whose plan lies elsewhere, is not written into."""
    runs = folder / "runs"
    if (runs / "plan.json").is_file() or (folder / outcome.FILE).is_file() and not any(runs.glob("*/plan.json")):
        raise Failure(f"{folder} holds a study that was made otherwise, as by `tyndall study`", "name another --output")


def threads_are_bound(threads: int) -> None:
    """Leaves this process, and all it starts, as many cores as it has threads: the same ones for all contenders."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])


def store_of(folder: Path, subject: Subject) -> Store:
    """Where a scene's renders are kept."""
    return Store(folder / "runs" / subject.scene.name)


def publish(found: list[Found], folder: Path, settings: Settings) -> None:
    """Writes numbers, tables and images of all that is done."""
    folder.mkdir(parents=True, exist_ok=True)
    stores = [store_of(folder, one.subject) for one in found]
    entries = [summary.scene_outcome(one, store, folder) for one, store in zip(found, stores)]
    whole = Outcome(renderers(), made_by_command(), machine(settings.threads), intervals.CONFIDENCE, entries)
    outcome.write(whole, folder)
    summary.write_csv(folder / "study.csv", [row for one, store in zip(found, stores) for row in summary.rows(one, store)])
    write_text(folder / "study.md", summary.markdown(whole))


def report(folder: Path) -> None:
    """Lets the program make the page of the folder."""
    done = subprocess.run([str(tyndall.binary()), "report", str(folder)], capture_output=True, text=True)
    if done.returncode == 0:
        print(done.stdout.strip() or f"{folder}/study.html")
    else:
        raise Failure(f"tyndall report {folder}: {done.stderr.strip()}", "see its message; the numbers are written")
    print(f"numbers are in {folder}/study.json, study.csv and study.md")


def renderers() -> str:
    """Programs and versions."""
    own = subprocess.run([str(tyndall.binary()), "--version"], capture_output=True, text=True).stdout.strip()
    return f"{own}, Mitsuba {version('mitsuba')} (Dr.Jit {version('drjit')})"


def machine(threads: int) -> str:
    """Processor and threads."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.is_file() else []
    name = next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
    return f"{name or platform.processor() or platform.machine()}, {threads} threads for each contender"
