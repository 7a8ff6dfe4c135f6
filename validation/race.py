"""Error against run time, side by side: contenders take turns on the same cores; what counts is relMSE x seconds."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation import errors, mitsuba, picture
from validation.contenders import Contender
from validation.errors import Errors
from validation.statistics import Estimate, bootstrap_median, estimate


@dataclass(frozen=True)
class Runs:
    """What one contender did: images (rounds, height, width, 3), seconds of each, samples a pixel."""

    name: str
    images: np.ndarray
    seconds: np.ndarray
    spp: int


def take_turns(contenders: list[Contender], rounds: int, seconds: float, first_seed: int = 1) -> list[Runs]:
    """Every round each contender renders once, for about the same time, with a seed of its own."""
    spp = [c.spp_for(seconds) for c in contenders]
    done: list[list] = [[] for _ in contenders]
    for r in range(rounds):
        for i, contender in enumerate(contenders):
            done[i].append(contender.render(spp[i], first_seed + r))
    return [runs(c.name, d, n) for c, d, n in zip(contenders, done, spp)]


def runs(name: str, done: list, spp: int) -> Runs:
    """Gathers one contender's renders."""
    return Runs(name, np.stack([image for image, _ in done]), np.array([s for _, s in done]), spp)


def pooled(all_runs: list[Runs]) -> Estimate:
    """The mean over all contenders, each weighted by its precision in the whole image: the common reference."""
    parts = [estimate(r.images) for r in all_runs]
    precision = np.array([1 / p.variance.mean() for p in parts])
    weights = precision / precision.sum()
    mean = sum(w * p.mean for w, p in zip(weights, parts))
    variance = sum(w**2 * p.variance for w, p in zip(weights, parts))
    return Estimate(mean, variance, parts[0].freedom)


@dataclass(frozen=True)
class Standing:
    """One contender's result."""

    name: str
    spp: int
    seconds: float
    relmse: float
    cost: np.ndarray
    """relMSE x seconds, by round."""
    trimmed_cost: float
    difference: float
    """Its image mean against the reference's, relative."""
    difference_error: float

    def row(self, rival: "Standing") -> str:
        ratio, low, high = bootstrap_median(rival.cost / self.cost)
        middle, least, most = bootstrap_median(self.cost)
        return (
            f"{self.name:20} {self.spp:7} {self.seconds:8.2f} s {self.relmse:10.3g} {middle:9.3g} [{least:.3g}, {most:.3g}]"
            f" {self.trimmed_cost:9.3g}  x{ratio:.2f} [{low:.2f}, {high:.2f}]"
            f"  {100 * self.difference:+.2f} +- {100 * self.difference_error:.2f} %"
        )


HEADER = (
    f"{'renderer':20} {'spp':>7} {'time':>10} {'relMSE':>10} {'relMSE x seconds [95 %]':>27} {'trimmed':>9}"
    "  times better than the last   mean against reference"
)


def standing(r: Runs, e: Errors, reference: Estimate) -> Standing:
    """Sums up one contender."""
    whole = estimate(r.images.mean(axis=(1, 2, 3)))
    truth = float(reference.mean.mean())
    return Standing(
        name=r.name,
        spp=r.spp,
        seconds=float(r.seconds.mean()),
        relmse=float(e.whole.mean()),
        cost=e.whole * r.seconds,
        trimmed_cost=float(np.median(e.trimmed * r.seconds)),
        difference=float(whole.mean) / truth - 1,
        difference_error=float(whole.error) / truth,
    )


def standings(all_runs: list[Runs], reference: Estimate | None) -> tuple[list[Standing], Estimate]:
    """Everybody's result, against a given reference or, where none is given, among their own independent renders."""
    if reference is not None:
        found = [errors.against_reference(r.images, reference) for r in all_runs]
    else:
        reference = pooled(all_runs)
        found = [errors.among_themselves(r.images, reference.mean) for r in all_runs]
    return [standing(r, e, reference) for r, e in zip(all_runs, found)], reference


def report(title: str, all_runs: list[Runs], reference: Estimate | None, folder: Path) -> list[Standing]:
    """Prints the table and writes JSON, CSV and a picture."""
    table, reference = standings(all_runs, reference)
    print(f"{title}: {len(all_runs[0].seconds)} rounds; the reference's own relMSE is {errors.own_error(reference):.2g}")
    print(HEADER)
    for row in table:
        print(row.row(table[-1]))
    folder.mkdir(parents=True, exist_ok=True)
    write_numbers(folder / title, table, all_runs)
    white = picture.white_of(reference.mean)
    shown = [picture.displayed(image, white) for image in (reference.mean, *(r.images[0] for r in all_runs))]
    mitsuba.write_png(folder / f"{title}.png", picture.side_by_side(*shown))
    print(f"numbers, and a picture (reference, then each in the order above), are in {folder}/{title}.*\n", flush=True)
    return table


def write_numbers(path: Path, table: list[Standing], all_runs: list[Runs]) -> None:
    """One row a render."""
    rows = [
        {"renderer": s.name, "round": i, "spp": s.spp, "seconds": float(t), "relmse": float(c / t)}
        for s, r in zip(table, all_runs)
        for i, (c, t) in enumerate(zip(s.cost, r.seconds))
    ]
    path.with_suffix(".json").write_text(json.dumps(rows, indent=1))
    with path.with_suffix(".csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def read_reference(path: Path) -> Estimate:
    """A reference as an .npz with `mean` and `se`."""
    data = np.load(path)
    return Estimate(data["mean"].astype(float), data["se"].astype(float) ** 2, np.inf)
