"""What `compare` found as one HTML page that holds its pictures and needs no network."""

import base64
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

import tyndall
from tyndall import display
from tyndall.failure import Failure
from tyndall.judging import Verdict
from tyndall.scene import Scene
from validation import picture
from validation.compare import RETRY, Effort
from validation.files import made_by_command, write_text

TEMPLATES = Path(__file__).parent / "templates"
SHARPEST = 4.0
"""|z| of the map's full colours."""


@dataclass(frozen=True)
class Section:
    """One method's part of the page."""

    method: str
    verdict: Verdict
    """With its images."""
    pictures: list[tuple[str, str]]
    """Titles and addresses."""
    flip: float


@dataclass(frozen=True)
class Page:
    """Everything on the page; text as it is, the template escapes it."""

    scene: str
    command: str
    effort: str
    sections: list[Section]
    failures: list[tuple[str, str]]
    """Methods that cannot render the scene, and why."""


def page(scene: Scene, effort: Effort, found: Mapping[str, Verdict | Failure]) -> Page:
    """The page of one scene's comparisons, by method."""
    told = f"{effort.batches} independent images on both sides, {effort.spp} samples per pixel in each (where they disagree, further trials of {RETRY} times as many)."
    return Page(
        scene=scene.name,
        command=made_by_command(),
        effort=told,
        sections=[section(method, verdict) for method, verdict in found.items() if isinstance(verdict, Verdict)],
        failures=[(method, str(reason)) for method, reason in found.items() if isinstance(reason, Failure)],
    )


def section(method: str, verdict: Verdict) -> Section:
    """Draws one method's pictures."""
    if verdict.reference is None or verdict.found is None or verdict.map is None:
        raise ValueError("a page is made of verdicts that have their images")
    white = picture.white_of(verdict.reference)
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        map = Path(folder, "map.png")
        mean = tyndall.diff(verdict.found, verdict.reference, map=map, map_of="flip")["flip"]
        differences = map.read_bytes()
    shown = [
        ("Mitsuba", display.png(picture.displayed(verdict.reference, white))),
        ("Tyndall", display.png(picture.displayed(verdict.found, white))),
        ("z, Tyndall less Mitsuba", display.png(picture.diverging(verdict.map, SHARPEST))),
        ("FLIP", differences),
    ]
    return Section(method, verdict, [(title, "data:image/png;base64," + base64.b64encode(file).decode("ascii")) for title, file in shown], mean)


def write(page: Page, path: Path) -> None:
    """Writes the page, whole or not at all."""
    write_text(path, html(page))


def html(page: Page) -> str:
    """The page's text; whatever stands in names and messages is shown, not obeyed."""
    environment = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined)
    return environment.get_template("comparison.html").render(page=page, sharpest=SHARPEST)
