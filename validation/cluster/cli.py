"""The commands of `python3 -m validation.cluster`."""

import argparse
import os
import shlex
import sys
from pathlib import Path

from tyndall.failure import Failure
from validation.cluster import farm, parts, render, study, tiles
from validation.cluster.job import Job, job
from validation.cluster.parts import part_size

TEXT = "One picture, or one study, by many processes or machines over Dask distributed (validation/cluster/README.md)."


def main(arguments: list[str]) -> int:
    """Runs one command. What the parser does not know is for `tyndall`."""
    options, more = parser().parse_known_args(arguments)
    command = shlex.join(["python3", "-m", "validation.cluster", *arguments])
    options.command(options, [*(word for pair in options.D for word in ("-D", pair)), *more], command)
    return 0


def parser() -> argparse.ArgumentParser:
    """All commands and their own options."""
    top = argparse.ArgumentParser(prog="python3 -m validation.cluster", description=TEXT)
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    for name, run, text in (
        ("render", run_render, "Render a picture by parts, each a task, merged as they come; further options are those of tyndall render."),
        ("commands", run_commands, "Print the command lines of the parts of a picture, for any other scheduler; then tyndall merge."),
    ):
        command = commands.add_parser(name, help=text, description=text, allow_abbrev=False)
        add_picture(command)
        command.set_defaults(command=run)
        if name == "render":
            add_cluster(command)
    add_study(commands.add_parser("study", help=STUDY, description=STUDY, allow_abbrev=False))
    return top


STUDY = "Run a study, each scene a task on one machine; further options are those of tyndall study."


def add_study(command: argparse.ArgumentParser) -> None:
    """Studies."""
    command.add_argument("scenes", nargs="+", type=Path, metavar="SCENE", help="scene files, before all options")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="folder that all machines share")
    add_definitions(command)
    add_cluster(command)
    command.set_defaults(command=run_study)


def add_picture(command: argparse.ArgumentParser) -> None:
    """What picture, and how it is cut."""
    command.add_argument("scene", metavar="SCENE", help="scene file, before all options; at this path on every machine")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="FILE", help="image to write")
    command.add_argument("--spp", type=int, metavar="N", help="samples per pixel (default: the scene's), or with --error the most of them")
    size = command.add_mutually_exclusive_group()
    size.add_argument("--parts", type=int, metavar="N", help="number of parts (default: 4 for each worker, at least 16)")
    size.add_argument("--samples-per-part", type=int, metavar="N", help="samples per pixel of a part, instead")
    command.add_argument("--folder", type=Path, metavar="SHARED", help="folder that all machines share, for the parts (default: the image's)")
    add_definitions(command)


def add_definitions(command: argparse.ArgumentParser) -> None:
    """$parameters of a scene."""
    command.add_argument("-D", metavar="NAME=VALUE", action="append", default=[], help="a parameter of the scene")


def add_cluster(command: argparse.ArgumentParser) -> None:
    """Where tasks run."""
    command.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786 (default: workers on this machine)")
    command.add_argument("--workers", type=int, default=1, metavar="N", help="processes on this machine, which share its processors (default 1)")
    command.add_argument("--retries", type=int, default=3, metavar="N", help="further attempts of a task that fails (default 3)")


def run_render(options: argparse.Namespace, more: list[str], _: str) -> None:
    if options.scheduler is None:
        more = shared(more, options.workers)
    picture = wanted(options, more)
    with farm.connected(options.scheduler, options.workers, options.retries) as client:
        workers = farm.slots(client)
        if picture.is_to_error:
            tiles.run(client, picture, count(options, workers), options.retries)
        else:
            render.run(client, picture, size_of(options, picture, workers), options.retries)


def run_commands(options: argparse.Namespace, more: list[str], _: str) -> None:
    picture = wanted(options, more)
    if picture.is_to_error:
        found = [(tiles.name(crop), picture.tile(crop)) for crop in tiles.cut(*picture.size(), count(options, 1))]
    else:
        samples = parts.cut([(0, picture.spp)], size_of(options, picture, 1))
        found = [(parts.name(some), picture.part(some)) for some in samples]
    for name, words in found:
        print(shlex.join([*words, "--sums", str(picture.folder / f"{name}.sums")]))
    picture.folder.mkdir(parents=True, exist_ok=True)
    print(f"then: tyndall merge {shlex.quote(str(picture.folder))}/*.sums -o {shlex.quote(str(picture.output))}", file=sys.stderr)


def run_study(options: argparse.Namespace, more: list[str], command: str) -> None:
    more = shared(more, options.workers) if options.scheduler is None else more
    with farm.connected(options.scheduler, options.workers, options.retries) as client:
        study.run(client, options.scenes, options.output, more, options.retries, command)


def wanted(options: argparse.Namespace, more: list[str]) -> Job:
    """The picture that was asked for."""
    return job(options.scene, options.output, more, options.spp, options.folder)


def count(options: argparse.Namespace, workers: int) -> int:
    """Parts of a picture to an error."""
    if options.samples_per_part is not None:
        raise Failure("--samples-per-part is given: a render to an --error is cut into parts of the image", "give --parts instead")
    if options.parts is not None and options.parts < 1:
        raise Failure(f"--parts is {options.parts}", "give at least 1")
    return options.parts or parts.number(workers)


def size_of(options: argparse.Namespace, picture: Job, workers: int) -> int:
    """Samples of a part."""
    return part_size(picture.spp, options.parts, options.samples_per_part, workers)


def shared(more: list[str], workers: int) -> list[str]:
    """The options with this machine's threads shared out among its workers, unless they say something of threads."""
    if any(word.partition("=")[0] == "--threads" for word in more):
        return more
    return [*more, "--threads", str(max(1, (os.cpu_count() or 1) // workers))]

