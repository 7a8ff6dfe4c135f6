"""`python3 -m validation lottery`: scenes that nobody made, and what the renderer's own choice of strategies costs in each, as a
multiple of what the best of others costs, `pt`, and all strategies alike."""

import argparse
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tyndall.failure import Failure
from tyndall.rendering import ALL_STRATEGIES
from tyndall.scene import Scene, scene_file
from validation.guide import Gain
from validation.lottery.judge import Cost, Judge, Reference, Shot, shot, shots
from validation.lottery.scenes import Drawn, drawn
from validation.places import OUTPUT

OURS = "--integrator bdpt"
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
    "LW96": f"{ALIKE} --connections all",
    "no guide": f"{OURS} --guide never",
    "no guide, starts": f"{OURS} --guide never --starts emitted",
}
"""The choices of which the best is looked for."""
SEARCH = range(201, 203)
"""Seeds of the search: the best is then measured with others, or it would be the luckiest."""
REFERENCE = range(101, 109)
ATTEMPTS = 20
"""Black scenes are drawn again so often."""
BEARABLE = 1.2
"""A default that surely costs more than this times the best is marked."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--seeds", type=interval, default=range(0, 20), metavar="A..B", help="of the scenes, both included (default 0..19)")
    command.add_argument("--renders", type=int, default=4, help="independent renders of each contender, at least 3 (default %(default)s)")
    command.add_argument("--seconds", type=float, default=1.5, help="of the processor, for each (default %(default)s)")
    command.add_argument("--reference", type=float, default=2, help=f"seconds of each of the {len(REFERENCE)} images of a reference (default %(default)s)")
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
    gains: dict[str, Gain]
    """Costs of the default over those of the best, of `pt` and of all alike; `pt` is left out where it does not reach all light."""
    search: dict[str, float]
    """Costs of all others as the search found them, relMSE x seconds."""
    plan: dict[str, Any]
    """What the default chose."""

    @property
    def is_marked(self) -> bool:
        """Surely another choice would have been better."""
        gain = self.gains["best"]
        return gain.ratio * (1 - 2 * gain.error) > BEARABLE


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
    found = [{**vars(row), "gains": {name: vars(gain) for name, gain in row.gains.items()}} for row in rows]
    (options.output / "lottery.json").write_text(json.dumps(found, indent=1) + "\n")
    return not failed and not any(row.is_marked for row in rows)


def ticket(seed: int, output: Path) -> tuple[Path, Drawn]:
    """The first scene of this seed that is not black, and its file."""
    folder = output / f"{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    for attempt in range(ATTEMPTS):
        found = drawn(seed, attempt)
        path = scene_file(Scene(found.tree, f"{seed}"), folder.resolve())
        first = shot(path, OURS, 64, 1)
        for warning in first.warnings:
            print(f"note: seed {seed}, attempt {attempt}: {warning}", flush=True)
        if first.image.mean() > 0:
            return path, found
    raise Failure(f"{ATTEMPTS} black scenes", "see whether the renderer finds no light in them, or there is none")


def judged(seed: int, options: argparse.Namespace) -> Row:
    """A scene drawn and measured."""
    path, found = ticket(seed, options.output)
    images = shots(path, OURS, options.reference, REFERENCE)
    judge = Judge(path, Reference.of(images), options.seconds)
    reaching = {name: words for name, words in OTHERS.items() if shot(path, words, 1, 1).unreached() <= images[0].unreached()}
    if "pt" in reaching:
        cross_check(seed, judge, shots(path, PT, options.reference, REFERENCE))
    search = {name: judge.cost(words, SEARCH).mean for name, words in reaching.items()}
    best = min(search, key=lambda name: search[name])
    return Row(seed, found.words, best, gains(judge, best, reaching, range(1, options.renders + 1)), search, images[0].report["plan"])


def gains(judge: Judge, best: str, reaching: dict[str, str], seeds: range) -> dict[str, Gain]:
    """The default's costs over those of others."""
    ours = judge.cost(OURS, seeds)
    costs: dict[str, Cost] = {name: judge.cost(reaching[name], seeds) for name in {best, "pt", "alike"} if name in reaching}
    return {"best": ours.over(costs[best])} | {name: ours.over(cost) for name, cost in costs.items() if name in ("pt", "alike")}


def cross_check(seed: int, judge: Judge, others: list[Shot]) -> None:
    """Says so if `pt` makes another image."""
    score = judge.reference.score(others)
    if score > 1:
        ratio = np.mean([one.image for one in others]) / judge.reference.mean.mean()
        print(f"WARNING: seed {seed}: pt differs, {score:.1f} times what chance allows; its mean is {ratio:.4f} of the default's", flush=True)


def line(row: Row) -> str:
    """Of the table."""
    over = [str(row.gains[name]) if name in row.gains else "does not reach all light" for name in ("best", "pt", "alike")]
    return f"| {row.seed} | {row.words} | {row.best} | {' | '.join(over)} | {'WORSE' if row.is_marked else ''} |"


def summary(rows: list[Row]) -> str:
    """How the ratios are distributed."""
    lines = [f"\n{len(rows)} scenes, {sum(row.is_marked for row in rows)} of them marked: surely above {BEARABLE} times the best of others."]
    for name in ("best", "pt", "alike"):
        ratios = [row.gains[name].ratio for row in rows if name in row.gains and row.gains[name].ratio > 0]
        if ratios:
            low, middle, high = np.percentile(ratios, (25, 50, 75))
            geometric = math.exp(np.mean(np.log(ratios)))
            lines.append(f"over {name}: geometric mean {geometric:.2f}, mean {np.mean(ratios):.2f}, quartiles {low:.2f} {middle:.2f} {high:.2f}, max {max(ratios):.2f}")
    return "\n".join(lines)
