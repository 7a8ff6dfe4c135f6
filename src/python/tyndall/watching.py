"""A render while it runs: progress as a bar in terminals and notebooks, and Ctrl-C, which keeps the image so far."""

import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
import warnings
from dataclasses import dataclass, field
from typing import IO, Any, Protocol

from tyndall.program import environment, too_slow


@dataclass
class Outcome:
    """How a program ended."""

    code: int
    was_interrupted: bool = False
    said: list[str] = field(default_factory=list)
    """Lines of standard error that are no progress."""

    @property
    def messages(self) -> str:
        return "\n".join(self.said)


class Show(Protocol):
    """What becomes of updates of the progress."""

    def update(self, progress: dict[str, Any]) -> None: ...
    def close(self) -> None: ...


def run(command: list[str], show: Show, patience: float | None = None) -> Outcome:
    """Runs the program to its end. It is in a process group of its own, so that a Ctrl-C, which terminals and notebooks send
    to whole groups, comes to it once, from here: a second one would end it before it has written its image."""
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, process_group=0, env=environment()
    )
    try:
        return followed(process, command, show, patience)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        show.close()


def followed(process: subprocess.Popen[str], command: list[str], show: Show, patience: float | None) -> Outcome:
    """Everything it says, until it ends."""
    assert process.stderr is not None
    lines = listened(process.stderr)
    until = float("inf") if patience is None else time.monotonic() + patience
    outcome = Outcome(0)
    while time.monotonic() < until:
        try:
            line = lines.get(timeout=WAKE)
            if line is None:
                outcome.code = process.wait()
                return outcome
            take(line, show, outcome)
        except queue.Empty:
            continue
        except KeyboardInterrupt:
            if outcome.was_interrupted:
                raise
            outcome.was_interrupted = True
            process.send_signal(signal.SIGINT)
    raise too_slow(command, patience)


WAKE = 0.1
"""So often the main thread looks up [s]: where another thread is the one that gets the signal of a Ctrl-C, a wait does not end."""


def listened(stream: IO[str]) -> "queue.Queue[str | None]":
    """The lines of a stream as they come, then None. A thread reads them: whoever waits for them can be interrupted."""
    lines: queue.Queue[str | None] = queue.Queue()

    def read() -> None:
        with stream:
            for line in stream:
                lines.put(line.rstrip("\n"))
        lines.put(None)

    threading.Thread(target=read, daemon=True).start()
    return lines


def take(line: str, show: Show, outcome: Outcome) -> None:
    """One line: progress is shown, anything else is kept."""
    if line.startswith('{"done"'):
        show.update(json.loads(line))
    else:
        outcome.said.append(line)


class Silence:
    """No progress."""

    def update(self, progress: dict[str, Any]) -> None: ...
    def close(self) -> None: ...


class Bar:
    """A bar of tqdm, in percent: text in terminals, a widget in notebooks that have ipywidgets."""

    def __init__(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # without ipywidgets notebooks get the text
            from tqdm.auto import tqdm
        self.bar = tqdm(total=100, unit="%", leave=False, bar_format="{percentage:3.0f}%|{bar}| {desc} [{elapsed}<{remaining}]")

    def update(self, progress: dict[str, Any]) -> None:
        self.bar.set_description_str(described(progress), refresh=False)
        self.bar.update(100 * progress["done"] - self.bar.n)

    def close(self) -> None:
        self.bar.close()


def described(progress: dict[str, Any]) -> str:
    """Samples and noise, as the program's own bar has them; of a study what it is doing."""
    if "doing" in progress:
        return str(progress["doing"])
    noise, within = progress.get("noise"), progress.get("within")
    state = f"noise {100 * noise:.2g} %" if noise is not None else "noise not known yet"
    state = state if within is None else f"{100 * within:.1f} % of the pixels within the error"
    image = f"{progress['image']}, " if progress.get("image") else ""
    return f"{image}{progress.get('samples_per_pixel', 0)} samples/pixel, {state}"


def shown(progress: bool | None) -> Show:
    """What shows progress: None lets it depend on whether somebody looks, in a terminal or a notebook."""
    wanted = is_watched() if progress is None else progress
    return Bar() if wanted else Silence()


def is_watched() -> bool:
    """True in a notebook, and where standard error is a terminal."""
    ipython = sys.modules.get("IPython")
    in_notebook = ipython is not None and hasattr(ipython.get_ipython(), "kernel")
    return in_notebook or (sys.stderr is not None and sys.stderr.isatty())


def warn(message: str, kind: type[Warning]) -> None:
    """A warning at the user's line that called this package."""
    folder, frame, level = os.path.dirname(__file__), sys._getframe(), 1
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == folder:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, kind, stacklevel=level)
