"""OpenEXR files as numpy arrays, by the package `OpenEXR`: nothing of Mitsuba's is needed."""

from pathlib import Path

import numpy as np
import OpenEXR

from validation.failure import Failure

ROOT = "<root>"
"""Name of the layer whose channels have no layer in their names: the picture. Mitsuba's `Bitmap.split` calls it so too."""
ORDER = "RGBXYZA"
"""Of the channels of one layer; others follow by name."""
XYZ_OF_RGB = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])
"""Linear sRGB (ITU-R BT.709 primaries, white D65) to CIE XYZ."""
UINT32_MAX = 4294967295

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


def write_image(path: str | Path, image: np.ndarray) -> None:
    """Writes (height, width, channels) or (height, width) as 32-bit floats, whole or not at all: Y, R G B or R G B A."""
    pixels = np.atleast_3d(np.asarray(image, dtype=np.float32))
    names = {1: "Y", 3: "RGB", 4: "RGBA"}.get(pixels.shape[2])
    if names is None or pixels.ndim != 3:
        raise Failure(f"an array of shape {np.shape(image)} is no image", "give (height, width) or (height, width, 1, 3 or 4)")
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    planes = {name: np.ascontiguousarray(pixels[:, :, i]) for i, name in enumerate(names)}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    partial = path.with_name(f"{path.stem}.partial.exr")
    with OpenEXR.File(header, planes) as file:
        file.write(str(partial))
    partial.replace(path)
