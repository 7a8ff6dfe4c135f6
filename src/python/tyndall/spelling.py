"""Scenes as Python users write them for `mitsuba.load_dict`, in our JSON spelling.

Both have the same words; what differs is values. Here numbers and points of numpy and Dr.Jit become JSON's, transforms
(`mi.ScalarTransform4f`, or a 4 x 4 array) become their matrices, `mi.Color3f` becomes an `rgb`, and arrays that stand
for a file (a bitmap's `data` or `bitmap`, a gridvolume's `data` or `grid`) become that file. Nothing is imported of
Mitsuba: its objects are known by what they can do."""

import itertools
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import exr
from tyndall.failure import Failure
from tyndall.volume_file import vol

PICTURES = {"bitmap": ("data", "bitmap"), "envmap": ("data", "bitmap")}
"""Plugins that show an image file, and the parameters that may hold the image itself."""
VOXELS = {"gridvolume": ("data", "grid")}
"""The same of volumes."""


def spelled(tree: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The scene in our spelling; files for arrays go to `folder`."""
    return Speller(folder).object(tree, "$")


class Speller:
    """Spells one scene; knows where its files go: without a folder, arrays that stand for a file stay arrays of numpy."""

    def __init__(self, folder: Path | None):
        self.folder = folder
        self.paths: set[Path] = set()

    def object(self, tree: Mapping[str, Any], place: str) -> dict[str, Any]:
        """A dictionary."""
        whole = dict(tree)
        held = {key: self.held(whole.pop(key), key, kind, f"{place}.{key}") for key, kind in files(whole).items()}
        spelled = {str(key): self.value(inner, f"{place}.{key}") for key, inner in whole.items()}
        return {**spelled, **dict(held.values())}

    def held(self, value: Any, key: str, kind: str, place: str) -> tuple[str, Any]:
        """What stands for a file, as that file or else as an array."""
        if self.folder is None:
            return key, np.array(value)
        end, write = WRITERS[kind]
        return "filename", write(self.path(self.folder, place, end), value, place)

    def path(self, folder: Path, place: str, end: str) -> Path:
        """A new file, named after the place of what it holds: so do messages about it."""
        name = re.sub(r"[^\w.-]", "_", place.removeprefix("$."))
        paths = (folder / f"{name}{number or ''}{end}" for number in itertools.count())
        path = next(path for path in paths if path not in self.paths)
        self.paths.add(path)
        return path

    def value(self, value: Any, place: str) -> Any:
        """Anything that a dictionary can hold."""
        if isinstance(value, (bool, int, float, str)):
            return value
        if isinstance(value, Path):
            return str(value)
        if isinstance(value, Mapping):
            return self.object(value, place)
        if isinstance(value, (list, tuple)):
            return [self.value(inner, f"{place}[{i}]") for i, inner in enumerate(value)]
        if "Transform" in type(value).__name__:  # Dr.Jit's points claim to have a matrix too
            return matrix(numbers(value.matrix, place), place)
        if "Color" in type(value).__name__:  # a ScalarColor3f too, whose name depends on the variant that was set first
            return {"type": "rgb", "value": numbers(value, place).tolist()}
        return plain(numbers(value, place), place)


def files(tree: Mapping[str, Any]) -> dict[str, str]:
    """The parameters of an object that stand for a file, and what kind of one."""
    kind = str(tree.get("type"))
    found = {key: name for name, table in (("picture", PICTURES), ("voxels", VOXELS)) for key in table.get(kind, ())}
    return {key: name for key, name in found.items() if key in tree and not isinstance(tree[key], (str, Mapping))}


def numbers(value: Any, place: str) -> np.ndarray:
    """What numpy makes of numpy's and Dr.Jit's values, without axes of length 1."""
    try:
        found = np.squeeze(np.asarray(value))
    except (TypeError, ValueError, RuntimeError):
        found = np.asarray(None)
    if found.dtype.kind not in "biuf":
        problem = f"{place}: a {type(value).__name__} cannot be written to a scene file"
        raise Failure(problem, "give the dictionary that it is made of, not the object that was loaded from it")
    return found


def plain(found: np.ndarray, place: str) -> Any:
    """Numbers as JSON has them: one, lists of them, or the matrix of a transform."""
    if place.endswith((".to_world", ".to_uv")):
        return matrix(found, place)
    return (found.ravel() if found.shape == (4, 4) else found).tolist()


def matrix(found: np.ndarray, place: str) -> list[dict[str, Any]]:
    """A transform of one step."""
    if found.shape == (3, 3):  # of texture coordinates: what is added stands in the last column, as in 4 x 4
        whole = np.eye(4)
        whole[np.ix_((0, 1, 3), (0, 1, 3))] = found
        found = whole
    if found.shape != (4, 4):
        raise Failure(f"{place}: an array of shape {found.shape} is no transform", "give a 4 x 4 matrix")
    return [{"type": "matrix", "value": found.astype(float).ravel().tolist()}]


def write_picture(path: Path, value: Any, place: str) -> str:
    """An image of linear values, (height, width), or with 1, 3 or 4 channels; or a Mitsuba `Bitmap`; its file's name."""
    if is_written_by_itself(value):
        eight_bits = np.asarray(value).dtype == np.uint8  # sRGB then, which OpenEXR cannot say
        path = path.with_suffix(".png") if eight_bits else path
        value.write(str(path))
    else:
        exr.write_image(path, array(value, (2, 3), place, "(height, width, channels) of linear values"))
    return str(path)


def write_voxels(path: Path, value: Any, place: str) -> str:
    """Voxels, (z, y, x) or (z, y, x, channel), or a Mitsuba `VolumeGrid`; their file's name."""
    if is_written_by_itself(value):
        value.write(str(path))
    else:
        path.write_bytes(vol(array(value, (3, 4), place, "(z, y, x) or (z, y, x, channel)")))
    return str(path)


def is_written_by_itself(value: Any) -> bool:
    """True for Mitsuba's bitmaps and grids."""
    return hasattr(value, "write") and not isinstance(value, np.ndarray)


def array(value: Any, axes: tuple[int, int], place: str, expected: str) -> np.ndarray:
    """The values that stand for a file."""
    found = np.asarray(value)
    if found.ndim not in axes or found.size == 0 or found.dtype.kind not in "biuf":
        emptied = "; mi.load_dict empties the TensorXf that it reads: make the dictionary anew" if found.size == 0 else ""
        raise Failure(f"{place}: found an array of shape {found.shape}", f"give {expected}{emptied}")
    return found


WRITERS = {"picture": (".exr", write_picture), "voxels": (".vol", write_voxels)}
"""The files of each kind: their names' ends, and what writes them."""
