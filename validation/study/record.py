"""The command `record`: what of a study is kept in the repository."""

import shlex
from dataclasses import replace
from pathlib import Path

from validation.failure import Failure
from validation.files import write_text
from validation.places import ROOT
from validation.study import curves, outcome, strips, summary
from validation.study.outcome import Outcome

TABLE, CURVES, STRIPS = "convergence.md", "convergence.svg", "convergence_strips.png"
FIGURES = f"""![relMSE against seconds, both axes logarithmic, a panel for each scene]({CURVES})

Means over seeds with their intervals; the dotted line is the reference's own error. Below, after about the same time:

![each scene's reference, and its images by bdpt and by the best of Mitsuba]({STRIPS})

"""


def run(folder: Path, output: Path) -> bool:
    """Writes a table, the curves and the images of the study in `folder` into `output`."""
    found = outcome.read(folder)
    if not any(contender.points for scene in found.scenes for contender in scene.contenders):
        raise Failure(f"{folder}: a study without results", "let it run to its end")
    output.mkdir(parents=True, exist_ok=True)
    curves.write(found, output / CURVES)
    strips.write(found, folder, output / STRIPS)
    write_text(output / TABLE, summary.markdown(told(found), FIGURES))
    print(f"{TABLE}, {CURVES} and {STRIPS} are in {output}")
    return True


def told(found: Outcome) -> Outcome:
    """The study with a command that makes sense elsewhere, and with notes that an older version did not write."""
    scenes = [
        replace(scene, contenders=[replace(c, notes=c.notes or summary.doubts(c.points[-1], scene.reference)) for c in scene.contenders if c.points])
        for scene in found.scenes
    ]
    return replace(found, command=portable(found.command), scenes=scenes)


OUTPUT = ("--output", "-o")


def portable(command: str) -> str:
    """A command without the folder that it wrote into, its files named from the root of the repository."""
    words = shlex.split(command)
    before = ["", *words]
    kept = [word for last, word in zip(before, words) if last not in OUTPUT and word not in OUTPUT and not word.startswith("--output=")]
    return shlex.join(word.removeprefix(f"{ROOT}/") for word in kept)
