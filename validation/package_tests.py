"""The tests of this package, by pytest."""

import subprocess
import sys

from validation.places import ROOT


def run() -> bool:
    """True if all hold; says which do not. In a process of its own: tests choose Mitsuba's variants as they like."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=5", "validation/tests"]
    return subprocess.run(command, cwd=ROOT).returncode == 0
