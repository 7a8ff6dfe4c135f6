"""Studies over a cluster. A task is the whole study of one scene: its contenders must take turns on one machine, or their
times would say nothing, and `tyndall study` keeps what it has done in its folder. Their results become one study."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation import files
from validation.cluster import farm, task

PER_SCENE = ("--reference", "--reference-error")
"""Options that are given once for each scene, in their order."""


def run(client: Any, scenes: list[Path], output: Path, options: list[str], retries: int, command: str) -> None:
    """Runs the studies of all scenes, and writes what is there of the whole one each time one ends."""
    folders = [output.absolute() / "scenes" / name for name in names(scenes)]
    shared, own = dealt(options, len(scenes))
    futures = []
    for scene, folder, more in zip(scenes, folders, own):
        folder.mkdir(parents=True, exist_ok=True)
        words = [str(program.binary().absolute()), "--quiet", "study", str(scene.absolute()), "-o", str(folder), *shared, *more]
        futures.append(farm.submit(client, task.study, [words, str(folder)], f"study-{scene.stem}", retries))
    farm.finished(client, futures, lambda _: combine(folders, output, command))


def names(scenes: list[Path]) -> list[str]:
    """The scenes' names, by which a study tells them apart."""
    found = [scene.stem for scene in scenes]
    for scene in scenes:
        if not scene.is_file():
            raise Failure(f"{scene}: no such scene", "give the scenes first, then the options")
        if found.count(scene.stem) > 1:
            raise Failure(f"{scene}: two scenes have this name", "rename one of the files")
    return found


def dealt(options: Sequence[str], scenes: int) -> tuple[list[str], list[list[str]]]:
    """Options for all scenes, and those for each."""
    shared: list[str] = []
    own: list[list[str]] = [[] for _ in range(scenes)]
    given = dict.fromkeys(PER_SCENE, 0)
    words = iter(options)
    for word in words:
        name, equals, _ = word.partition("=")
        if name not in PER_SCENE:
            shared.append(word)
        elif given[name] < scenes:
            own[given[name]] += [word] if equals else [word, next(words, "")]
            given[name] += 1
    unfit = next((name for name, count in given.items() if count not in (0, scenes)), None)
    if unfit:
        raise Failure(f"{unfit} is given {given[unfit]} times for {scenes} scenes", "give it once for each scene, in their order")
    return shared, own


def combine(folders: list[Path], output: Path, command: str) -> None:
    """One study of those that are done: numbers, images and page."""
    done = [folder for folder in folders if (folder / "study.json").is_file()]
    studies = [json.loads((folder / "study.json").read_text()) for folder in done]
    for folder in done:
        shutil.copytree(folder / "images", output / "images", dirs_exist_ok=True)
    machines = sorted({study["machine"] for study in studies})
    scenes = [scene for study in studies for scene in study["scenes"]]
    # Dates and loads are those of one machine.
    conditions = studies[0].get("conditions") if len(studies) == 1 else None
    whole = {**studies[0], "command": command, "machine": "; ".join(machines), "conditions": conditions, "scenes": scenes}
    tables = [(folder / "study.csv").read_text().splitlines(keepends=True) for folder in done]
    files.write_text(output / "study.csv", "".join([tables[0][0], *(row for table in tables for row in table[1:])]))
    files.write_text(output / "study.json", json.dumps(whole, indent=2) + "\n")
    program.call([str(program.binary()), "--quiet", "report", str(output)])
    print(f"{len(done)} of {len(folders)} scenes: {output / 'study.html'}", flush=True)
