"""Time to equal error: relMSE x seconds of contenders that take turns in one `tyndall study`. Every render is a process of its own.
Its seconds include all that precedes its first sample but reading and compiling: the pilot and learning."""

import csv
import hashlib
import json
import os
import shlex
import statistics
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation import mitsuba
from validation.contender import GPU, INTEGRATORS, VARIANTS
from validation.places import OUTPUT
from tyndall.statistics import Ratio

MITSUBA = tuple(f"{kind}:{variant}" for kind in INTEGRATORS for variant in (*VARIANTS, GPU))
"""Contenders of Mitsuba's; the integrator alone is one by the faster variant that there is."""
OURS = "tyndall"
"""The contender that the others are compared with."""
BDPT = "--integrator bdpt"
NOBODY = "nobody"
ALONE = ("--contender", f"{NOBODY}: --integrator fog")
"""A study without a --contender would add two in its own process. A preview, which it leaves out, keeps them away."""


def command(name: str, words: str) -> list[str]:
    """The options of `tyndall study` for a contender: of Mitsuba's by its name, else Tyndall's by the options `words`."""
    kind, _, variant = name.partition(":")
    is_theirs = kind in INTEGRATORS and not words
    variant = variant or VARIANTS[mitsuba.libllvm() is None]
    by = ["--integrator", kind, "--variant", variant] if is_theirs else [f"--tyndall={words}"]
    line = [os.path.relpath(sys.executable), "-m", "validation.contender", "{scene}", "{definitions}", *by, "--size", "{size}"]
    line += ["--threads", "{threads}", "--seed", "{seed}", "--spp", "{budgets}", "--folder", "{folder}"]
    return ["--external", f"{f'mitsuba {kind} {variant}' if is_theirs else name}: {shlex.join(line)}"]


def run(line: Sequence[object]) -> bool:
    """Runs a study; it prints its table and says where its page is."""
    words = [str(program.binary()), "study", *map(str, line)]
    return subprocess.run(words, env={**os.environ, "TYNDALL_BINARY": str(program.binary())}).returncode == 0


@dataclass(frozen=True)
class Effort:
    """How much is rendered; without a size, the scene's own."""

    seeds: int
    seconds: float
    """Of the longest render of each contender."""
    reference_seconds: float
    size: str | None = None
    threads: int = 2
    points: int = 1
    """Budgets, each twice the one before."""
    parameters: tuple[str, ...] = ()
    """NAME=VALUE."""
    first: int = 0
    """Seed."""

    def given(self) -> list[str]:
        """What all studies of it have in common."""
        return [*program.flags({"size": self.size, "threads": self.threads}), *(word for pair in self.parameters for word in ("-D", pair))]


@dataclass(frozen=True)
class Reference:
    """A long render, and its own relMSE if it is known."""

    image: Path
    relmse: float | None = None


def reference(scene: Path, effort: Effort, by: str = BDPT) -> Reference:
    """A reference is made once, by a study of its own: it is made again when the scene or the version changes or more time is given."""
    version = program.call([str(program.binary()), "--version"]).stdout
    told = [version, scene.read_bytes(), effort.size, effort.reference_seconds, effort.parameters, by]
    folder = OUTPUT / "references" / f"{scene.stem}-{hashlib.sha256(repr(told).encode()).hexdigest()[:12]}"
    little: dict[str, program.Option] = {"quiet": True, "spp": 1, "seeds": 2, "doublings": 1, "reference_by": by, "reference_seconds": effort.reference_seconds}
    if not run([os.path.relpath(scene), "--contender", f"it: {by}", *program.flags(little), *effort.given(), "-o", os.path.relpath(folder)]):
        raise Failure(f"{scene}: no reference could be made", f"see the message above; if files that the scene names are others now, remove {folder}")
    [found] = json.loads((folder / "study.json").read_text())["scenes"]
    return Reference(folder / found["reference"]["image"], found["reference"]["own_relmse"])


@dataclass(frozen=True)
class Found:
    """What a study says of a scene."""

    name: str
    told: dict[str, Any]
    """Its part of study.json."""
    costs: dict[str, list[float]]
    """relMSE x seconds of independent renders by each contender, at the greatest budget. The reference's own relMSE is subtracted, as
    far as that leaves a half."""

    def ratio(self, other: str, ours: str = OURS) -> Ratio:
        """How many times as efficient as another contender ours is."""
        return Ratio.of(self.costs[other], self.costs[ours])

    def cost(self, name: str = OURS) -> float:
        """The mean of a contender's."""
        return statistics.mean(self.costs[name])

    @property
    def noise(self) -> float:
        """The reference's relMSE, 0 where it is not known."""
        return self.told["reference"]["own_relmse"] or 0.0

    @property
    def apart(self) -> dict[str, list[str]]:
        """Whose image is another one, and what is said of it."""
        said = {one["name"]: [note for note in one.get("notes", []) if "mean differs" in note] for one in self.told["contenders"]}
        return {name: notes for name, notes in said.items() if notes}

    @property
    def notes(self) -> list[str]:
        """Who could not render it and why, and whose image is another one."""
        apart = [f"{name}: {note}" for name, notes in self.apart.items() for note in notes]
        return [*(note for note in self.told.get("notes", []) if not note.startswith(NOBODY)), *apart]


@dataclass(frozen=True)
class Study:
    """A whole one."""

    told: dict[str, Any]
    scenes: list[Found]


def measured(
    scenes: Sequence[Path], contenders: Mapping[str, str], effort: Effort, folder: Path,
    references: Sequence[Reference] = (), by: str = BDPT, restart: bool = True, quiet: bool = False,
) -> Study:  # fmt: skip
    """All contenders in all scenes, against references that are given or else kept, rendered `by` these options. Contenders are named
    with their options; Mitsuba's have none."""
    everybody = [*ALONE, *(word for name, words in contenders.items() for word in command(name, words))]
    much: dict[str, program.Option] = {"seconds": effort.seconds, "seeds": effort.seeds, "seed": effort.first, "doublings": effort.points, "restart": restart, "quiet": quiet}
    references = references or [reference(scene, effort, by) for scene in scenes]
    known = [word for one in references for word in ("--reference", one.image)]
    known += [word for one in references if one.relmse is not None for word in ("--reference-error", f"{one.relmse:.6g}")]
    if not run([*map(os.path.relpath, scenes), *everybody, *program.flags(much), *effort.given(), *known, "-o", os.path.relpath(folder)]):
        raise Failure(f"{folder}: no study could be made", "see the message above")
    return read(folder)


def read(folder: Path) -> Study:
    """What a study has written."""
    told = json.loads((folder / "study.json").read_text())
    with (folder / "study.csv").open() as file:
        rows = list(csv.DictReader(file))
    return Study(told, [found(scene, [row for row in rows if row["scene"] == scene["name"]]) for scene in told["scenes"]])


def found(scene: dict[str, Any], rows: list[dict[str, str]]) -> Found:
    """Of one scene."""
    bare = Found(scene["name"], scene, {})
    for contender in scene["contenders"]:
        name, most = contender["name"], str(contender["points"][-1]["samples"])
        last = [row for row in rows if row["contender"] == name and row["samples"] == most]
        errors = [float(row["relmse"]) for row in last]
        bare.costs[name] = [max(error - bare.noise, error / 2) * float(row["seconds"]) for error, row in zip(errors, last)]
    return bare
