"""What a guide gives: relMSE after the same time with `--guide` and without, learning included, by `bdpt` and by `pt`, in scenes lit
through openings, rooms lit indirectly, the Cornell boxes of the founding thesis and a dense cloud."""

import argparse
import json
import math
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import program
from tyndall.commands import diff
from tyndall.rendering import run as render
from validation import efficiency
from validation.files import write_text
from validation.made_by import made_by_command
from validation.places import OUTPUT, REPORTS, SCENES

GALLERY = SCENES / "gallery"
CASES = {
    "lit through an opening": [efficiency.FOLDER / "small_opening.xml", efficiency.FOLDER / "door_ajar.xml", efficiency.FOLDER / "dusty_window.xml", GALLERY / "attic.json"],
    "lit indirectly": [GALLERY / "indirect_room.json", GALLERY / "three_lights.json", SCENES / "lampbox_up.xml"],
    "P03T's boxes": [GALLERY / "cornell_d.json", GALLERY / "cornell_e.json", GALLERY / "cornell_f.json"],
    "dense cloud": [GALLERY / "cumulus.json"],
}
WANTED = {"lit through an opening": 5.0, "lit indirectly": 2.0, "P03T's boxes": 0.9, "dense cloud": 1.5}
"""How much less error a guide shall leave by bdpt; by pt it is WANTED_PT in the boxes."""
WANTED_PT = 2.0
INTEGRATORS = ("bdpt", "pt")
OTHER_SEED = 10_000
"""That of references."""


@dataclass(frozen=True)
class Gain:
    """relMSE without a guide over that with one, after the same time, and its standard error as a part of it."""

    ratio: float
    error: float

    @staticmethod
    def of(plain: list[float], guided: list[float]) -> "Gain":
        """By independent renders."""
        spread = [statistics.variance(errors) / len(errors) / statistics.mean(errors) ** 2 for errors in (plain, guided)]
        return Gain(statistics.mean(plain) / statistics.mean(guided), math.sqrt(sum(spread)))

    def __str__(self) -> str:
        return f"{self.ratio:.2f} ± {self.ratio * self.error:.2f}"


@dataclass(frozen=True)
class Row:
    """What was found in a scene."""

    kind: str
    scene: str
    gains: dict[str, Gain]
    """By integrator."""
    learnt: dict[str, Any]
    """What `tyndall guide --json` says."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--seconds", type=float, default=10, help="of each render, learning included (default %(default)s)")
    command.add_argument("--seeds", type=int, default=10, help="independent renders of each kind, at least 2 (default %(default)s)")
    command.add_argument("--reference-seconds", type=float, default=60, help="of each reference, by bdpt (default %(default)s)")
    command.add_argument("--size", default="96x72", help="of all images (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for guide.md (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures and writes the table; true if a guide gives what it shall everywhere."""
    efficiency.volumes()
    rows = [row_of(kind, scene, options) for kind, scenes in CASES.items() for scene in scenes]
    text = page(rows, options)
    write_text(options.output / "guide.md", text)
    print(text)
    return all(row.gains["bdpt"].ratio >= WANTED[row.kind] for row in rows)


def row_of(kind: str, scene: Path, options: argparse.Namespace) -> Row:
    """Renders a scene with a guide and without."""
    given: dict[str, Any] = {"size": options.size, "threads": options.threads}
    reference = render(scene, integrator="bdpt", time_limit=options.reference_seconds, seed=OTHER_SEED, **given).image

    def error(integrator: str, seed: int, *, guide: bool) -> float:
        image = render(scene, integrator=integrator, guide=guide, time_limit=options.seconds, seed=seed, **given).image
        return relmse(image, reference)

    seeds = range(options.seeds)
    errors = {name: [[error(name, seed, guide=guide) for guide in (False, True)] for seed in seeds] for name in INTEGRATORS}
    gains = {name: Gain.of(*map(list, zip(*pairs))) for name, pairs in errors.items()}
    folder = OUTPUT / "guide" / scene.stem
    folder.parent.mkdir(parents=True, exist_ok=True)
    words = program.flags({"output": folder, "json": True, **given})
    row = Row(kind, scene.stem, gains, json.loads(program.call([str(program.binary()), "--quiet", "guide", str(scene), *words]).stdout))
    print(f"{row.scene}: {', '.join(f'{name} {gain}' for name, gain in gains.items())}", flush=True)
    return row


def relmse(image: np.ndarray, reference: np.ndarray) -> float:
    """As `tyndall diff` measures it."""
    return float(diff(image, reference)["radiance"]["relmse"])


def page(rows: list[Row], options: argparse.Namespace) -> str:
    """The report."""
    command = made_by_command()
    return (
        f"# What a guide gives\n\n    {command}\n\n"
        f"relMSE without `--guide` over relMSE with it, after {options.seconds:g} s each, learning and pilots included: {options.size} pixels, {options.threads} threads, "
        f"{options.seeds} seeds; ± one standard error. References: `bdpt`, {options.reference_seconds:g} s, unguided. Without `--guide`, `bdpt` has what its pilot chooses, learnt starts of light subpaths "
        "among it.\n\n"
        "| scene | by bdpt | wanted | by pt | wanted | learning | memory | cells of surfaces, media | guided on surfaces, in media (camera's walks) |\n"
        "|---|---|---|---|---|---|---|---|---|\n" + "".join(map(line, rows))
    )


def line(row: Row) -> str:
    """Of the table."""
    kinds = [row.learnt[kind] for kind in ("surfaces", "media")]
    cells = ", ".join(str(kind["cells"]) for kind in kinds)
    guided = ", ".join(f"{100 * kind['guided'][0]:.0f} %" for kind in kinds)
    over_pt = f"{WANTED_PT:g}" if row.kind == "P03T's boxes" else ""
    return (
        f"| {row.scene} ({row.kind}) | {row.gains['bdpt']} | {WANTED[row.kind]:g} | {row.gains['pt']} | {over_pt} | {row.learnt['seconds']:.1f} s | "
        f"{row.learnt['bytes'] / 2**20:.1f} MiB | {cells} | {guided} |\n"
    )
