"""Scenes as both renderers read them: a file (JSON or Mitsuba XML) or a dictionary."""

import hashlib
import json
import re
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tyndall import program
from tyndall.failure import Failure
from tyndall.spelling import spelled

VOLUMES = ".vdb", ".nvdb", ".vol"
"""Endings of volume files, which the program renders in a scene of its own."""

Change = Callable[[dict[str, Any]], dict[str, Any]]
"""What is done to an object of a scene."""


@dataclass(frozen=True)
class Scene:
    """A scene and how it is to be looked at."""

    source: Path | dict
    name: str
    parameters: dict[str, str] = field(default_factory=dict)
    """XML's $parameters."""
    base: Path | None = None
    """Where file names in a dictionary start."""

    @property
    def is_xml(self) -> bool:
        return isinstance(self.source, Path) and self.source.suffix == ".xml"

    @property
    def folder(self) -> Path:
        """Where the file names in the scene start."""
        return self.source.resolve().parent if isinstance(self.source, Path) else self.base or Path.cwd()

    def tree(self) -> dict[str, Any]:
        """The dictionary that the scene is; of scenes that are no files."""
        if isinstance(self.source, Path):
            raise Failure(f"{self.source}: a dictionary is wanted here, not a file", "read the file first")
        return self.source

    def dictionary(self) -> dict:
        """The scene as a tree, parameters filled in; only of scenes in JSON, and of volume files."""
        if isinstance(self.source, Path) and self.source.suffix.lower() in VOLUMES:
            around = program.call([str(program.binary()), "--quiet", "new", str(self.source)]).stdout
            return changed(filled(json.loads(around), self.parameters), lambda o: absolute(o, Path.cwd()))
        return filled(self.source if isinstance(self.source, dict) else json.loads(self.source.read_text()), self.parameters)

    def key(self) -> str:
        """Changes whenever the scene, or a file beside it, does."""
        digest = hashlib.sha256(repr(sorted(self.parameters.items())).encode())
        if isinstance(self.source, dict):
            digest.update(json.dumps(self.source).encode())
        else:
            digest.update(self.source.read_bytes())
        for path in self.beside():
            digest.update(path.read_bytes())
        return digest.hexdigest()[:20]

    def beside(self) -> list[Path]:
        """The files that the scene may name: assets of which it holds the names and, beside an XML file in a folder of its own, all
        there are."""
        if self.is_xml and len(list(self.folder.glob("*.json"))) == 0:
            return sorted(path for path in self.folder.glob("**/*") if path.is_file())
        text = json.dumps(self.source) if isinstance(self.source, dict) else self.source.read_text()
        return sorted(path for path in self.folder.glob("assets/*") if path.is_file() and path.name in text)


def open_scene(path: str | Path, parameters: dict[str, str] | None = None) -> Scene:
    """A scene from a file that must exist."""
    path = Path(path)
    is_volume = path.suffix.lower() in VOLUMES
    if not path.is_file() and not (is_volume and re.search("[#%]", path.name)):
        raise Failure(f"{path}: no such scene", "name a .json or .xml file, or a volume, relative to the current folder")
    if path.suffix not in (".json", ".xml") and not is_volume:
        raise Failure(f"{path}: neither .json nor .xml, nor a volume file", "name a scene, or a .vdb, .nvdb or .vol file")
    return Scene(path, path.stem, parameters or {})


def derived(scene: Scene, change: Change) -> Scene:
    """The scene with `change` applied to each of its objects; of scenes in JSON."""
    if scene.is_xml:
        raise Failure(f"{scene.name}: an XML scene cannot be changed", "name a JSON scene")
    return Scene(changed(scene.dictionary(), change), scene.name, {}, scene.folder)


def filled(tree: dict[str, Any], parameters: dict[str, str]) -> dict:
    """A JSON scene with its $parameters replaced by `parameters` or else by the defaults it gives."""
    values: dict[str, Any] = {}
    for name, default in tree.get("$defaults", {}).items():
        given = parameters.get(name)
        typed = given if given is None or isinstance(default, str) else json.loads(given)
        values[name] = fill(default, values) if given is None else typed
    return {key: fill(value, values) for key, value in tree.items() if key != "$defaults"}


def fill(value: Any, values: dict[str, Any]) -> Any:
    """A part of a JSON scene with `values` in place of their $names."""
    if isinstance(value, dict):
        return {key: fill(inner, values) for key, inner in value.items() if key != "$tag"}
    if isinstance(value, list):
        return [fill(inner, values) for inner in value]
    if not isinstance(value, str) or "$" not in value:
        return value
    if value[1:] in values and value[0] == "$":
        return values[value[1:]]
    names = "|".join(re.escape(name) for name in sorted(values, key=len, reverse=True)) or "(?!)"
    text = lambda inner: str(inner).lower() if isinstance(inner, bool) else str(inner)
    replace = lambda found: "$" if found[1] is None else text(values[found[1]])
    return re.sub(rf"\\\$|\$({names})", replace, value)


def changed(tree: Any, change: Change) -> Any:
    """A copy of a JSON tree in which `change` has been applied to every object (a dictionary with a type)."""
    if isinstance(tree, dict):
        copy = {key: changed(value, change) for key, value in tree.items()}
        return change(copy) if "type" in copy else copy
    if isinstance(tree, list):
        return [changed(value, change) for value in tree]
    return tree


AnyScene = Scene | str | Path | Mapping[str, Any]
"""A scene, the file of one (.json or .xml), a volume file (.vdb, .nvdb, .vol), or a dictionary as for `mitsuba.load_dict`."""


def as_scene(scene: AnyScene, parameters: Mapping[str, object] | None = None) -> Scene:
    """Whatever stands for a scene, as one."""
    given = {name: program.text(value) for name, value in (parameters or {}).items()}
    if isinstance(scene, Scene):
        return replace(scene, parameters={**scene.parameters, **given})
    if isinstance(scene, Mapping):
        return Scene(dict(scene), "scene", given)
    if not isinstance(scene, (str, Path)):
        raise Failure(f"a {type(scene).__name__} is no scene", "give a file's name or the dictionary of mitsuba.load_dict")
    return open_scene(Path(scene).expanduser(), given)


def load(scene: AnyScene, parameters: Mapping[str, object] | None = None) -> dict[str, Any]:
    """The scene as a dictionary, its parameters filled in and its file names whole, to be changed and rendered."""
    scene = as_scene(scene, parameters)
    if isinstance(scene.source, dict):
        return changed(scene.dictionary(), lambda o: absolute(o, scene.folder))
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        target = Path(folder, "scene.json")
        program.call([str(program.binary()), "convert", *program.definitions(scene.parameters), str(scene.source.resolve()), str(target)])
        tree: dict[str, Any] = json.loads(target.read_text())
        return changed(tree, lambda o: absolute(o, target.parent))


INTEGRATORS = "bdpt", "pt", "lt", "path", "volpath", "volpathmis", "ptracer", "gather", "first_pass", "fog", "single_scattering", "non_scattering", "aov", "moment", "direct", "depth"
"""Those of both renderers, as far as scenes may have them."""


def integrator(tree: Mapping[str, Any]) -> str | None:
    """The name of the integrator in a scene, if it has one."""
    return next((name for name, child in tree.items() if isinstance(child, Mapping) and child.get("type") in INTEGRATORS), None)


def scene_file(scene: Scene, folder: Path) -> Path:
    """The file of a scene; a dictionary is written into `folder` first."""
    if isinstance(scene.source, Path):
        return scene.source
    path = folder / "scene.json"
    tree = changed(spelled(scene.source, folder), lambda o: beside(o, folder) or absolute(o, scene.folder))
    try:
        path.write_text(json.dumps(tree, allow_nan=False))
    except ValueError:
        raise Failure("the scene's dictionary holds a number that is not finite", "give finite numbers") from None
    return path


def beside(o: dict[str, Any], folder: Path) -> dict[str, Any] | None:
    """The object with the bare name of the file it names, if that is in `folder`: the same scene has the same text then, and a
    render of it goes on."""
    path = Path(o.get("filename", ""))
    return {**o, "filename": path.name} if path.parent == folder else None


def absolute(o: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The object with the whole path of the file it names."""
    return {**o, "filename": str((folder / o["filename"]).resolve())} if "filename" in o else o
