"""Tyndall as a renderer: its command line, images in linear RGB, (height, width, 3)."""

import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation import mitsuba
from validation.failure import Failure
from validation.places import TARGET
from validation.scene import Scene, changed


@dataclass(frozen=True)
class Rendering:
    """An image and what the renderer says about its making."""

    image: np.ndarray
    render_seconds: float
    samples_per_pixel: float
    report: dict


def binary() -> Path:
    """The program: $TYNDALL_BINARY, else the release build."""
    path = Path(os.environ.get("TYNDALL_BINARY", TARGET / "release" / "tyndall"))
    if not path.is_file():
        raise Failure(f"{path}: no such program", "cargo build --release, or set TYNDALL_BINARY")
    return path


def render(scene: Scene, **options) -> np.ndarray:
    """One image; the options are those of `run`."""
    return run(scene, **options).image


def run(
    scene: Scene,
    integrator: str | None = None,
    tracker: str | None = None,
    spp: int | None = None,
    seed: int = 0,
    threads: int | None = None,
    size: tuple[int, int] | None = None,
    time_limit: float | None = None,
    more: tuple[str, ...] = (),
) -> Rendering:
    """One image and its report. `more` are further arguments, as on the command line."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        output, report = Path(folder, "image.exr"), Path(folder, "report.json")
        options = {
            "-o": output,
            "--report": report,
            "--seed": seed,
            "--integrator": integrator,
            "--tracker": tracker,
            "--spp": spp,
            "--threads": threads,
            "--size": size and f"{size[0]}x{size[1]}",
            "--time-limit": time_limit,
        }
        arguments = [str(part) for name, value in options.items() if value is not None for part in (name, value)]
        arguments += [part for name, value in scene.parameters.items() for part in ("-D", f"{name}={value}")]
        call([str(binary()), "render", str(scene_file(scene, Path(folder))), *arguments, *more])
        told = json.loads(report.read_text())
        return Rendering(finite(mitsuba.read_exr(output)), told["render_seconds"], told["samples_per_pixel"], told)


def scene_file(scene: Scene, folder: Path) -> Path:
    """The file of a scene; a dictionary is written into `folder` first."""
    if isinstance(scene.source, Path):
        return scene.source
    path = folder / f"{scene.name}.json"
    path.write_text(json.dumps(changed(scene.source, lambda o: absolute(o, scene.folder))))
    return path


def absolute(o: dict, folder: Path) -> dict:
    """The object with the whole path of the file it names."""
    return {**o, "filename": str(folder / o["filename"])} if "filename" in o else o


def call(command: list[str]) -> None:
    """Runs the program; what it says on stderr is shown only when it fails."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip()[-4000:]
        raise Failure(f"{' '.join(command)}\n  exit code {done.returncode}: {said}", "run the command by hand")


def finite(image: np.ndarray) -> np.ndarray:
    """The image, refused if anything in it is not a number."""
    if not np.isfinite(image).all():
        y, x, channel = np.argwhere(~np.isfinite(image))[0]
        raise Failure(f"not a finite number at pixel ({x}, {y}), channel {channel}", "mend the renderer")
    return image
