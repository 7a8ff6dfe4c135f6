"""Scenes in, pictures out: `tyndall render` from Python.

Whatever cannot be done is a `tyndall.Failure` that carries the program's own message and its remedy."""

import json
import re
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from tyndall import arguments, denoising, exr, program, watching
from tyndall.display import Display
from tyndall.failure import Failure, TyndallWarning
from tyndall.option_types import RenderOptions
from tyndall.picture import STANDARD, Picture
from tyndall.scene import AnyScene, as_scene, scene_file

ALL_STRATEGIES = "hit,next-event,join,lens"
"""Those of `bdpt`, for `strategies`: named, all of them run; otherwise a pilot chooses among them."""


@dataclass(frozen=True)
class Rendering:
    """An image and what the renderer says about its making."""

    picture: Picture
    """With its layers."""
    messages: list[str] = field(default_factory=list)
    """Warnings of the program."""
    was_interrupted: bool = False

    @property
    def image(self) -> np.ndarray:
        """Linear RGB, (height, width, 3), float64."""
        return np.asarray(self.picture)

    @property
    def layers(self) -> dict[str, np.ndarray]:
        """See `Picture.layers`."""
        return self.picture.layers

    @property
    def batches(self) -> np.ndarray | None:
        """See `Picture.batches`."""
        return self.picture.batches

    @property
    def report(self) -> dict[str, Any]:
        """All figures of `--report`."""
        return self.picture.report

    @property
    def render_seconds(self) -> float:
        return self.report["render_seconds"]

    @property
    def samples_per_pixel(self) -> float:
        return self.report["samples_per_pixel"]


def render(
    scene: AnyScene,
    *,
    parameters: Mapping[str, object] | None = None,
    features: bool = False,
    progress: bool | None = None,
    must_be_finite: bool = True,
    patience: float | None = None,
    **options: Unpack[RenderOptions],
) -> Picture:
    """Renders one image: an array that shows itself in notebooks, with `.layers`, `.variance`, `.metadata` and `.save`.

    The scene is a file (.json or .xml), or a dictionary as for `mitsuba.load_dict`. Every option of `tyndall render` is one
    here, with `_` for `-`: `spp=64`, `size=(640, 480)`, `time_limit=10`, `max_depth=8`, `strategies=["hit", "join"]`; True for a
    flag. `print(tyndall.options())` lists them; their types are in `tyndall.option_types.RenderOptions`. `parameters={"res": 256}` is `-D res=256`.

    `features` adds the layers that `Picture.denoised` looks at. `progress` shows a bar or none; without it, a bar in terminals
    and notebooks. Ctrl-C (in a notebook: interrupt the kernel) ends the render, and the image so far is what is returned. What the program warns of
    is a `TyndallWarning`. An image that holds NaN or infinite values is refused, unless `must_be_finite` is False; with
    `patience`, so is one that takes longer than so many seconds."""
    done = run(scene, parameters=parameters, features=features, progress=progress, must_be_finite=must_be_finite, patience=patience, **options)
    for message in done.messages:
        watching.warn(message, TyndallWarning)
    if done.was_interrupted:
        more = "; the same call with resume=True goes on" if options.get("sums") else ""
        watching.warn(f"interrupted after {done.samples_per_pixel:g} samples per pixel: the image so far is returned{more}", TyndallWarning)
    return done.picture


def run(
    scene: AnyScene,
    *,
    parameters: Mapping[str, object] | None = None,
    features: bool = False,
    progress: bool | None = False,
    must_be_finite: bool = True,
    patience: float | None = None,
    **given: Unpack[RenderOptions],
) -> Rendering:
    """What `render` does, with all that is said of it. It shows no progress unless asked to, and its warnings are
    `messages`."""
    settings = arguments.words(given)
    scene = as_scene(scene, parameters)
    with tempfile.TemporaryDirectory(prefix="tyndall-") as name:
        folder = Path(name)
        source = scene_file(denoising.with_features(scene) if features else scene, folder)
        own: dict[str, program.Option] = {"output": folder / "image.exr", "report": folder / "report.json", "progress": "json"}
        command = [str(program.binary()), "--quiet", "render", str(source), *program.flags(own), *settings, *program.definitions(scene.parameters)]
        outcome = watching.run(command, watching.shown(progress), patience)
        found = rendering(folder, outcome, command, given.get("view") or STANDARD.view)
    if must_be_finite:
        finite(found.image if found.batches is None else found.batches)
        sound(found)
    return found


def rendering(folder: Path, outcome: watching.Outcome, command: list[str], view: str) -> Rendering:
    """What was written, to be shown by that view; why nothing was, in words that name no file of a folder that is gone."""
    images, report = sorted(folder.glob("image*.exr")), folder / "report.json"
    said = lasting(outcome.messages, folder)
    if len(images) != 1 or not report.is_file():
        if outcome.was_interrupted:
            raise KeyboardInterrupt
        problem = program.failure(command, outcome.code, said)
        raise Failure(arguments.spelled(problem.problem), arguments.spelled(problem.remedy))
    told, channels = json.loads(report.read_text()), exr.read(images[0])
    figures = told | told["frames"][0] if "frames" in told else told
    made = json.loads(lasting(json.dumps(exr.made(images[0])), folder))
    said_of_it = {name: figure for name, figure in figures.items() if name not in ("image", "frames")}
    display = Display(view, figures.get("exposure", STANDARD.exposure))
    picture = Picture(exr.colours(channels[exr.ROOT]), channels, made, said_of_it, display=display)
    return Rendering(picture, warnings_in(said), outcome.was_interrupted)


def lasting(text: str, folder: Path) -> str:
    """Text in which what was written to a folder that is gone is called by what it was: the scene, or a place in it."""
    text = text.replace(str(folder / "scene.json"), "the scene")
    text = re.sub(rf"{re.escape(str(folder))}/(?!image\.)([\w.-]+)\.(?:exr|vol|png)", r"$.\1", text)
    return text.replace(f"{folder}/", "")


def warnings_in(said: str) -> list[str]:
    """The warnings among the lines on standard error; what follows one, indented, belongs to it."""
    found = re.findall(r"^warning: (.*(?:\n +.*)*)", said, re.MULTILINE)
    return [arguments.spelled(text) for text in found]


def render_batches(scene: AnyScene, batches: int, **options: Any) -> np.ndarray:
    """Independent images of one scene, (batches, height, width, 3) float64 in linear RGB, by one process: their seeds are
    `seed`, `seed + 1` and so on. The options are those of `render`."""
    found = run(scene, batches=batches, **options).batches
    assert found is not None
    return found


def sound(found: Rendering) -> None:
    """Refuses an image that the program left contributions out of: NaN, infinities, and what panicked."""
    if found.report["faults"]:
        raise Failure("\n".join(found.messages), "report them with the scene, or give must_be_finite=False")


def finite(image: np.ndarray) -> None:
    """Refuses an image, or several, in which anything is not a number."""
    if not np.isfinite(image).all():
        y, x, channel = np.argwhere(~np.isfinite(image))[0][-3:]
        raise Failure(f"not a finite number at pixel ({x}, {y}), channel {channel}", "report it with the scene, or give must_be_finite=False")
