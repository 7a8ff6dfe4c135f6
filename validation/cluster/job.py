"""What picture is to be rendered: a scene and options of `tyndall render`, which stay as they are given."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from validation.cluster import parts
from validation.cluster.parts import Range

OURS = {"--samples", "--crop", "--sums", "--checkpoint", "--resume"}
"""Options that say what a part is."""
NOT_CUT = {"--time-limit", "--batches", "--frames", "--fps", "--preview", "--progressive", "--fraction", "--json", "--report"}
"""Options of renders that are no sum of parts, or that every part would write to one file."""


@dataclass(frozen=True)
class Job:
    """A picture."""

    scene: Path
    output: Path
    options: list[str]
    """All else on the command line of `tyndall render`."""
    spp: int
    """Samples per pixel, or with --error the most of them; 0 for no limit."""
    folder: Path
    """Where parts come; shared by all machines."""

    def part(self, samples: Range) -> list[str]:
        """The command line of a part, without the file of its sums."""
        return [*self.render(), "--samples", parts.spelled(samples)]

    def tile(self, crop: str) -> list[str]:
        """The same of a part of a picture to an error: some of its pixels, not of its samples."""
        return [*self.render(), *(["--spp", str(self.spp)] if self.spp else []), "--crop", crop]

    def whole(self, sums: Path) -> list[str]:
        """The command line of the picture, which adds whatever `sums` lacks."""
        return [*self.render(), "--spp", str(self.spp), "--sums", str(sums), "--resume", "-o", str(self.output)]

    @property
    def is_to_error(self) -> bool:
        """True if pixels differ in their numbers of samples."""
        return given(self.options, "--error") is not None

    def size(self) -> tuple[int, int]:
        """Pixels across and down."""
        size = given(self.options, "--size")
        if size is None:
            told = info(self.scene, self.options)
            return int(told["width"]), int(told["height"])
        width, height = map(int, size.lower().split("x"))
        return width, height

    def render(self) -> list[str]:
        """What all parts share."""
        return [str(program.binary().absolute()), "--quiet", "render", str(self.scene), *self.options]


def job(scene: str, output: Path, options: list[str], spp: int | None, folder: Path | None) -> Job:
    """A picture as it stands on the command line."""
    path, output = Path(scene).absolute(), output.absolute()
    if not path.is_file():
        raise Failure(f"{scene}: no such scene", "give the scene first, then the options")
    for word in options:
        refuse(word.partition("=")[0])
    parent = (folder or output.parent).absolute()
    if spp is None:
        spp = 0 if given(options, "--error") else int(info(path, options)["samples_per_pixel"])
    return Job(path, output, options, spp, parent / f"{output.name}.parts")


def given(options: list[str], name: str) -> str | None:
    """The value of an option, the last one where it is given several times."""
    found = None
    for word, after in zip(options, [*options[1:], ""]):
        option, equals, value = word.partition("=")
        if option == name:
            found = value if equals else after
    return found


def refuse(option: str) -> None:
    """Refuses what a picture of parts cannot have."""
    if option in OURS:
        raise Failure(f"{option} is given: what a part is, is decided here", "leave it out; see --parts")
    if option in NOT_CUT:
        raise Failure(f"{option} is given: such a render cannot be cut", "leave it out, or run `tyndall render`")


def info(scene: Path, options: list[str]) -> dict[str, Any]:
    """What the scene itself says, with the parameters that `options` give it."""
    places = [i for i, word in enumerate(options) if word == "-D"]
    parameters = [word for i in places for word in options[i : i + 2]]
    told: dict[str, Any] = json.loads(program.call([str(program.binary()), "info", str(scene), "--json", *parameters]).stdout)
    return told
