"""`python3 -m validation lottery`: scenes that nobody made, and what the renderer's own choice of strategies costs in each, as a
multiple of what the best of others costs, `pt`, and all strategies alike."""

import argparse
import json
from collections.abc import Container
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import tyndall
from tyndall.failure import Failure
from tyndall.rendering import ALL_STRATEGIES
from tyndall.scene import Scene, scene_file
from validation import reach, studies
from validation.files import write_text
from validation.lottery.scenes import Drawn, drawn
from validation.places import OUTPUT
from validation.reach import Reach
from tyndall.statistics import Ratio
from validation.studies import BDPT, OURS, Effort

PT = "--integrator pt"
ALIKE = f"--strategies {ALL_STRATEGIES}"
OTHERS = {
    "pt": PT,
    "pt, guide": f"{PT} --guide auto",
    "hit": "--strategies hit",
    "hit+lens": "--strategies hit,lens",
    "pt+lens": "--strategies hit,next-event,lens",
    "pt+join": "--strategies hit,next-event,join",
    "no next-event": "--strategies hit,join,lens",
    "pt+equiangular": "--strategies hit,next-event,equiangular",
    "alike": ALIKE,
    "alike, starts": f"{ALIKE} --starts learnt",
    "alike, guide": f"{ALIKE} --guide auto",
    "alike, guide and starts": f"{ALIKE} --guide always --starts learnt",
    "LW96": f"{ALIKE} --connections all",
    "no guide": f"{BDPT} --guide never",
    "no guide, starts": f"{BDPT} --guide never --starts emitted",
}
"""The choices of which the best is looked for."""
SEARCH = range(200, 202)
"""Seeds of the search: the best is then measured with others, or it would be the luckiest."""
ATTEMPTS = 20
"""Scenes that are black or have no noise are drawn again so often."""
BEARABLE = 1.2
"""A default that surely costs more than this times the best is marked."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--seeds", type=interval, default=range(0, 20), metavar="A..B", help="of the scenes, both included (default 0..19)")
    command.add_argument("--renders", type=int, default=4, help="independent renders of each contender, at least 3 (default %(default)s)")
    command.add_argument("--seconds", type=float, default=1.5, help="of each (default %(default)s)")
    command.add_argument("--reference-seconds", type=float, default=16, help="of each reference (default %(default)s)")
    command.add_argument("--output", type=Path, default=OUTPUT / "lottery", help="folder for the scenes and lottery.json (default %(default)s)")


def interval(text: str) -> range:
    """A..B, both included, or one number."""
    first, _, last = text.partition("..")
    return range(int(first), int(last or first) + 1)


@dataclass(frozen=True)
class Row:
    """What was found in a scene."""

    seed: int
    words: str
    best: str
    gains: dict[str, Ratio]
    """Costs of the default over those of the best, of `pt` and of all alike; `pt` is left out where it does not reach all light."""
    search: dict[str, float]
    """Costs of all others as the search found them, relMSE x seconds."""
    notes: list[str]
    """What the study has to say: whose image is another one."""
    plan: dict[str, Any]
    """What the default chose."""

    @property
    def is_marked(self) -> bool:
        """Surely another choice would have been better."""
        return self.gains["best"].low > BEARABLE


def run(options: argparse.Namespace) -> bool:
    """Judges all scenes; true if none is marked and nothing failed."""
    if options.renders < 3:
        raise Failure("--renders is below 3: no error can be known", "give at least 4")
    rows: list[Row] = []
    failed = 0
    print("| seed | scene | best of others | default over it | over pt | over all alike | |\n|---|---|---|---|---|---|---|", flush=True)
    for seed in options.seeds:
        try:
            rows.append(judged(seed, options))
            print(line(rows[-1]), flush=True)
        except Failure as failure:
            failed += 1
            print(f"FAILED: seed {seed}: {failure}", flush=True)
    print(summary(rows))
    write_text(options.output / "lottery.json", json.dumps([asdict(row) for row in rows], indent=1) + "\n")
    return not failed and not any(row.is_marked for row in rows)


def ticket(seed: int, output: Path) -> tuple[Path, Drawn]:
    """The first scene of this seed that is not black and has noise, and its file."""
    folder = output / f"{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    for attempt in range(ATTEMPTS):
        found = drawn(seed, attempt)
        path = scene_file(Scene(found.tree, f"{seed}"), folder.resolve())
        first = tyndall.run(path, spp=64, seed=1)
        for warning in first.messages:
            print(f"note: seed {seed}, attempt {attempt}: {warning}", flush=True)
        if first.image.mean() > 0 and first.report["relative_error"] > 0:
            return path, found
    raise Failure(f"{ATTEMPTS} scenes that are black or have no noise", "see whether the renderer finds no light in them, or there is none")


def judged(seed: int, options: argparse.Namespace) -> Row:
    """A scene drawn and measured."""
    path, found = ticket(seed, options.output)
    plan = reach.plan(str(path), *BDPT.split())
    reaching = {name: words for name, words in OTHERS.items() if not Reach.of(reach.plan(str(path), *words.split())).beyond(Reach.of(plan), False)}
    search = measured(path, reaching, SEARCH, options)
    costs = {name: search.cost(name) for name in search.costs if name != OURS}
    best = cheapest(costs, search.apart)
    others = {"best": best} | {name: name for name in ("pt", "alike") if name in reaching}
    final = measured(path, {name: reaching[name] for name in others.values()}, range(options.renders), options)
    gains = {name: Ratio.of(final.costs[OURS], final.costs[other]) for name, other in others.items()}
    return Row(seed, found.words, best, gains, costs, final.notes, plan)


def cheapest(costs: dict[str, float], apart: Container[str]) -> str:
    """Of the contenders that find the same image: a black one takes no time, and its relMSE is 1."""
    return min(costs, key=lambda name: (name in apart, costs[name]))


def measured(path: Path, others: dict[str, str], seeds: range, options: argparse.Namespace) -> studies.Found:
    """The default and others, one thread each."""
    effort = Effort(len(seeds), options.seconds, options.reference_seconds, threads=1, first=seeds[0])
    return studies.measured([path], {OURS: BDPT, **others}, effort, path.parent / f"study-{seeds[0]}", quiet=True).scenes[0]


def line(row: Row) -> str:
    """Of the table."""
    over = [str(row.gains[name]) if name in row.gains else "does not reach all light" for name in ("best", "pt", "alike")]
    return "\n".join([f"| {row.seed} | {row.words} | {row.best} | {' | '.join(over)} | {'WORSE' if row.is_marked else ''} |", *row.notes])


def summary(rows: list[Row]) -> str:
    """How the ratios are distributed."""
    lines = [f"\n{len(rows)} scenes, {sum(row.is_marked for row in rows)} of them marked: surely above {BEARABLE} times the best of others."]
    for name in ("best", "pt", "alike"):
        ratios = [row.gains[name].mean for row in rows if name in row.gains]
        if ratios:
            low, middle, high = np.percentile(ratios, (25, 50, 75))
            geometric = np.exp(np.mean(np.log(ratios)))
            lines.append(f"over {name}: geometric mean {geometric:.2f}, mean {np.mean(ratios):.2f}, quartiles {low:.2f} {middle:.2f} {high:.2f}, max {max(ratios):.2f}")
    return "\n".join(lines)
