"""Files that are whole or not there, and reports that say how they were made."""

import json
import shlex
import sys
from pathlib import Path
from typing import Any

from validation.made import Made


def write_text(path: Path, text: str) -> None:
    """Writes a text file, its folder made if need be; whoever stops this halfway leaves the old file as it was."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    partial.write_text(text, encoding="utf-8", newline="")
    partial.replace(path)


def made_by_command() -> str:
    """The command that is running, which makes it again, but for where its results go."""
    words = sys.argv[1:]
    kept = [word for i, word in enumerate(words) if not word.startswith("--output") and words[i - 1 : i] != ["--output"]]
    return shlex.join(["python3", "-m", "validation", *kept])


def write_report(name: str, title: str, text: str, found: Any, *folders: Path) -> None:
    """Prints a report and writes it to folders as NAME.md, what programs may read of it, if anything, as NAME.json."""
    made = Made.by(made_by_command())
    whole = f"# {title}\n\n    {made.command}\n\n{made}.\n\n{text}"
    print(whole)
    for folder in folders:
        write_text(folder / f"{name}.md", whole)
        if found is not None:
            write_text(folder / f"{name}.json", json.dumps(found, indent=1) + "\n")
