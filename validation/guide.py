"""What a guide gives: relMSE after the same time with `--guide` and without, learning included, by `bdpt` and by `pt`, in scenes lit
through openings, rooms lit indirectly, the Cornell boxes of the founding thesis and a dense cloud."""

import argparse
import json
import math
import statistics
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import program
from tyndall.commands import diff
from tyndall.rendering import run as render
from tyndall.scene import Scene
from validation import efficiency
from validation.files import write_text
from validation.made_by import made_by_command
from validation.places import OUTPUT, REPORTS, SCENES

GALLERY = SCENES / "gallery"


@dataclass(frozen=True)
class Case:
    """A scene, as it is named in the table."""

    name: str
    scene: Path
    parameters: dict[str, str] = field(default_factory=dict)


def cases(*scenes: Path) -> list[Case]:
    """Scenes as they are."""
    return [Case(scene.stem, scene) for scene in scenes]


CASES = {
    "lit through an opening": cases(
        *(efficiency.FOLDER / f"{name}.xml" for name in ("small_opening", "keyhole", "door_ajar", "skylight", "dusty_window")), GALLERY / "attic.json"
    ),
    "lit indirectly": [
        Case("indirect_room (fig. 5.15)", GALLERY / "indirect_room.json"),
        Case("reflector (fig. 5.14)", GALLERY / "reflector.json"),
        *cases(GALLERY / "three_lights.json", SCENES / "lampbox_up.xml"),
    ],
    "P03T's boxes": [
        Case("A: empty", GALLERY / "cornell_d.json", {"medium": "0"}),
        Case("B: blocks", GALLERY / "cornell_e.json", {"medium": "0"}),
        Case("C: a glossy block", GALLERY / "cornell_e.json", {"medium": "0", "glossy": "1"}),
        Case("D: fog in a half", GALLERY / "cornell_d.json"),
        Case("E: blocks in fog", GALLERY / "cornell_e.json"),
        Case("F: fog that scatters forwards", GALLERY / "cornell_f.json"),
    ],
    "dense cloud": cases(GALLERY / "cumulus.json"),
    "lit openly": [Case("floating_cubes (fig. 5.23)", GALLERY / "floating_cubes.json")],
}
WANTED = {"lit through an opening": 5.0, "lit indirectly": 2.0, "P03T's boxes": 0.9, "dense cloud": 1.5, "lit openly": 0.9}
"""How much less error a guide shall leave by bdpt; by pt it is WANTED_PT in the boxes."""
WANTED_PT = 2.0
WAYS: dict[str, dict[str, Any]] = {
    "bdpt": {"integrator": "bdpt", "starts": "emitted", "guide": "never"},
    "bdpt, starts": {"integrator": "bdpt", "guide": "never"},
    "bdpt, guide": {"integrator": "bdpt", "guide": "auto"},
    "pt": {"integrator": "pt"},
    "pt, guide": {"integrator": "pt", "guide": "auto"},
    "gather": {"integrator": "gather"},
}
"""What is rendered, by the same time."""
GAINS = {
    "starts": ("bdpt", "bdpt, starts"),
    "bdpt": ("bdpt", "bdpt, guide"),
    "pt": ("pt", "pt, guide"),
    "gather over pt": ("pt", "gather"),
    "gather over bdpt": ("bdpt, starts", "gather"),
}
"""What is compared: relMSE of the one over that of the other."""
REFERENCE = "bdpt, guide"
"""What references are made of."""


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
    name: str
    gains: dict[str, Gain]
    """By the names of GAINS."""
    learnt: dict[str, Any]
    """What `tyndall guide --json` says."""
    follows: dict[str, bool]
    """Whether `bdpt` and `pt` by `--guide auto` follow the guide."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--seconds", type=float, default=10, help="of each render, learning included (default %(default)s)")
    command.add_argument("--seeds", type=int, default=10, help="independent renders of each kind, at least 2 (default %(default)s)")
    command.add_argument("--scenes", nargs="+", metavar="NAME", help="those whose names begin so (default all)")
    command.add_argument("--preview-seeds", type=int, default=3, help="of those by gather, at least 2 (default %(default)s)")
    command.add_argument("--size", default="96x72", help="of all images (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="(default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for guide.md (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures and writes the table; true if a guide gives what it shall everywhere."""
    efficiency.volumes()
    wanted = tuple(options.scenes or [""])
    rows = [row_of(kind, case, options) for kind, cases in CASES.items() for case in cases if case.name.startswith(wanted)]
    text = page(rows, options)
    write_text(options.output / "guide.md", text)
    print(text)
    return all(row.gains["bdpt"].ratio >= WANTED[row.kind] for row in rows)


def row_of(kind: str, case: Case, options: argparse.Namespace) -> Row:
    """Renders a scene with a guide and without, and as the preview `gather`."""
    given: dict[str, Any] = {"size": options.size, "threads": options.threads}
    scene = Scene(case.scene, case.name, case.parameters)
    images: dict[str, list[Any]] = {name: [] for name in WAYS}
    for seed in range(options.seeds):
        for name, way in WAYS.items():
            if name != "gather" or seed < options.preview_seeds:
                images[name].append(render(scene, time_limit=options.seconds, seed=seed, **way, **given).image)
    errors = errors_of(images)
    gains = {name: Gain.of(errors[plain], errors[other]) for name, (plain, other) in GAINS.items()}
    folder = OUTPUT / "guide" / case.name.split()[0].strip(":")
    folder.parent.mkdir(parents=True, exist_ok=True)
    words = program.flags({"output": folder, "json": True, **given})
    learn = [str(program.binary()), "--quiet", "guide", str(case.scene), *words, *program.definitions(case.parameters)]
    follows = {by: bool(render(scene, spp=1, **WAYS[f"{by}, guide"], **given).report["plan"]["guided"]) for by in ("bdpt", "pt")}
    row = Row(kind, case.name, gains, json.loads(program.call(learn).stdout), follows)
    print(line(row), end="", flush=True)
    return row


def errors_of(images: dict[str, list[Any]]) -> dict[str, list[float]]:
    """The relMSE of each image, without the noise of its reference: the mean of what REFERENCE made of the other seeds, whose own relMSE tells how
    much that is."""
    seeds = len(images[REFERENCE])
    references = [np.mean([image for other, image in enumerate(images[REFERENCE]) if other != seed], axis=0) for seed in range(seeds)]
    errors = {name: [float(diff(image, reference)["radiance"]["relmse"]) for image, reference in zip(made, references)] for name, made in images.items()}
    noise = statistics.mean(errors[REFERENCE]) / seeds
    return {name: [error - noise for error in found] for name, found in errors.items()}


def page(rows: list[Row], options: argparse.Namespace) -> str:
    """The report."""
    command = made_by_command()
    return (
        f"# What a guide gives\n\n    {command}\n\n"
        f"relMSE without path guiding (`--starts emitted --guide never`) over relMSE with it (`--guide auto`, the default of `bdpt`), after {options.seconds:g} s each, training and pilots included. *Followed*: whether `auto` guided. {options.size} pixels, {options.threads} threads, "
        f"{options.seeds} seeds ({options.preview_seeds} by `gather`); ± one standard error. The reference of each seed is the mean of the other seeds by `bdpt --guide auto`; its own noise is subtracted. *Starts*: learnt starts of light subpaths alone, where the pilot of `bdpt` finds "
        "them worth learning; the guide includes them. *gather*: relMSE by `pt`, and by `bdpt` with its starts, over that of the preview `gather`. [thresholds.md](thresholds.md) has P03T's boxes by a path tracer like P03T's own, at its thresholds.\n\n"
        "| scene | starts | guide, by bdpt | wanted | followed | guide, by pt | wanted | followed | gather over pt | over bdpt | learning | memory | portals | cells of surfaces, media | guided on surfaces, in media (camera's walks) |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n" + "".join(map(line, rows))
    )


def line(row: Row) -> str:
    """Of the table."""
    kinds = [row.learnt[kind] for kind in ("surfaces", "media")]
    cells = ", ".join(str(kind["cells"]) for kind in kinds)
    guided = ", ".join(f"{100 * kind['guided'][0]:.0f} %" for kind in kinds)
    over_pt = f"{WANTED_PT:g}" if row.kind == "P03T's boxes" else ""
    bdpt, pt = ("yes" if row.follows[by] else "no" for by in ("bdpt", "pt"))
    return (
        f"| {row.name} ({row.kind}) | {row.gains['starts']} | {row.gains['bdpt']} | {WANTED[row.kind]:g} | {bdpt} | {row.gains['pt']} | {over_pt} | {pt} | {row.gains['gather over pt']} | {row.gains['gather over bdpt']} | {row.learnt['seconds']:.1f} s | "
        f"{row.learnt['bytes'] / 2**20:.1f} MiB | {len(row.learnt['portals'])} | {cells} | {guided} |\n"
    )
