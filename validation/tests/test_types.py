"""The type hints, by mypy."""

import subprocess
import sys

from validation.places import ROOT, TARGET


def test_types_hold() -> None:
    options = ["--config-file", "validation/mypy.ini", "--cache-dir", str(TARGET / "mypy-cache"), "-p", "tyndall", "-p", "validation"]
    done = subprocess.run([sys.executable, "-m", "mypy", *options], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
