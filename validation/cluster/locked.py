"""The folder of a picture's parts, in which one driver works at a time."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from tyndall.failure import Failure


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Keeps a second driver of the same picture out."""
    with lock_file(folder) as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Failure(f"{folder}: another driver is at work on this picture", "wait for it, or end it") from None
        try:
            yield
        except Failure:
            remove(folder)
            raise
        remove(folder)


def lock_file(folder: Path) -> TextIO:
    """A file to be locked, in a folder that is made if need be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return open(folder / ".lock", "w")
    except OSError as error:
        raise Failure(f"{folder}: no folder that can be written: {error.strerror}", "give another --folder, or -o") from None


def remove(folder: Path) -> None:
    """Removes the folder of parts unless there is something in it. Not after an interruption: parts may still be saved."""
    Path(folder, ".lock").unlink(missing_ok=True)
    if not any(folder.iterdir()):
        folder.rmdir()
