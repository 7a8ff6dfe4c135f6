"""Renders a picture to an error by parts of it side by side, each of which is a task, and puts them together at the end."""

import json
import sys
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation.cluster import farm, task
from validation.cluster.job import Job
from validation.cluster.locked import alone
from validation.cluster.sums import awaited, call, info


def cut(width: int, height: int, count: int) -> list[str]:
    """About `count` parts of an image, as `--crop` takes them: rows of about square ones."""
    rows = min(height, max(1, round((count * height / width) ** 0.5)))
    columns = min(width, -(-count // rows))
    lefts = [column * width // columns for column in range(columns + 1)]
    tops = [row * height // rows for row in range(rows + 1)]
    return [f"{right - left}x{bottom - top}+{left}+{top}" for top, bottom in zip(tops, tops[1:]) for left, right in zip(lefts, lefts[1:])]


def name(crop: str) -> str:
    """Of a part's files."""
    return f"crop-{crop}"


def run(client: Any, job: Job, count: int, retries: int) -> None:
    """Renders what is missing of a picture of about `count` parts, and writes it."""
    with alone(job.folder):
        crops = cut(*job.size(), count)
        there = begin(job, crops)
        tell(job, there, crops)
        missing = [crop for crop in crops if crop not in there]
        futures = [farm.submit(client, task.render_part, [job.tile(crop), str(job.folder), name(crop)], name(crop), retries) for crop in missing]

        def take(paths: list[str]) -> None:
            there.extend(awaited(Path(path)).stem.removeprefix("crop-") for path in paths)
            tell(job, there, crops)

        farm.finished(client, futures, take)
        call("merge", *(str(file(job, crop)) for crop in crops), "-o", str(job.output))
        sweep(job)


def file(job: Job, crop: str) -> Path:
    """The sums of a part, which are whole once they have this name."""
    return job.folder / f"{name(crop)}.sums"


def begin(job: Job, crops: list[str]) -> list[str]:
    """Renders one sample here: whatever is wrong with the command, the program says before anything is sent. The parts
    that are there already, which must be of this picture."""
    trial = job.folder / "trial.sums"
    program.call([*job.render(), "--spp", "1", "--sums", str(trial), "-o", str(job.folder / job.output.name)])
    there = [crop for crop in crops if file(job, crop).is_file()]
    for crop in there:
        if settings(file(job, crop)) != settings(trial):
            raise Failure(f"{file(job, crop)}: a part of another picture", "give the command that it is of, another --folder, or remove it")
    return there


CHOSEN = ("chosen_by_pilot", "guide", "basis", "aimed_starts", "learnt_starts", "sky")
"""What decides about noise alone: parts may differ in it, as `merge` allows (src/cli/provenance.rs: of_image)."""


def settings(path: Path) -> dict[str, Any]:
    """How a picture is made, whichever part of it."""
    found: dict[str, Any] = info(path)["settings"]
    del found["film"]["window"]
    return {name: value for name, value in found.items() if name not in CHOSEN}


def tell(job: Job, there: list[str], crops: list[str]) -> None:
    """A line of progress."""
    what = f"{job.output} is next" if len(there) == len(crops) else str(job.folder)
    print(f"{len(there)} of {len(crops)} parts: {what}", file=sys.stderr, flush=True)


def sweep(job: Job) -> None:
    """Removes the parts and what stopped attempts left, once the picture is there."""
    image = job.folder / job.output.name
    for pattern in ("crop-*", ".crop-*", "trial.sums*", image.name, image.with_suffix(".png").name):
        for path in job.folder.glob(pattern):
            path.unlink(missing_ok=True)
