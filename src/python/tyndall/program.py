"""The program `tyndall`: where it is, its command lines, and its errors as exceptions."""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from tyndall.failure import Failure

Option = bool | float | str | Path | Sequence[object] | None
"""What an option of the command line may be; True is a flag, False and None leave it out."""
CLONE = Path(__file__).resolve().parents[3]
"""The repository, where this package is used from one without being installed."""


def binary() -> Path:
    """The program: $TYNDALL_BINARY, else the release build of the clone that this is, else the one installed with this
    package, else the one on the PATH."""
    named = os.environ.get("TYNDALL_BINARY")
    path = Path(named) if named else next(filter(Path.is_file, places()), None)
    if path is None or not path.is_file():
        place = f"{path or 'tyndall'}: no such program"
        raise Failure(place, "cargo build --release, or pip install . in a clone, or set TYNDALL_BINARY")
    return path


def places() -> list[Path]:
    """Where the program may be."""
    installed = Path(sysconfig.get_path("scripts"), "tyndall")
    found = shutil.which("tyndall")
    return [*clones(), installed, installed.with_suffix(".exe"), *([Path(found)] if found else [])]


def clones() -> list[Path]:
    """The release build of this clone, if it is one."""
    if not (CLONE / "Cargo.toml").is_file():
        return []
    return [Path(os.environ.get("CARGO_TARGET_DIR", CLONE / "target")).resolve() / "release" / "tyndall"]


def environment() -> dict[str, str]:
    """That of the program. Its words are read, so they have no colours, which notebooks ask for. It denoises by this Python."""
    return {"TYNDALL_PYTHON": sys.executable, **os.environ, "NO_COLOR": "1"}


def flags(options: Mapping[str, Option]) -> list[str]:
    """Options as on the command line."""
    return [part for name, value in options.items() for part in flag(f"--{name.replace('_', '-')}", value)]


def flag(name: str, value: Option) -> list[str]:
    """One option: True stands for its name alone, False and None for nothing."""
    if value is None or value is False:
        return []
    return [name] if value is True else [f"{name}={text(value)}"]


def text(value: object) -> str:
    """A value as the program reads it: several are separated by commas."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes)):
        return ",".join(map(text, value))
    return str(value)


def definitions(parameters: Mapping[str, str]) -> list[str]:
    """A scene's $parameters as on the command line."""
    return [part for name, value in parameters.items() for part in ("-D", f"{name}={value}")]


def call(command: list[str], patience: float | None = None, accepted: tuple[int, ...] = (0,)) -> subprocess.CompletedProcess[str]:
    """Runs the program, for so many seconds at most; what it says on stderr is shown only when it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=patience, env=environment())
    except subprocess.TimeoutExpired:
        raise too_slow(command, patience) from None
    if done.returncode not in accepted:
        raise failure(command, done.returncode, (done.stderr or done.stdout).strip())
    return done


def too_slow(command: list[str], patience: float | None) -> Failure:
    """The program took longer than it may."""
    return Failure(f"{' '.join(command)}: not done after {patience:g} s", "see what does not end")


def failure(command: list[str], code: int, said: str) -> Failure:
    """Why the program failed: its own words and its own remedy, if it said them."""
    mistake = re.search(r"^error: (.*?)\n  remedy: (.*)", said, re.DOTALL | re.MULTILINE)
    if mistake:
        return Failure(mistake[1], mistake[2].strip())
    usage = re.search(r"^error: (.*?)(?:\n\n  tip: ([^\n]*))?(?:\n\nUsage:.*)?(?:\n\nFor more.*)?$", said, re.DOTALL)
    if code == 2 and usage:
        return Failure(usage[1], usage[2] or "tyndall --help, and --help after a command, explain all options")
    if code < 0:
        return Failure(f"the program was ended by signal {-code}", "see whether the machine ran out of memory; a smaller size needs less")
    return Failure(f"{' '.join(command)}\n  exit code {code}: {said[-4000:]}", "run the command by hand")
