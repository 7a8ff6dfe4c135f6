"""A wheel for Linux, tried in an environment of its own; and whether the program compiles for platforms that nobody here tries."""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import venv
from collections.abc import Iterator
from pathlib import Path

from tyndall.failure import Failure
from validation import environment
from validation.page import Finding, told
from validation.places import OUTPUT, REQUIREMENTS_WHEELS, ROOT

TEXT = "Builds a wheel for Linux, tries it in an environment of its own, and compiles the program for other platforms: minutes."
POLICY = "manylinux2014"
"""PEP 599: glibc 2.17 or newer, which every distribution since 2014 has."""
ELSEWHERE = ("aarch64-unknown-linux-gnu", "x86_64-pc-windows-gnu", "aarch64-apple-darwin", "x86_64-apple-darwin")
TRIAL = """
import numpy, tyndall
image = tyndall.render("fog.json", spp=1, size=(16, 12))
assert image.shape == (12, 16, 3) and numpy.isfinite(image).all() and image.mean() > 0
"""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--output", type=Path, default=OUTPUT / "wheels", help="folder for the wheel (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Prints a line for every claim; true if all hold."""
    environment.extra(REQUIREMENTS_WHEELS)
    wheel = built(options.output)
    return all([told(finding) for finding in (*tried(wheel), *compiled())])


def built(folder: Path) -> Path:
    """The wheel. maturin refuses one that needs a library, or a version of one, which the policy does not name."""
    target = f"{platform.machine()}-unknown-linux-gnu"
    command = [sys.executable, "-m", "maturin", "build", "--release", "--locked", "--zig", "--target", target, "--compatibility", POLICY, "--out", str(folder)]
    path = os.pathsep.join([str(environment.PYTHON.parent), os.environ["PATH"]])
    if subprocess.run(command, cwd=ROOT, env={**os.environ, "PATH": path}, stdout=sys.stderr).returncode != 0:
        raise Failure("no wheel was built", "see what maturin says above")
    return max(folder.glob(f"tyndall-*{POLICY}*.whl"), key=lambda path: path.stat().st_mtime)


def tried(wheel: Path) -> Iterator[Finding]:
    """What a new user does with it, where nothing of this repository is."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as name:
        folder = Path(name)
        venv.create(folder / "env", with_pip=True)
        python, program = folder / "env" / "bin" / "python", folder / "env" / "bin" / "tyndall"
        commands: dict[str, list[str | Path]] = {
            f"{wheel.name} installs": [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", wheel.resolve()],
            "tyndall new writes a scene": [program, "new", "fog", "-o", "fog.json"],
            "tyndall render renders it": [program, "render", "fog.json", "--spp", "1", "--size", "16x12"],
            "Python renders it": [python, "-c", TRIAL],
        }
        for claim, command in commands.items():
            yield claim, against(command, folder)


def compiled() -> Iterator[Finding]:
    """Whether it would, for each platform; nothing is linked."""
    for target in ELSEWHERE:
        added = against(["rustup", "target", "add", target], ROOT)
        yield f"compiles for {target}", added or against(["cargo", "check", "--release", "--locked", "--target", target], ROOT)


def against(command: list[str | Path], folder: Path) -> str:
    """What the command has to complain of; nothing of this repository is in its way."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "TYNDALL"))}
    try:
        done = subprocess.run(command, cwd=folder, env=clean, capture_output=True, text=True)
    except OSError as error:
        return str(error)
    return "" if done.returncode == 0 else done.stderr[-800:]
