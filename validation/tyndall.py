"""Tyndall from Python, around its command line: images are numpy arrays, linear RGB, (height, width, 3), float64.

Needs numpy and OpenEXR (see requirements.txt) and the program itself; nothing of Mitsuba. In a notebook:

    from validation import tyndall
    image = tyndall.render("scenes/foggy_room.json", spp=64, size=(320, 240))

Whatever cannot be done is a `validation.failure.Failure` that carries the program's own message."""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from validation import exr
from validation.failure import Failure
from validation.places import TARGET
from validation.scene import Scene, changed, open_scene
from validation.spelling import spelled

AnyScene = Scene | str | Path | Mapping[str, Any]
"""A scene, the file of one (.json or .xml), or a dictionary as for `mitsuba.load_dict`."""
Option = bool | float | str | Path | Sequence[object] | None
"""What an option of the command line may be; True is a flag, False and None leave it out."""


@dataclass(frozen=True)
class Rendering:
    """An image and what the renderer says about its making."""

    image: np.ndarray
    """Linear RGB, (height, width, 3), float64."""
    render_seconds: float
    samples_per_pixel: float
    report: dict[str, Any]
    """All figures of `--report`."""
    layers: dict[str, np.ndarray] = field(default_factory=dict)
    """Every layer of the file, float32: `<root>` is the picture with its alpha, others are those of an `aov` integrator;
    (height, width) of one channel, else (height, width, channels)."""
    batches: np.ndarray | None = None
    """With the option `batches`: each of the images that `image` is the mean of, (batches, height, width, 3), float64."""
    messages: str = ""
    """Warnings of the program."""


def binary() -> Path:
    """The program: $TYNDALL_BINARY, else the release build, else the one on the PATH."""
    built, found = TARGET / "release" / "tyndall", shutil.which("tyndall")
    path = Path(os.environ.get("TYNDALL_BINARY", found if found and not built.is_file() else built))
    if not path.is_file():
        raise Failure(f"{path}: no such program", "cargo build --release, or set TYNDALL_BINARY")
    return path


ALL_STRATEGIES = "hit,next-event,join,lens"
"""Those of `bdpt`, for `strategies`: named, all of them run; otherwise a pilot chooses among them."""


@overload
def render(scene: AnyScene, *, layers: Literal[False] = False, **options: Any) -> np.ndarray: ...
@overload
def render(scene: AnyScene, *, layers: Literal[True], **options: Any) -> dict[str, np.ndarray]: ...
def render(scene: AnyScene, *, layers: bool = False, **options: Any) -> np.ndarray | dict[str, np.ndarray]:
    """One image, (height, width, 3) float64 in linear RGB, or with `layers` all layers of its file, by name (see
    `Rendering.layers`). The options are those of `run`."""
    done = run(scene, **options)
    return done.layers if layers else done.image


def run(
    scene: AnyScene,
    *,
    integrator: str | None = None,
    spp: int | None = None,
    seed: int = 0,
    size: tuple[int, int] | None = None,
    threads: int | None = None,
    time_limit: float | str | None = None,
    max_depth: int | None = None,
    strategies: str | Iterable[str] | None = None,
    tracker: str | None = None,
    parameters: Mapping[str, object] | None = None,
    must_be_finite: bool = True,
    patience: float | None = None,
    **more: Option,
) -> Rendering:
    """One image and its report. `size` is (width, height), `time_limit` in seconds, `parameters` replace the $names of a
    scene. An image that holds NaN or infinite values is refused, unless `must_be_finite` is False; with
    `patience`, so is one that takes longer than so many seconds. Any other option of `tyndall render` may be given by its name: `heuristic="power"` is `--heuristic power`,
    `forced_interaction=True` is `--forced-interaction`."""
    scene = as_scene(scene, parameters)
    options: dict[str, Any] = {
        "integrator": integrator,
        "spp": spp,
        "seed": seed,
        "size": size and f"{size[0]}x{size[1]}",
        "threads": threads,
        "time_limit": time_limit,
        "max_depth": max_depth,
        "strategies": strategies,
        "tracker": tracker,
        **more,
    }
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        output, report = Path(folder, "image.exr"), Path(folder, "report.json")
        arguments = [*flags({"output": output, "report": report, **options}), *definitions(scene.parameters)]
        done = call([str(binary()), "--quiet", "render", str(scene_file(scene, Path(folder))), *arguments], patience)
        found = rendering(output, report, done.stderr)
    if must_be_finite:
        finite(found.image if found.batches is None else found.batches)
        sound(found)
    return found


def render_batches(scene: AnyScene, batches: int, **options: Any) -> np.ndarray:
    """Independent images of one scene, (batches, height, width, 3) float64 in linear RGB, by one process: their seeds are
    `seed`, `seed + 1` and so on. The options are those of `run`."""
    found = run(scene, batches=batches, **options).batches
    assert found is not None
    return found


def info(scene: AnyScene, parameters: Mapping[str, object] | None = None, **more: Option) -> str:
    """What `tyndall info` says of a scene; its options as in `run`."""
    scene = as_scene(scene, parameters)
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        path = scene_file(scene, Path(folder))
        return call([str(binary()), "info", str(path), *flags(more), *definitions(scene.parameters)]).stdout


def as_scene(scene: AnyScene, parameters: Mapping[str, object] | None = None) -> Scene:
    """Whatever stands for a scene, as one."""
    given = {name: text(value) for name, value in (parameters or {}).items()}
    if isinstance(scene, Scene):
        return replace(scene, parameters={**scene.parameters, **given})
    if isinstance(scene, Mapping):
        return Scene(dict(scene), "scene", given)
    if not isinstance(scene, (str, Path)):
        raise Failure(f"a {type(scene).__name__} is no scene", "give a file's name or the dictionary of mitsuba.load_dict")
    return open_scene(Path(scene).expanduser(), given)


def flags(options: Mapping[str, Option]) -> list[str]:
    """Options as on the command line."""
    return [part for name, value in options.items() for part in flag(f"--{name.replace('_', '-')}", value)]


def flag(name: str, value: Option) -> list[str]:
    """One option: True stands for its name alone, False and None for nothing."""
    if value is None or value is False:
        return []
    return [name] if value is True else [f"{name}={text(value)}"]


def text(value: object) -> str:
    """A value as the program reads it: several are separated by commas."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes)):
        return ",".join(map(text, value))
    return str(value)


def definitions(parameters: Mapping[str, str]) -> list[str]:
    """A scene's $parameters as on the command line."""
    return [part for name, value in parameters.items() for part in ("-D", f"{name}={value}")]


def rendering(output: Path, report: Path, messages: str) -> Rendering:
    """What was written."""
    if not (output.is_file() and report.is_file()):
        raise Failure("one image was expected and none was written", "leave out options that make many, such as frames")
    told, layers = json.loads(report.read_text()), exr.read(output)
    count = told.get("batches", 0)
    return Rendering(
        batches=np.stack([exr.colours(layers[f"batch.{k}"]) for k in range(count)]) if count else None,
        image=exr.colours(layers[exr.ROOT]),
        render_seconds=told["render_seconds"],
        samples_per_pixel=told["samples_per_pixel"],
        report=told,
        layers={name: exr.stacked(channels) for name, channels in layers.items()},
        messages=messages,
    )


def scene_file(scene: Scene, folder: Path) -> Path:
    """The file of a scene; a dictionary is written into `folder` first."""
    if isinstance(scene.source, Path):
        return scene.source
    path = folder / f"{scene.name}.json"
    tree = changed(spelled(scene.source, folder), lambda o: absolute(o, scene.folder))
    try:
        path.write_text(json.dumps(tree, allow_nan=False))
    except ValueError:
        raise Failure("the scene's dictionary holds a number that is not finite", "give finite numbers")
    return path


def absolute(o: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The object with the whole path of the file it names."""
    return {**o, "filename": str(folder / o["filename"])} if "filename" in o else o


def call(command: list[str], patience: float | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the program, for so many seconds at most; what it says on stderr is shown only when it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=patience)
    except subprocess.TimeoutExpired:
        raise Failure(f"{' '.join(command)}: not done after {patience:g} s", "see what does not end") from None
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip()[-4000:]
        raise Failure(f"{' '.join(command)}\n  exit code {done.returncode}: {said}", "run the command by hand")
    return done


def sound(found: Rendering) -> None:
    """Refuses an image that the program left contributions out of: NaN, infinities, and what panicked."""
    if found.report["faults"]:
        raise Failure(found.messages.strip(), "mend the renderer")


def finite(image: np.ndarray) -> None:
    """Refuses an image, or several, in which anything is not a number."""
    if not np.isfinite(image).all():
        y, x, channel = np.argwhere(~np.isfinite(image))[0][-3:]
        raise Failure(f"not a finite number at pixel ({x}, {y}), channel {channel}", "mend the renderer")
