"""The samples of a picture that are there: one file of sums beside it, into which parts are merged as they come. What this
file holds is all that is known of progress, so that a driver that was stopped goes on, and no part counts twice."""

import json
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation.cluster import parts
from validation.cluster.parts import Range

RESTRAINT = 10
"""Time between two pictures so far over the time that one takes."""

LATE = 30
"""Seconds that a shared folder may take to show a file."""


@dataclass
class Sums:
    """What is there of one picture."""

    output: Path
    """The picture."""
    folder: Path
    """Where parts come."""
    there: list[Range] = field(default_factory=list)
    """Samples that are merged."""
    noise: float | None = None
    """Their relative error, as it is estimated."""
    drawn: tuple[float, float] = (-1e9, 0)
    """When the last picture so far was written, and how long that took [s]."""

    @property
    def file(self) -> Path:
        """The sums, where `tyndall render --resume` looks for them too."""
        return self.output.with_suffix(".sums")

    def read(self) -> None:
        """Looks what the file of sums holds."""
        if self.file.is_file():
            told = info(self.file)
            self.there, self.noise = parts.parsed(told["samples"]), told.get("relative_error")

    def gather(self) -> None:
        """Adds what lies in the folder: parts that came while no driver was there."""
        whole = []
        for path in sorted(self.folder.glob("samples-*.sums")):
            try:
                info(path)
                whole.append(str(path))
            except Failure as failure:
                print(f"{failure.problem}\n  it is rendered again", file=sys.stderr)
                path.unlink()
        self.add(whole)

    def add(self, paths: list[str]) -> None:
        """Merges parts, those whose samples are not there yet; their files are no longer needed then."""
        new, there = [], list(self.there)
        for path in map(Path, paths):
            if parts.overlap([parts.named(path.name)], there):
                continue
            samples = parts.parsed(info(awaited(path))["samples"])
            if samples:
                new.append(path)
                there += samples
        if new:
            self.merge(new)
        for path in map(Path, paths):
            path.unlink(missing_ok=True)

    def merge(self, new: list[Path]) -> None:
        """Replaces the sums by those with `new` parts; the picture so far too, now and then."""
        begun = time.monotonic()
        last, cost = self.drawn
        draws = begun - last > RESTRAINT * cost
        merged = self.folder / "merged.sums"
        old = [self.file] if self.file.is_file() else []
        picture = ["-o", str(self.output)] if draws else []
        call("merge", *map(str, [*old, *new]), "--sums", str(merged), *picture)
        merged.replace(self.file)
        if draws:
            self.drawn = (time.monotonic(), time.monotonic() - begun)
        self.read()

    def sweep(self) -> None:
        """Removes what stopped attempts left in the folder, once the picture is there."""
        for pattern in ("samples-*", ".samples-*", "merged.sums", ".merged*"):
            for path in self.folder.glob(pattern):
                path.unlink(missing_ok=True)


def awaited(path: Path) -> Path:
    """A file that another machine says it has written: shared folders may show it late."""
    end = time.monotonic() + LATE
    while not path.is_file():
        if time.monotonic() > end:
            raise Failure(f"{path}: a worker has written it, and it is not here", "give a --folder that all machines share")
        time.sleep(0.2)
    return path


def info(path: Path) -> dict[str, Any]:
    """What `tyndall info` says of a file of sums."""
    found: dict[str, Any] = json.loads(call("info", str(path), "--json"))
    return found


def call(*words: str) -> str:
    """Runs the program here; its output."""
    return program.call([str(program.binary()), "--quiet", *words]).stdout
