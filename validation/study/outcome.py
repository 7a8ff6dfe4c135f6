"""What a study found, as it stands in `study.json`; the words are those of `src/study/outcome.rs`, which tells more."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from validation.failure import Failure
from validation.files import write_text

FILE = "study.json"


@dataclass(frozen=True)
class Interval:
    """A mean over seeds and the ends of its confidence interval."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class Reference:
    """The image that stands for the truth."""

    image: str
    """Where it lies, beside `study.json`, as all images here."""
    how: str
    own_relmse: float | None
    """None if nobody knows."""


@dataclass(frozen=True)
class Point:
    """What one budget gave, over all seeds."""

    samples: int
    """Per pixel."""
    seconds: Interval
    """Of rendering, loading and compiling left out."""
    mse: Interval
    relmse: Interval
    trimmed_relmse: Interval
    mape: Interval
    smape: Interval
    difference: Interval
    """Mean of the image over that of the reference, less 1."""
    image: str
    """Of the first seed."""


@dataclass(frozen=True)
class Contender:
    """One way of rendering a scene, at growing budgets."""

    name: str
    load_seconds: float | None
    points: list[Point]
    slope: Interval | None
    """Of log relMSE over log seconds; none from fewer than three points."""
    efficiency: Interval
    """1 / (relMSE x seconds) at the last budget [1/s]."""
    ratio: Interval | None
    """Its efficiency over that of the scene's first contender, seeds paired; none for that one."""
    variance: str
    """An image: of each value in one render at the last budget."""
    notes: list[str]
    """What the reader should know: signs of bias, an error that is the reference's own, images that hold NaN."""


@dataclass(frozen=True)
class SceneOutcome:
    """What was found for one scene."""

    name: str
    width: int
    height: int
    reference: Reference
    contenders: list[Contender]
    notes: list[str]
    """What the reader should know: who was left out and why, seeds that are missing, a reference to mistrust."""


@dataclass(frozen=True)
class Outcome:
    """A whole study."""

    made_by: str
    command: str
    machine: str
    """Processor and threads that all contenders had."""
    confidence: float
    scenes: list[SceneOutcome]


def write(outcome: Outcome, folder: Path) -> Path:
    """Writes `study.json`, whole or not at all."""
    path = folder / FILE
    write_text(path, json.dumps(without_nan(asdict(outcome)), indent=1, allow_nan=False) + "\n")
    return path


def without_nan(value: Any) -> Any:
    """What JSON can hold: what is no finite number is `null`."""
    if isinstance(value, dict):
        return {name: without_nan(one) for name, one in value.items()}
    if isinstance(value, list):
        return [without_nan(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def read(folder: Path) -> Outcome:
    """Reads a study's `study.json`, whoever wrote it; what is `null` where a number should be is NaN."""
    path = folder / FILE
    if not path.is_file():
        raise Failure(f"{folder}: no {FILE} in it", "name the folder of a study that `convergence` or `tyndall study` made")
    try:
        told = json.loads(path.read_text())
        return Outcome(**{**told, "scenes": [scene_of(scene) for scene in told["scenes"]]})
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise Failure(f"{path}: not what a study has: {error!r}", "make the study again, with this version")


def scene_of(told: dict[str, Any]) -> SceneOutcome:
    """One scene's entry."""
    contenders = [contender_of(one) for one in told["contenders"]]
    return SceneOutcome(**{"notes": [], **told, "reference": Reference(**told["reference"]), "contenders": contenders})


def contender_of(told: dict[str, Any]) -> Contender:
    """One contender's entry."""
    values: dict[str, Any] = {"ratio": None, "notes": [], **told, "points": [point_of(point) for point in told["points"]]}
    for name in ("slope", "efficiency", "ratio"):
        values[name] = values[name] and interval_of(values[name])
    return Contender(**values)


def point_of(told: dict[str, Any]) -> Point:
    """One budget's entry."""
    values: dict[str, Any] = {name: interval_of(value) if isinstance(value, dict) else value for name, value in told.items()}
    return Point(**values)


def interval_of(told: dict[str, float | None]) -> Interval:
    """Three numbers."""
    return Interval(**{name: math.nan if value is None else float(value) for name, value in told.items()})
