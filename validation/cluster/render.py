"""Renders a picture by parts, each of which is a task, and merges them as they come."""

import fcntl
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from validation import tyndall
from validation.cluster import farm, parts, task
from validation.cluster.job import Job
from validation.cluster.parts import Range
from validation.cluster.sums import Sums
from validation.failure import Failure


def run(client: Any, job: Job, size: int, retries: int) -> None:
    """Renders what is missing of a picture, in parts of `size` samples, and writes it."""
    job.folder.mkdir(parents=True, exist_ok=True)
    with alone(job.folder):
        sums = Sums(job.output, job.folder)
        begin(job, sums)
        gaps = parts.cut(parts.missing(sums.there, job.spp), size)
        tell(job, sums, f"{len(gaps)} parts to render")
        futures = [submit(client, job, samples, retries) for samples in gaps]
        farm.finished(client, futures, lambda paths: take(job, sums, paths))
        finish(job, sums)


def submit(client: Any, job: Job, samples: Range, retries: int) -> Any:
    """One part as a task."""
    name = parts.name(samples)
    return farm.submit(client, task.render_part, [job.part(samples), str(job.folder), name], name, retries)


def begin(job: Job, sums: Sums) -> None:
    """Looks what is there already. If it is of another picture the program says so: the samples asked for here are
    there, so that it renders nothing."""
    sums.read()
    if sums.there:
        first = sums.there[0][0]
        try:
            tyndall.call([*job.part((first, first + 1)), "--sums", str(sums.file), "--resume"])
        except Failure as failure:
            remedy = f"correct the command; if another picture is meant, give another -o, or remove {sums.file}"
            raise Failure(failure.problem, remedy) from None
    sums.gather()


def take(job: Job, sums: Sums, paths: list[str]) -> None:
    """Merges parts that came."""
    sums.add(paths)
    tell(job, sums, str(job.output))


def finish(job: Job, sums: Sums) -> None:
    """Writes the picture from the sums, as one render would that was resumed."""
    tyndall.call(job.whole(sums.file))
    sums.read()
    sums.sweep()
    tell(job, sums, f"{job.output} is done")


def tell(job: Job, sums: Sums, what: str) -> None:
    """A line of progress."""
    done = parts.count(sums.there)
    noise = "" if sums.noise is None else f", noise {100 * sums.noise:.2g} %"
    print(f"{done} of {job.spp} samples/pixel ({100 * done / job.spp:.0f} %){noise}: {what}", file=sys.stderr, flush=True)


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Keeps a second driver of the same picture out."""
    with open(folder / ".lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Failure(f"{folder}: another driver is at work on this picture", "wait for it, or end it") from None
        try:
            yield
        except Failure:
            remove(folder)
            raise
        remove(folder)


def remove(folder: Path) -> None:
    """Removes the folder of parts unless there is something in it. Not after an interruption: parts may still be saved."""
    Path(folder, ".lock").unlink(missing_ok=True)
    if not any(folder.iterdir()):
        folder.rmdir()
