"""Renders every line of the table and judges those of each kind together.

A line is rendered in rounds, each a set of independent images that join the former ones, until it resolves its aim or its time
is up. How many images there are is fixed; only their samples grow, and the errors say when to stop, not the means: but a line
that looks wrong goes on, so that what chance did to few samples is not taken for a fault."""

import hashlib
import json
import multiprocessing
import os
import resource
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

import tyndall
from tyndall.failure import Failure
from tyndall.scene import Scene, changed
from validation.compare import options_of
from validation.files import made_by_command
from validation.made import Made, processor
from validation.stability import albedo, anisotropy, balls, boundaries, choices, contrast, fluence, grazing, index, lamps, overlaps, published, report, scale, thickness, trackers, voids, walks
from validation.stability.case import AIM, LIGHT_AIM, Case
from validation.stability.kept import binary
from validation.stability.judge import REQUIRED, Found, judge, level, worst
from validation.stability.report import Line

GROUPS = (thickness, albedo, anisotropy, contrast, trackers, scale, lamps, boundaries, overlaps, choices, grazing, walks, index, voids, published, balls, fluence)
"""In the order of the table."""
BATCHES = 16
"""Independent images of each line."""
PATIENCE = 900
"""Seconds after which a round counts as never finished."""
FEWEST = 16
"""Samples a pixel in each image, however little noise there is."""
GROWTH = 8
"""A round has at most so many times the samples of those before: errors told by few samples are too small where light is rare."""
MARGIN = 0.9
"""Rounds are made to reach this part of what they must resolve: the noise itself is an estimate."""
TICK = 0.004
"""Seconds of the shortest time that is told."""
PLANNED = 2048
"""Samples a pixel of the first round where a pilot or a guide is at work: with fewer there would be none."""


BUDGET, CAP = 20.0, 300.0
"""Seconds of processor time; few lines need the second."""
DOUBT = 3
"""A line that looks wrong gets so many times its budget."""


@dataclass(frozen=True)
class Effort:
    """Seconds of processor time that a line may take to resolve its aim, and to resolve what is required; the first seed; by what
    part all that is found is made greater, to test the table."""

    budget: float = BUDGET
    cap: float = CAP
    seed: int = 1
    perturbation: float = 0


@dataclass(frozen=True)
class Job:
    """A line to be rendered."""

    case: Case
    method: str
    kin: int
    """Lines of its kind."""


def jobs(only: str = "") -> list[Job]:
    """The lines whose row or name contains `only`, or one of several such texts with | between them."""
    every = [case for group in GROUPS for case in group.cases()]
    kin = Counter(case.row for case in every for _ in case.methods)
    chosen = (case for case in every if any(part in f"{case.row}: {case.name}" for part in only.split("|")))
    return [Job(case, method, kin[case.row]) for case in chosen for method in case.methods]


def run(effort: Effort, output: Path, only: str = "", quick: bool = False, workers: int | None = None, anew: bool = False) -> bool:
    """Makes the table; true if nothing in it fails or, of a perturbed one, if every line refuses what it claims to see. Lines
    that this very program has rendered before are taken over, unless `anew`. A `quick` table says that it is one."""
    chosen = jobs(only)
    if not chosen:
        raise Failure(f"no line of the stability table contains {only!r}", "name a part of a row or of a case, or leave --only out")
    records = output / "lines.jsonl"
    if anew:
        records.unlink(missing_ok=True)
    lines = []
    print(report.HEADER, flush=True)
    for line in found_lines(chosen, effort, records, workers or os.cpu_count() or 1):
        lines.append(line)
        print(report.short(line), flush=True)
    table = report.Table(lines, Made.by(made_by_command()), effort.perturbation, quick)
    table.write(output)
    print(table.summary())
    return table.holds()


def found_lines(chosen: list[Job], effort: Effort, records: Path, workers: int) -> Iterator[Line]:
    """Every line, in order. What is found is kept as it comes, so that whoever is interrupted goes on from there."""
    records.parent.mkdir(parents=True, exist_ok=True)
    told = records.read_text().splitlines() if records.is_file() else []
    kept = {record["key"]: record for record in map(json.loads, told)}
    keys = [key(job, effort) for job in chosen]
    # Processes, which tell the time of what they started; forked, as truths cannot be sent.
    with multiprocessing.get_context("fork").Pool(workers, initializer=prepare, initargs=(chosen, effort)) as pool:
        fresh = pool.imap(render, [i for i, one in enumerate(keys) if one not in kept])
        for job, one in zip(chosen, keys):
            record = kept.get(one) or {"key": one, **next(fresh)}
            if one not in kept:
                with records.open("a") as file:
                    file.write(json.dumps(record) + "\n")
            found = record["found"] and Found(**record["found"])
            yield Line(job.case, job.method, found, job.kin, record["problem"], record["on"])


def key(job: Job, effort: Effort) -> str:
    """Changes whenever what is found would."""
    case = job.case
    told = [case.row, case.name, job.method, case.scene.key(), case.seen.__name__, asdict(effort), binary()]
    return hashlib.sha256(json.dumps(told).encode() + case.expected().tobytes()).hexdigest()[:20]


def prepare(chosen: list[Job], effort: Effort) -> None:
    """What a process works on."""
    global work
    work = chosen, effort


work: tuple[list[Job], Effort]


def render(number: int) -> dict:
    """One line, for the records."""
    chosen, effort = work
    try:
        return {"found": asdict(line(chosen[number], effort)), "problem": "", "on": processor()}
    except Failure as failure:
        return {"found": None, "problem": str(failure), "on": processor()}


def line(job: Job, effort: Effort) -> Found:
    """The rounds of one line."""
    case, method = job.case, job.method
    truth, images = case.expected(), partial(raw, case, method)
    # Lines have seeds of their own, whichever of them are rendered: what chance does to one it does not do to others.
    seed = effort.seed + 1000 * (zlib.crc32(f"{case.row} {case.name}".encode()) % 100_000)
    total, done, spent, most = np.zeros(()), 0, 0.0, None
    spp = PLANNED if "+" in method else 1
    while spp:
        start = seconds()
        found = case.seen(images(spp, seed)) * (1 + effort.perturbation)
        each = max(seconds() - start, TICK) / spp
        most = worst(found, truth) if done == 0 and spp == 1 else most
        total, done, spent, seed = total + spp * found, done + spp, spent + each * spp, seed + BATCHES
        outcome = replace(judge(total / done, truth), samples=done, seconds=spent, worst=most)
        spp = more(outcome, LIGHT_AIM if method.startswith("lt") else AIM, job.kin, effort, each)
    return outcome


def more(found: Found, aim: float, kin: int, effort: Effort, each: float) -> int:
    """Samples a pixel of the next round, of `each` seconds; 0 where a line is settled or its time is up."""
    resolution, looks_wrong = found.resolution(kin), found.probability < level(kin)
    coarse = resolution > REQUIRED
    until = effort.cap if coarse else effort.budget * (DOUBT if looks_wrong else 1)
    affordable = int((until - found.seconds) / each)
    is_settled = resolution <= aim and found.samples >= FEWEST and not looks_wrong
    if is_settled or found.not_finite or affordable < 1:
        return 0
    wanted = REQUIRED if coarse and found.seconds > effort.budget else aim
    needed = np.inf if looks_wrong else found.samples * ((resolution / (MARGIN * wanted)) ** 2 - 1)
    return max(1, int(min(max(needed, FEWEST - found.samples), affordable, GROWTH * found.samples)))


def seconds() -> float:
    """Processor time of this process and of those it has run."""
    used = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def raw(case: Case, method: str, spp: int, seed: int) -> np.ndarray:
    """Independent images as they are in the file: NaN and infinities included. A contribution that the program left out because
    it was none counts as one."""
    source = Scene(changed(case.scene.source, single_precision), case.scene.name, {}, case.scene.base)
    common = {"spp": spp, "batches": BATCHES, "threads": 1, "patience": PATIENCE, "must_be_finite": False, **options_of(method)}
    sensors = [{"sensor": str(i), "seed": seed + i * SEEDS} for i in range(case.sensors)] if case.sensors > 1 else [{"seed": seed}]
    return np.concatenate([whole(tyndall.run(source, **common, **one)) for one in sensors], axis=2)


SEEDS = 100_000_000
"""Between those of two sensors."""


def whole(done: tyndall.Rendering) -> np.ndarray:
    """The images of a render."""
    images = done.batches
    assert images is not None
    if done.report["faults"]:
        images[0, 0, 0, 0] = np.nan
    return images


def single_precision(o: dict) -> dict:
    """Films that can hold 1e20; Mitsuba's default is half precision."""
    return {**o, "component_format": "float32"} if o["type"] == "hdrfilm" else o
