"""What picture is to be rendered: a scene and options of `tyndall render`, which stay as they are given."""

import json
from dataclasses import dataclass
from pathlib import Path

from validation import tyndall
from validation.cluster import parts
from validation.cluster.parts import Range
from validation.failure import Failure

OURS = {"--samples", "--sums", "--checkpoint", "--resume"}
"""Options that say what a part is."""
NOT_CUT = {"--time-limit", "--error", "--confidence", "--batches", "--frames", "--fps", "--preview", "--json", "--report"}
"""Options of renders that are no sum of samples A to B, or that every part would write to one file."""


@dataclass(frozen=True)
class Job:
    """A picture."""

    scene: Path
    output: Path
    options: list[str]
    """All else on the command line of `tyndall render`."""
    spp: int
    folder: Path
    """Where parts come; shared by all machines."""

    def part(self, samples: Range) -> list[str]:
        """The command line of a part, without the file of its sums."""
        return [*self.render(), "--samples", parts.spelled(samples)]

    def whole(self, sums: Path) -> list[str]:
        """The command line of the picture, which adds whatever `sums` lacks."""
        return [*self.render(), "--spp", str(self.spp), "--sums", str(sums), "--resume", "-o", str(self.output)]

    def render(self) -> list[str]:
        """What all parts share."""
        return [str(tyndall.binary().absolute()), "--quiet", "render", str(self.scene), *self.options]


def job(scene: str, output: Path, options: list[str], spp: int | None, folder: Path | None) -> Job:
    """A picture as it stands on the command line."""
    path, output = Path(scene).absolute(), output.absolute()
    if not path.is_file():
        raise Failure(f"{scene}: no such scene", "give the scene first, then the options")
    for word in options:
        refuse(word.partition("=")[0])
    parent = (folder or output.parent).absolute()
    spp = own_spp(path, options) if spp is None else spp
    return Job(path, output, options, spp, parent / f"{output.name}.parts")


def refuse(option: str) -> None:
    """Refuses what a picture of parts cannot have."""
    if option in OURS:
        raise Failure(f"{option} is given: what a part is, is decided here", "leave it out; see --parts")
    if option in NOT_CUT:
        raise Failure(f"{option} is given: such a render cannot be cut by samples", "leave it out, or run `tyndall render`")


def own_spp(scene: Path, options: list[str]) -> int:
    """The scene's own number of samples per pixel."""
    places = [i for i, word in enumerate(options) if word == "-D"]
    given = [word for i in places for word in options[i : i + 2]]
    told = tyndall.call([str(tyndall.binary()), "info", str(scene), "--json", *given]).stdout
    return int(json.loads(told)["samples_per_pixel"])
