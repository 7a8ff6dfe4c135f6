"""Renders a picture by parts, each of which is a task, and merges them as they come."""

import sys
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation.cluster import farm, parts, task
from validation.cluster.job import Job
from validation.cluster.locked import alone
from validation.cluster.parts import Range
from validation.cluster.sums import Sums


def run(client: Any, job: Job, size: int, retries: int) -> None:
    """Renders what is missing of a picture, in parts of `size` samples, and writes it."""
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
    """Takes what is there already, and renders one sample here if nothing is: whatever is wrong with the scene, the options
    or the output, the program says before anything is sent. It refuses samples of another picture too."""
    sums.read()
    first = sums.there[0][0] if sums.there else 0
    resume = ["--resume"] if sums.there else []
    try:
        program.call([*job.part((first, first + 1)), "--sums", str(sums.file), "-o", str(job.output), *resume])
    except Failure as failure:
        raise Failure(failure.problem, f"correct the command; {sums.file} may be of another picture") from None
    sums.read()
    sums.gather()


def take(job: Job, sums: Sums, paths: list[str]) -> None:
    """Merges parts that came."""
    sums.add(paths)
    tell(job, sums, str(job.output))


def finish(job: Job, sums: Sums) -> None:
    """Writes the picture from the sums, as one render would that was resumed."""
    program.call(job.whole(sums.file))
    sums.read()
    sums.sweep()
    tell(job, sums, f"{job.output} is done")


def tell(job: Job, sums: Sums, what: str) -> None:
    """A line of progress."""
    done = parts.count(sums.there)
    noise = "" if sums.noise is None else f", noise {100 * sums.noise:.2g} %"
    print(f"{done} of {job.spp} samples/pixel ({100 * done / job.spp:.0f} %){noise}: {what}", file=sys.stderr, flush=True)
