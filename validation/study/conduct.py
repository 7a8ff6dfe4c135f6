"""One scene's study: pilots, budgets, the reference, then all contenders taking turns on the same cores."""

import hashlib
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from validation import exr, tyndall
from validation.failure import Failure
from validation.study import plan, tree, truth
from validation.study.measures import Measures, measures
from validation.study.rivals import Rival, rivals, unusual, usual
from validation.study.scenes import Subject
from validation.study.store import Run, Store
from validation.study.truth import Truth

LEAST_SEEDS = 2
"""Rounds that are rendered even where time is up."""
PILOTS_PART = 0.08
"""Of the time there is."""


@dataclass(frozen=True)
class Settings:
    """What was asked for."""

    contenders: list[str] | None
    """None: all that can render the scene."""
    seeds: int
    points: int
    threads: int
    reference: Path | None


@dataclass(frozen=True)
class Found:
    """All that a scene's study has in the end."""

    subject: Subject
    truth: Truth
    rivals: list[Rival]
    samples: dict[str, list[int]]
    """Budgets by contender."""
    load_seconds: dict[str, float | None]
    seeds: int
    """Rounds that are complete."""
    notes: list[str]
    """What there is to say about all of it."""


def study(subject: Subject, settings: Settings, store: Store, seconds: float) -> Found:
    """Does what is not done yet, in about so many seconds."""
    started = time.monotonic()
    names = settings.contenders or usual(subject.scene)
    absent = {} if settings.contenders else unusual(subject.scene)
    contenders = rivals(subject.scene, names, subject.size, settings.threads)
    given = given_truth(subject, settings)
    planned = made_plan(subject, contenders, settings, store, seconds)
    contenders = [rival for rival in contenders if rival.name not in planned["left_out"]]
    reference = given or made_truth(contenders, planned, store)
    seeds = take_turns(contenders, planned, reference, settings.seeds, store, started + seconds)
    notes = told(absent | planned["left_out"], reference, seeds, settings.seeds)
    return Found(subject, reference, contenders, planned["samples"], planned["load_seconds"], seeds, notes)


def told(absent: dict[str, str], reference: Truth, seeds: int, wanted: int) -> list[str]:
    """A scene's notes."""
    notes = [f"{name} is left out: {why}" for name, why in absent.items()]
    notes += [reference.warning] if reference.warning else []
    notes += [f"time was up after {seeds} of {wanted} seeds; the same command again goes on"] if seeds < wanted else []
    notes += ["nobody knows the reference's own error"] if reference.own_relmse is None else []
    return notes


def identity(subject: Subject, contenders: list[Rival], settings: Settings) -> dict[str, Any]:
    """Kept renders belong to a plan only if all of this is the same."""
    return {
        "tyndall": digest(tyndall.binary()),
        "mitsuba": version("mitsuba"),
        "scene": subject.scene.key(),
        "size": subject.size and list(subject.size),
        "contenders": [rival.name for rival in contenders],
        "points": settings.points,
        "threads": settings.threads,
        "reference": settings.reference and digest(settings.reference),
    }


def digest(path: Path) -> str:
    """Changes with a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def made_plan(
    subject: Subject, contenders: list[Rival], settings: Settings, store: Store, seconds: float
) -> dict[str, Any]:
    """The kept plan, or a new one by pilots."""
    wanted, kept = identity(subject, contenders, settings), store.plan()
    if kept and kept["identity"] != wanted:
        problem = f"{store.folder} holds renders of another study: other scene, settings, or program"
        raise Failure(problem, "name another --output, or delete that folder")
    if kept:
        return {"left_out": {}, **kept}
    store.refuse_strangers()
    started = time.monotonic()
    pilots, left_out = all_pilots(contenders, PILOTS_PART * seconds / len(contenders))
    left = seconds - (time.monotonic() - started)
    top = plan.top_seconds(max(left, seconds / 4), len(pilots), settings.seeds, settings.points)
    made = {
        "identity": wanted,
        "samples": {name: plan.budgets(p.rate, top, settings.points) for name, p in pilots.items()},
        "reference": plan.reference_samples(pilots, max(left, seconds / 4)),
        "load_seconds": {rival.name: rival.load_seconds for rival in contenders if rival.name in pilots},
        "left_out": left_out,
    }
    store.keep_plan(made)
    return made


def all_pilots(contenders: list[Rival], seconds: float) -> tuple[dict[str, plan.Pilot], dict[str, str]]:
    """Everyone's pilot, and why there is none of those who cannot render the scene."""
    pilots: dict[str, plan.Pilot] = {}
    left_out: dict[str, str] = {}
    for rival in contenders:
        try:
            pilots[rival.name] = told_pilot(rival, seconds)
        except Failure as failure:
            left_out[rival.name] = failure.problem
            print(f"  {rival.name:32} is left out: {failure.problem}", flush=True)
    if not pilots:
        raise Failure(f"no contender can render the scene: {next(iter(left_out.values()))}", "mend the scene, or name other --contenders")
    return pilots, left_out


def told_pilot(rival: Rival, seconds: float) -> plan.Pilot:
    """A pilot, with a line about it. Loading and the last two renders take their part of the time too."""
    found = plan.pilot(rival, seconds / 4)
    load = f"{rival.load_seconds:.2f} s" if rival.load_seconds is not None else "not told"
    print(f"  {rival.name:32} loads in {load}, {found.rate:.4g} samples per pixel and second", flush=True)
    return found


def given_truth(subject: Subject, settings: Settings) -> Truth | None:
    """The reference that was given, which must fit before anything is rendered."""
    if settings.reference is None:
        return None
    found = truth.given(settings.reference)
    return truth.of_size(found, subject.size or tree.film_size(tree.tree(subject.scene)))


def made_truth(contenders: list[Rival], planned: dict[str, Any], store: Store) -> Truth:
    """The reference by the contenders themselves; its finished batches are kept."""
    chosen = [rival for rival in contenders if rival.name in planned["reference"]]
    samples = planned["reference"]
    found = truth.pooled({rival.name: batches(rival, samples[rival.name], store) for rival in chosen}, samples)
    if found.warning:
        print(f"  warning: {found.warning}")
    print(f"  reference: {found.how}; its own relMSE is {found.own_relmse:.2g}", flush=True)
    return found


def batches(rival: Rival, samples: int, store: Store) -> np.ndarray:
    """Independent images for the reference, float32 as files keep them."""
    images = []
    for number in range(plan.REFERENCE_BATCHES):
        path = store.path(f"reference-{rival.slug}", 0, number)
        if not path.is_file():
            exr.write_image(path, rival.render(samples, plan.REFERENCE_SEED + number)[0])
        images.append(exr.read_image(path))
    return np.stack(images)


def take_turns(
    contenders: list[Rival], planned: dict[str, Any], reference: Truth, seeds: int, store: Store, deadline: float
) -> int:
    """Every round each contender renders each budget once, with a seed of its own; the number of complete rounds. Where
    time is up there are fewer than asked for."""
    longest = 0.0
    for number in range(seeds):
        started = time.monotonic()
        if number >= LEAST_SEEDS and started + longest > deadline and not complete(contenders, planned, number, store):
            print(f"  time is up after {number} of {seeds} seeds; the same command again goes on", flush=True)
            return number
        errors = one_round(contenders, planned, reference, number, store)
        longest = max(longest, time.monotonic() - started)
        shown = ", ".join(f"{name} {error:.2g}" for name, error in errors.items())
        print(f"  seed {number + 1} of {seeds}, {time.monotonic() - started:.1f} s; relMSE: {shown}", flush=True)
    return seeds


def complete(contenders: list[Rival], planned: dict[str, Any], seed: int, store: Store) -> bool:
    """True if all renders of a round are kept already."""
    return all(
        store.run(rival.slug, budget, seed)
        for rival in contenders
        for budget in range(len(planned["samples"][rival.name]))
    )


def one_round(
    contenders: list[Rival], planned: dict[str, Any], reference: Truth, seed: int, store: Store
) -> dict[str, float]:
    """All budgets of all contenders by one seed; the relMSE of each one's last budget."""
    last: dict[str, float] = {}
    for budget in range(max(map(len, planned["samples"].values()))):
        for rival in contenders:
            samples = planned["samples"][rival.name]
            if budget < len(samples):
                is_wanted = seed == 0 or budget == len(samples) - 1
                last[rival.name] = one_run(rival, budget, samples[budget], seed, reference, store, is_wanted).relmse
    return last


def one_run(
    rival: Rival, budget: int, samples: int, seed: int, reference: Truth, store: Store, is_wanted: bool
) -> Measures:
    """One render, or what is kept of it."""
    kept = store.run(rival.slug, budget, seed)
    if kept:
        return kept.measures
    # Budgets have seeds of their own, or the images of one would be the beginnings of the next one's.
    image, seconds = rival.render(samples, plan.FIRST_SEED + seed * 64 + budget)
    run = Run(samples, seconds, measures(image, reference.image))
    store.keep_run(rival.slug, budget, seed, run, image if is_wanted else None)
    return run.measures
