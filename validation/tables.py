"""Tables of README and manual that are taken from reports, between `<!-- from NAME -->` and `<!-- end -->`."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tyndall.statistics import Ratio
from validation.files import write_text
from validation.places import REPORTS, ROOT

PAGES = (ROOT / "README.md",)
BLOCK = re.compile(r"(?<=<!-- from )(\w+)( -->\n)(.*?)(?=<!-- end -->)", re.DOTALL)
SHOWN = {
    "lampbox_up": "fog, lit by way of the ceiling",
    "lampbox_down": "fog, lit directly",
    "plume": "a plume of smoke under a sky and a sun",
    "cloud": "a white cloud under a sky and a sun",
    "fog_room": "a room in fog",
    "pool": "murky water under a sky",
}
"""Scenes of the README, and what they are."""


def efficiency() -> str:
    """The ratios of six scenes, and the mean of all."""
    rows = {row["scene"]: row for row in json.loads((REPORTS / "efficiency.json").read_text())}
    ratios = {name: Ratio(**row["theirs"][1]) for name, row in rows.items() if row["theirs"]}
    below = [f"`{name}` ({ratio.mean:.2g})" for name, ratio in ratios.items() if ratio.mean < 1]
    return "\n".join([
        "| scene | ratio |", "|---|---|",
        *(f"| `{name}`: {what} | {ratios[name]} |" for name, what in SHOWN.items()), "",
        f"The geometric mean of [{len(ratios)} scenes](validation/reports/efficiency.md) is {Ratio.geometric(list(ratios.values()))}. "
        f"{'No scene is' if not below else ', '.join(below) + (' is' if len(below) == 1 else ' are')} below 1.", "",
    ])  # fmt: skip


MAKERS: dict[str, Callable[[], str]] = {"efficiency": efficiency}


def renewed(text: str) -> str:
    """A page with its tables as the reports have them."""
    return BLOCK.sub(lambda found: found[1] + found[2] + MAKERS[found[1]](), text)


def renew() -> None:
    """Writes the pages whose tables differ."""
    for page in PAGES:
        if (text := page.read_text()) != (new := renewed(text)):
            write_text(page, new)


def stale() -> list[Path]:
    """The pages whose tables differ from the reports."""
    return [page for page in PAGES if page.read_text() != renewed(page.read_text())]
