"""OpenEXR files as numpy arrays, by the package `OpenEXR`: nothing of Mitsuba's is needed."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from tyndall.failure import Failure

ROOT = "<root>"
"""Name of the layer whose channels have no layer in their names: the picture. Mitsuba's `Bitmap.split` calls it so too."""
ORDER = "RGBXYZA"
"""Of the channels of one layer; others follow by name."""
XYZ_OF_RGB = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])
"""Linear sRGB (ITU-R BT.709 primaries, white D65) to CIE XYZ."""
UINT32_MAX = 4294967295
MADE = "tyndall"
"""The attribute in which the program says how an image was made, as JSON."""

Layers = dict[str, dict[str, np.ndarray]]
"""Channels (height, width) by their names, by the layers' names."""


def read(path: str | Path) -> Layers:
    """All layers of a file. Whole numbers become the values from 0 to 1 that they stand for."""
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            planes = {name: scaled(channel.pixels) for name, channel in file.channels().items()}
    except (RuntimeError, ValueError, OSError) as error:
        raise Failure(f"{path}: no OpenEXR image can be read: {error}", "name an .exr file")
    found: Layers = {}
    for name in sorted(planes, key=rank):
        layer, _, channel = name.rpartition(".")
        found.setdefault(layer or ROOT, {})[channel] = planes[name]
    return found


def rank(name: str) -> tuple[int, str]:
    """Where a channel stands among those of its layer."""
    channel = name.rpartition(".")[2]
    return (ORDER.index(channel) if channel in tuple(ORDER) else len(ORDER), channel)


def scaled(pixels: np.ndarray) -> np.ndarray:
    """As float32."""
    whole = UINT32_MAX if pixels.dtype == np.uint32 else 1
    return (pixels / np.float64(whole)).astype(np.float32)


def stacked(channels: dict[str, np.ndarray]) -> np.ndarray:
    """One layer as an array: (height, width) of one channel, (height, width, channels) of several."""
    planes = list(channels.values())
    return planes[0] if len(planes) == 1 else np.stack(planes, axis=-1)


def colours(channels: dict[str, np.ndarray]) -> np.ndarray:
    """The picture as linear RGB, (height, width, 3) float64, of channels R G B, X Y Z or Y; alpha is left out."""
    for names in ("RGB", "XYZ", "YYY"):
        if set(names) <= channels.keys():
            planes = np.stack([channels[name] for name in names], axis=-1).astype(np.float64)
            return planes @ np.linalg.inv(XYZ_OF_RGB).T if names == "XYZ" else planes
    raise Failure(f"no picture among the channels {', '.join(channels) or '(none)'}", "name an image with R, G and B")


def read_image(path: str | Path) -> np.ndarray:
    """The picture of a file as linear RGB, (height, width, 3) float64, without the layers that may stand beside it."""
    return colours(read(path).get(ROOT, {}))


def batches(channels: Layers) -> np.ndarray | None:
    """The independent images of a file that holds some, (batches, height, width, 3)."""
    names = [f"batch.{k}" for k in range(len(channels)) if f"batch.{k}" in channels]
    return np.stack([colours(channels[name]) for name in names]) if names else None


def made(path: str | Path) -> dict[str, Any]:
    """How the image was made, as the program wrote it into the file; nothing of other programs' files."""
    with OpenEXR.File(str(path), header_only=True) as file:
        said = file.header().get(MADE)
    return json.loads(said) if isinstance(said, str) else {}


def write_image(path: str | Path, image: np.ndarray) -> None:
    """Writes (height, width, channels) or (height, width) as 32-bit floats, whole or not at all: Y, R G B or R G B A."""
    pixels = np.atleast_3d(np.asarray(image, dtype=np.float32))
    names = {1: "Y", 3: "RGB", 4: "RGBA"}.get(pixels.shape[2])
    if names is None or pixels.ndim != 3:
        raise Failure(f"an array of shape {np.shape(image)} is no image", "give (height, width) or (height, width, 1, 3 or 4)")
    write(path, {ROOT: {name: pixels[:, :, i] for i, name in enumerate(names)}})


def write(path: str | Path, channels: Layers, made: Mapping[str, Any] | None = None) -> None:
    """Writes layers of channels as 32-bit floats, with how they were made, whole or not at all."""
    header: dict[str, Any] = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    header |= {MADE: json.dumps(made)} if made else {}
    planes = {name if layer == ROOT else f"{layer}.{name}": plane for layer, inner in channels.items() for name, plane in inner.items()}
    with OpenEXR.File(header, {name: np.ascontiguousarray(plane, dtype=np.float32) for name, plane in planes.items()}) as file:
        whole(Path(path), file.write)


def whole(path: Path, write: Callable[[str], object]) -> None:
    """Writes a file whole or not at all, its folder made if need be."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_name(f"{path.stem}.partial{path.suffix}")
        write(str(partial))
        partial.replace(path)
    except (OSError, RuntimeError) as error:
        raise Failure(f"{path}: the file cannot be written: {error}", "name a file in a folder that you may write to") from None
