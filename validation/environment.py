"""A private Python environment under target/, made once per set of requirements. Standard library only."""

import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
import venv
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from validation.places import ENVIRONMENT, REQUIREMENTS, REQUIREMENTS_CLUSTER, REQUIREMENTS_DEV, ROOT
from validation.places import PYTHON as PACKAGE

PYTHON = ENVIRONMENT / "bin" / "python"
STAMP = ENVIRONMENT / "stamp"


def enter(module: str = "validation") -> None:
    """Returns inside the environment; outside of it, makes it if need be and becomes a process in it."""
    if Path(sys.prefix).resolve() == ENVIRONMENT.resolve():
        return
    if sys.version_info < (3, 11):
        stop(f"Python 3.11 or newer is needed, this is {sys.version.split()[0]}", "install a newer Python 3")
    make_once()
    variables = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (ROOT, PACKAGE))), "PYTHONNOUSERSITE": "1"}
    os.execve(PYTHON, [str(PYTHON), "-m", module, *sys.argv[1:]], variables)


def stop(problem: str, remedy: str) -> NoReturn:
    """Ends the program: no package is there yet that has an exception for this."""
    print(f"{problem}\n  remedy: {remedy}", file=sys.stderr)
    sys.exit(2)


def make_once() -> None:
    """Makes the environment unless it is there already. Processes that start together wait for the first."""
    with locked():
        if not STAMP.exists() or STAMP.read_text() != wanted_stamp():
            make()
            STAMP.write_text(wanted_stamp())


@contextmanager
def locked() -> Iterator[None]:
    """Keeps other processes from changing the environment."""
    ENVIRONMENT.parent.mkdir(parents=True, exist_ok=True)
    with open(ENVIRONMENT.with_suffix(".lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def wanted_stamp() -> str:
    """Changes whenever the requirements or the interpreter do."""
    files = (REQUIREMENTS, REQUIREMENTS_CLUSTER, REQUIREMENTS_DEV)
    return hashlib.sha256(b"".join(map(Path.read_bytes, files)) + sys.version.encode()).hexdigest()


def make() -> None:
    """Creates the environment and installs the requirements."""
    print(f"validation: installing Mitsuba and friends into {ENVIRONMENT} (once)", file=sys.stderr)
    shutil.rmtree(ENVIRONMENT, ignore_errors=True)
    try:
        venv.create(ENVIRONMENT, with_pip=True)
    except (subprocess.CalledProcessError, OSError) as error:
        stop(f"no virtual environment could be made: {error}", "install Python's venv module (Debian: python3-venv)")
    install(REQUIREMENTS_DEV)


def extra(requirements: Path) -> None:
    """Adds what few commands need, on first use. An environment of the user's own is left as it is."""
    stamp = ENVIRONMENT / f"{requirements.stem}.stamp"
    if Path(sys.prefix).resolve() != ENVIRONMENT.resolve():
        return
    with locked():
        if not stamp.exists() or stamp.read_text() != requirements.read_text():
            print(f"validation: installing {requirements.name} into {ENVIRONMENT} (once)", file=sys.stderr)
            install(requirements)
            stamp.write_text(requirements.read_text())


def install(requirements: Path) -> None:
    """Installs by pip. Its messages go to stderr: stdout belongs to the command's table."""
    command: list[str | Path] = [PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-compile", "-r", requirements]
    if subprocess.run(command, stdout=sys.stderr).returncode != 0:
        stop("pip could not install the requirements", f"see its message above; then run again ({requirements})")
