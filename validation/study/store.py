"""What a study has finished, kept in `runs/`, so that an interrupted one goes on: each file is whole or not there."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation import exr
from validation.failure import Failure
from validation.files import write_text
from validation.study.measures import Measures
from validation.study.outcome import without_nan


@dataclass(frozen=True)
class Run:
    """One render of one contender: what is left of it."""

    samples: int
    seconds: float
    measures: Measures


@dataclass(frozen=True)
class Store:
    """The kept work of one scene."""

    folder: Path

    def plan(self) -> dict[str, Any] | None:
        """What was planned, if anything was."""
        return self.read(self.folder / "plan.json")

    def keep_plan(self, plan: dict[str, Any]) -> None:
        """Keeps the plan, in a folder of which nothing belongs to another one."""
        self.refuse_strangers()
        self.write(self.folder / "plan.json", plan)

    def refuse_strangers(self) -> None:
        """What lies here without a plan was made by somebody else. It may be dear: nothing is ever deleted."""
        strangers = [path for path in self.folder.glob("*") if path.suffix != ".partial"] if self.folder.is_dir() else []
        if strangers and not (self.folder / "plan.json").is_file():
            raise Failure(f"{self.folder} holds {strangers[0].name}, and no plan", "name another --output, or delete that folder")

    def run(self, contender: str, budget: int, seed: int) -> Run | None:
        """A finished render."""
        told = self.read(self.path(contender, budget, seed).with_suffix(".json"))
        if not told:
            return None
        measured = {name: math.nan if value is None else value for name, value in told["measures"].items()}
        return Run(told["samples"], told["seconds"], Measures(**measured))

    def keep_run(self, contender: str, budget: int, seed: int, run: Run, image: np.ndarray | None) -> None:
        """Keeps a render, and its image where it is wanted later."""
        path = self.path(contender, budget, seed)
        if image is not None:
            exr.write_image(path, image)
        told = {"samples": run.samples, "seconds": run.seconds, "measures": vars(run.measures)}
        self.write(path.with_suffix(".json"), told)

    def image(self, contender: str, budget: int, seed: int) -> np.ndarray:
        """The image of a finished render."""
        return exr.read_image(self.path(contender, budget, seed))

    def path(self, contender: str, budget: int, seed: int) -> Path:
        """Where a render's image lies; its numbers lie beside."""
        return self.folder / contender / f"{budget}-{seed}.exr"

    @staticmethod
    def read(path: Path) -> dict[str, Any] | None:
        """A file's content, None where there is no file."""
        try:
            return json.loads(path.read_text()) if path.is_file() else None
        except ValueError:
            raise Failure(f"{path}: not what this program wrote", "delete it")

    @staticmethod
    def write(path: Path, content: dict[str, Any]) -> None:
        """Writes so that no half file is ever taken for a whole one."""
        write_text(path, json.dumps(without_nan(content), allow_nan=False))
