"""The other commands of the program."""

import json
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import arguments, exr, program, watching
from tyndall.failure import Failure
from tyndall.scene import AnyScene, as_scene, scene_file

AnyImage = str | Path | np.ndarray
"""An array, (height, width, 3), or the file of an image."""


def info(scene: AnyScene, parameters: Mapping[str, object] | None = None, **more: Any) -> str:
    """What `tyndall info` says of a scene, or of an image how it was made; its options as in `render`."""
    settings = arguments.words(more, "info")
    is_image = isinstance(scene, (str, Path)) and Path(scene).suffix not in (".json", ".xml")
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        found = None if is_image else as_scene(scene, parameters)
        path = Path(str(scene)).expanduser() if found is None else scene_file(found, Path(folder))
        given = {} if found is None else found.parameters
        return call("info", [str(path), *settings, *program.definitions(given)], folder)


def diff(image: AnyImage, reference: AnyImage, **more: Any) -> dict[str, Any]:
    """How far an image is from a reference: MSE, relMSE, MAPE, SMAPE, FLIP and more, as `tyndall diff --json` measures them; its
    options as in `render`."""
    settings = arguments.words(more, "diff")
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        files = [image_file(given, Path(folder, f"{name}.exr")) for given, name in ((image, "image"), (reference, "reference"))]
        return json.loads(call("diff", [*files, "--json", *settings], folder, accepted=(0, 1)))


def image_file(image: AnyImage, path: Path) -> str:
    """The file of an image; an array is written to `path` first."""
    if isinstance(image, (str, Path)):
        return str(Path(image).expanduser())
    exr.write_image(path, image)
    return str(path)


def study(scenes: AnyScene | Sequence[AnyScene], output: str | Path, *, progress: bool | None = None, **more: Any) -> dict[str, Any]:
    """Error against run time of several contenders: `tyndall study`, whose page goes to the folder `output` as study.html,
    and whose numbers are returned. Its options as in `render`: `vary={"integrator": ["bdpt", "pt"]}`,
    `contender={"joins": "--strategies hit,join"}`; `print(tyndall.options("study"))` lists them. A study that was interrupted
    continues with the same call."""
    settings = arguments.words(more, "study")
    several: list[Any] = list(scenes) if isinstance(scenes, (list, tuple)) else [scenes]
    output = Path(output).expanduser()
    files = [study_file(scene, output / f"scene-{number}") for number, scene in enumerate(several)]
    given = program.definitions({name: value for scene in several for name, value in as_scene(scene).parameters.items()})
    command = [str(program.binary()), "--quiet", "study", *files, *program.flags({"output": output, "progress": "json"}), *settings, *given]
    outcome = watching.run(command, watching.shown(progress))
    if outcome.was_interrupted and outcome.code:
        raise KeyboardInterrupt
    if outcome.code:
        raise program.failure(command, outcome.code, outcome.messages)
    return json.loads((output / "study.json").read_text())


def study_file(scene: AnyScene, folder: Path) -> str:
    """The file of a scene; a dictionary is written into a folder of the study, where it is found again."""
    found = as_scene(scene)
    if not isinstance(found.source, Path):
        folder.mkdir(parents=True, exist_ok=True)
    return str(scene_file(found, folder))


def call(command: str, words: list[str], folder: str, accepted: tuple[int, ...] = (0,)) -> str:
    """What a command prints; nothing in it names a file of a folder that will be gone."""
    try:
        return program.call([str(program.binary()), command, *words], accepted=accepted).stdout.replace(f"{folder}/", "")
    except Failure as failure:
        place = failure.problem.replace(f"{folder}/scene.json", "the scene").replace(f"{folder}/", "")
        raise Failure(arguments.spelled(place, command), arguments.spelled(failure.remedy, command)) from None
