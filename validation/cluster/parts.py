"""Samples of a picture, and how those that are missing are cut into parts."""

import re
from collections.abc import Iterable

from tyndall.failure import Failure

Range = tuple[int, int]
"""The samples A to B - 1 of every pixel."""


def parsed(text: str) -> list[Range]:
    """Ranges as `tyndall info` spells them: `0..8, 32..40`."""
    return [(int(first), int(end)) for first, end in re.findall(r"(\d+)\.\.(\d+)", text)]


def spelled(samples: Range) -> str:
    """A range as `--samples` takes it."""
    return f"{samples[0]}..{samples[1]}"


def overlap(some: Iterable[Range], others: Iterable[Range]) -> bool:
    """True if any sample is in both."""
    others = list(others)
    return any(a < d and c < b for a, b in some for c, d in others)


def count(ranges: Iterable[Range]) -> int:
    """Samples in ranges that do not overlap."""
    return sum(end - first for first, end in ranges)


def missing(there: Iterable[Range], total: int) -> list[Range]:
    """The gaps in the samples 0 to `total` - 1."""
    gaps, at = [], 0
    for first, end in sorted(there):
        gaps.append((at, min(first, total)))
        at = max(at, end)
    return [(first, end) for first, end in [*gaps, (at, total)] if first < end]


def cut(gaps: Iterable[Range], size: int) -> list[Range]:
    """The gaps in parts of at most `size` samples."""
    return [(at, min(at + size, end)) for first, end in gaps for at in range(first, end, size)]


def part_size(total: int, parts: int | None, samples: int | None, workers: int) -> int:
    """Samples of a part: as wanted, else so many that each of the workers gets several."""
    for name, value in (("--parts", parts), ("--samples-per-part", samples), ("--spp", total)):
        if value is not None and value < 1:
            raise Failure(f"{name} is {value}", "give at least 1")
    return samples or -(-total // (parts or number(workers)))


def number(workers: int) -> int:
    """Of parts, unless the user wants another."""
    return max(FEWEST, PER_WORKER * workers)


FEWEST = 16
"""Parts of a picture: what a killed worker loses is at most one."""
PER_WORKER = 4
"""Parts for each worker: fast ones then take some from slow ones."""


def name(samples: Range) -> str:
    """Of a part's files; they sort by samples."""
    return f"samples-{samples[0]:07}-{samples[1]:07}"


def named(file: str) -> Range:
    """The samples of a part, by the name of its file."""
    first, end = map(int, re.findall(r"\d+", file)[:2])
    return first, end
