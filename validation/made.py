"""How a report was made: by which program and code, when, on what machine."""

import os
import platform
import re
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from tyndall import program
from validation import sources
from validation.places import ROOT

SOURCES = re.compile(r"sources ([0-9a-f]{12})")


@dataclass(frozen=True)
class Made:
    """What a report says of itself."""

    command: str
    version: str
    commit: str
    """Of the sources beside it, with a remark if they have changed since."""
    sources: str
    """Digest of the code that makes samples."""
    date: str
    processor: str
    load: float
    """Processes that ran or waited during the minute before."""
    seconds: float
    """Until it was done; what was taken over from before took none of them."""

    @staticmethod
    def by(command: str) -> "Made":
        """Of what ends now and began with this process."""
        version = program.call([str(program.binary()), "--version"]).stdout.strip()
        return Made(command, version, COMMIT, DIGEST, TODAY, processor(), LOAD, time.monotonic() - START)

    def __str__(self) -> str:
        return (
            f"{self.version}, commit {self.commit}, sources {self.sources}, {self.date}; {self.processor}, load {self.load:.2f} at the start;"
            f" {self.seconds:.0f} s"
        )


def sources_of(report: Path) -> str | None:
    """Which sources a report names, if it is there."""
    found = SOURCES.search(report.read_text()) if report.is_file() else None
    return found and found[1]


def commit() -> str:
    """Of this clone."""
    told = lambda *words: subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True).stdout.strip()
    changed = " and changes" if told("status", "--porcelain", "--untracked-files=no", "src", "Cargo.lock") else ""
    return (told("rev-parse", "--short", "HEAD") or "unknown") + changed


def processor() -> str:
    """How many there are, and their name."""
    information = Path("/proc/cpuinfo")
    named = (line.split(":")[1].strip() for line in information.read_text().splitlines() if line.startswith("model name")) if information.is_file() else ()
    return f"{os.cpu_count()} x {next(iter(named), platform.machine())}"


START, LOAD, TODAY = time.monotonic(), os.getloadavg()[0], time.strftime("%Y-%m-%d", time.gmtime())
COMMIT, DIGEST = commit(), sources.digest()
"""All of this as the process begins: while it measures, someone may go on with the work."""
