"""The options of `tyndall render` as Python has them. They are the program's own: read from its help, so that whichever
program is used, its options are checked before anything runs."""

import difflib
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from tyndall.failure import Failure
from tyndall.program import binary, call, flag, text

OTHERWISE = {
    "output": "call .save(file) of the picture",
    "report": "look at .report of the picture",
    "json": "look at .report of the picture",
    "quiet": "give progress=False",
    "verbose": "look at .report of the picture",
    "denoise": "give features=True and call .denoised() of the picture",
    "layers": "look at .layers of the picture",
    "help": "print(tyndall.options())",
    "version": "print(tyndall.program.call([str(tyndall.program.binary()), '--version']).stdout)",
    "define": 'give parameters={"name": value}',
    "D": 'give parameters={"name": value}',
}
"""Options that Python has other ways for."""


def options(command: str = "render") -> str:
    """The options of a command, with what the program's help says of each."""
    found = re.findall(r"^ +(?:-\w, )?--([a-z][a-z-]*) ?(\S*) {2,}(.*)$", help_of(binary(), command), re.MULTILINE)
    python = [(name.replace("-", "_"), takes, spelled(text, command)) for name, takes, text in found]
    return "\n".join(f"{f'{name} {takes}':30} {text}" for name, takes, text in python if name not in OTHERWISE and name != "progress")


@cache
def help_of(program: Path, command: str) -> str:
    """The short help of a command."""
    return call([str(program), command, "-h"]).stdout


def names(command: str = "render") -> list[str]:
    """The options of a command, as Python spells them."""
    found = re.findall(r"^ +(?:-\w, )?--([a-z][a-z-]*)", help_of(binary(), command), re.MULTILINE)
    found += re.findall(r"\[alias(?:es)?: --([a-z-]+)\]", help_of(binary(), command))
    return [name.replace("-", "_") for name in found]


def words(given: Mapping[str, Any], command: str = "render") -> list[str]:
    """The options as on the command line; an error for what the program does not have."""
    known = names(command)
    for name in given:
        if name in OTHERWISE and command == "render":
            raise Failure(f"{name} is no option here", OTHERWISE[name])
        if name not in known or name == "progress":
            raise Failure(f"there is no option {name}", remedy(name, known))
    return [word for name in given for one in repeated(name, value(name, given[name]), command) for word in flag(f"--{name.replace('_', '-')}", one)]


def repeated(name: str, given: Any, command: str) -> list[Any]:
    """What an option is given for: a list once, separated by commas, where the program takes a list, else once for each; a
    dictionary as `name: value` for each, or as `name=value` where the program wants that."""
    if isinstance(given, Mapping):
        mark = "=" if f"--{name} <OPTION=LIST>" in help_of(binary(), command) else ": "
        return [f"{key}{mark}{text(inner)}" for key, inner in given.items()]
    takes_list = re.search(rf"--{name.replace('_', '-')} <LIST>", help_of(binary(), command))
    is_list = isinstance(given, (list, tuple)) and not takes_list
    return list(given) if is_list else [given]


def remedy(name: str, known: list[str]) -> str:
    """What may have been meant."""
    likely = difflib.get_close_matches(name, [*known, "parameters"], n=2, cutoff=0.6)
    meant = f"did you mean {' or '.join(likely)}? " if likely else ""
    return f"{meant}print(tyndall.options()) lists all"


def value(name: str, given: Any) -> Any:
    """One value as the program spells it."""
    if name == "size":
        return size(given)
    if name == "frames":
        return frame(given)
    return given


def size(given: Any) -> str | None:
    """(width, height)."""
    if given is None or isinstance(given, str):
        return given
    try:
        width, height = (int(side) for side in given if int(side) == side)
    except (TypeError, ValueError):
        raise Failure(f"size={given!r}: expected (width, height) in whole pixels", f"give size={example(given)}") from None
    return f"{width}x{height}"


def example(given: Any) -> str:
    """A size like the one that was meant."""
    side = int(given) if isinstance(given, (int, float)) and 1 <= given <= 65536 else None
    return f"({side}, {side})" if side else "(640, 480)"


def frame(given: Any) -> str | None:
    """One frame: a call gives one picture."""
    if given is None or re.fullmatch(r"\d+", str(given)):
        return None if given is None else str(given)
    once = "[tyndall.render(scene, frames=frame) for frame in range(48)]"
    raise Failure(f"frames={given!r}: expected the number of one frame, as a call gives one picture", f"write {once}")


def spelled(message: str, command: str = "render") -> str:
    """A message of the program with its options as Python spells them: max_depth for '--max-depth <N>'."""
    known = names(command)

    def name(found: re.Match[str]) -> str:
        python = found[2].replace("-", "_")
        return python if python in known and python != "help" else found[0]

    return re.sub(r"('?)--([a-z][a-z-]*)(?: <[^>]*>)?\1", name, message)
