"""What a worker does: runs one command line. It is sent to workers by value, so they need nothing of this package, and
nothing but the standard library is used here."""

import shutil
import subprocess
import time
import uuid
from pathlib import Path

PAUSE = 1
"""Seconds before a failure is told: what passes by itself may have passed when Dask tries again."""


def render_part(command: list[str], folder: str, name: str) -> str:
    """Renders a part of a picture; the file of its sums, which is whole as soon as it has this name. Every attempt writes
    to a file of its own, so two of them are never in each other's way; what an attempt left that was stopped is gone on from."""
    own = Path(folder, f"{name}.{uuid.uuid4().hex}.attempt")
    resumed = claim(Path(folder), name, own)
    try:
        run([*command, "--sums", str(own), *(["--resume"] if resumed else [])], folder)
    except RuntimeError:
        if not resumed:
            raise
        own.unlink(missing_ok=True)
        run([*command, "--sums", str(own)], folder)
    return str(own.replace(Path(folder, f"{name}.sums")))


def claim(folder: Path, name: str, own: Path) -> bool:
    """Takes over the sums of an earlier attempt: true if there were any. Of several who try, one succeeds."""
    for left in folder.glob(f"{name}.*.attempt"):
        try:
            left.replace(own)
            return True
        except FileNotFoundError:
            continue
    return False


def run(command: list[str], folder: str) -> None:
    """Runs a command line in `folder`; what it says is told only if it fails."""
    done = subprocess.run([*guard(), *command], cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        time.sleep(PAUSE)
        said = (done.stderr or done.stdout).strip()[-2000:]
        raise RuntimeError(f"{' '.join(command)}\n  exit code {done.returncode}: {said}")


def guard() -> list[str]:
    """Lets the program end, and save what it has, when its worker is killed; by util-linux, where that is."""
    found = shutil.which("setpriv")
    return [found, "--pdeathsig", "TERM"] if found else []


def study(command: list[str], folder: str) -> str:
    """Runs a study, or what is left of it, in the folder that its scene has; the folder."""
    run(command, folder)
    return folder
