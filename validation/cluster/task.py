"""What a worker does: runs one command line. It is sent to workers by value, so they need nothing of this package, and
nothing but the standard library is used here."""

import subprocess
import sys
import time
import uuid
from pathlib import Path
from subprocess import PIPE, STDOUT

GUARD = """
import subprocess, sys, threading

child = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL)
threading.Thread(target=lambda: (sys.stdin.read(), child.terminate()), daemon=True).start()
sys.exit(child.wait())
"""
"""Runs a program, and ends it once when its own input ends, as it does when the worker that holds it is killed: the program
then saves what it has. The kernel's signal to children of the dead would come for every thread that dies, and the second
such signal stops the saving."""
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
        run([*command, "--sums", str(own)], folder)
    return str(own.replace(Path(folder, f"{name}.sums")))


def claim(folder: Path, name: str, own: Path) -> bool:
    """Takes over the sums of an earlier attempt: true if there were any. Of several who try, one succeeds."""
    for left in sorted(folder.glob(f"{name}.*.attempt*"), key=lambda path: path.suffix):  # .attempt, then .previous
        try:
            left.replace(own)
            return True
        except FileNotFoundError:
            continue
    return False


def run(command: list[str], folder: str) -> None:
    """Runs a command line in `folder`; what it says is told only if it fails."""
    guarded = [sys.executable, "-c", GUARD, *command]
    with subprocess.Popen(guarded, cwd=folder, stdin=PIPE, stdout=PIPE, stderr=STDOUT, text=True, start_new_session=True) as process:
        assert process.stdout is not None
        said = process.stdout.read().strip()[-2000:]
        code = process.wait()
    if code != 0:
        time.sleep(PAUSE)
        raise RuntimeError(f"{' '.join(command)}\n  exit code {code}: {said}")


def study(command: list[str], folder: str) -> str:
    """Runs a study, or what is left of it, in the folder that its scene has; the folder."""
    run(command, folder)
    return folder
