"""What a render gives: an array that shows itself, with the layers, the variance and the making of the image."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import exr
from tyndall.display import Display
from tyndall.failure import Failure

STANDARD = Display()
"""How the program shows images unless it is told otherwise."""


class Picture(np.ndarray):
    """An image in linear RGB, (height, width, 3), float64: a numpy array. Notebooks show it as the program's PNG files
    show it, by the view and exposure that it was rendered with. What is computed from it is an array that shows itself too, without what is said of the image as it was
    rendered."""

    channels: exr.Layers
    """Every channel of the file by layers, float32; `layers` has them as arrays."""
    metadata: dict[str, Any]
    """How the image was made, as its file says: settings, samples per pixel, seconds, machine."""
    report: dict[str, Any]
    """The figures of `tyndall render --report`; of files that were read, none."""
    is_denoised: bool
    display: Display
    """How it is shown; what is computed from it is shown in the same way."""

    def __new__(
        cls,
        image: np.ndarray,
        channels: exr.Layers | None = None,
        metadata: Mapping[str, Any] | None = None,
        report: Mapping[str, Any] | None = None,
        is_denoised: bool = False,
        display: Display = STANDARD,
    ) -> "Picture":
        made = np.asarray(image, dtype=np.float64).view(cls)
        made.channels, made.metadata, made.report = channels or {}, dict(metadata or {}), dict(report or {})
        made.is_denoised, made.display = is_denoised, display
        return made

    def __array_finalize__(self, other: object) -> None:
        self.channels, self.metadata, self.report, self.is_denoised = {}, {}, {}, False
        self.display = getattr(other, "display", STANDARD)

    def __array_wrap__(self, array: np.ndarray, context: Any = None, return_scalar: bool = False) -> Any:
        """What is computed and no image is an ordinary array, or a number."""
        is_image = array.ndim == 3 and array.shape[2] == 3
        return Picture(array, display=self.display) if is_image else np.asarray(array)[()]

    def __reduce__(self) -> tuple[Any, ...]:
        return Picture, (np.asarray(self), self.channels, self.metadata, self.report, self.is_denoised, self.display)

    @property
    def layers(self) -> dict[str, np.ndarray]:
        """Every layer of the file, float32: `<root>` is the picture with its alpha, others are those of an `aov` integrator;
        (height, width) of one channel, else (height, width, channels)."""
        return {name: exr.stacked(planes) for name, planes in self.channels.items()}

    @property
    def batches(self) -> np.ndarray | None:
        """With the option `batches`: each of the images that this is the mean of, (batches, height, width, 3), float64."""
        return exr.batches(self.channels)

    @property
    def variance(self) -> np.ndarray:
        """Variances of the pixels, (height, width, 3): the square of how far off the image may be. It needs independent images
        (`batches=16`), or a `moment` integrator in the scene."""
        for name, layer in self.layers.items():
            if name.rpartition(".")[2] == "standard_error":
                return np.asarray(layer, dtype=np.float64) ** 2
            if name.rpartition(".")[2] == "variance":
                return np.asarray(layer, dtype=np.float64)
        raise Failure("this picture holds no variance", "render it with batches=16, or with a moment integrator in the scene")

    def denoised(self) -> "Picture":
        """The image as Open Image Denoise sees it, with the features of a render with `features=True` where there are any: it
        is no longer what was estimated, but biased, by an amount that nobody knows. It needs `pip install tyndall[denoise]`."""
        from tyndall import denoising  # its package is an extra

        return denoising.denoised(self)

    def shown(self, view: str | None = None, exposure: float | str | None = None) -> "Picture":
        """The same picture, shown otherwise by notebooks and in .png files: `view` and `exposure` are those of `tyndall render`,
        such as `image.shown("agx", "auto").save("fog.png")`."""
        display = Display(self.display.view if view is None else view, self.display.exposure if exposure is None else exposure)
        return Picture(np.asarray(self), self.channels, self.metadata, self.report, self.is_denoised, display)

    def save(self, path: str | Path) -> Path:
        """Writes the image: .exr with all layers and how it was made, or .png, as it is shown. A denoised image gets a name that
        says so, `fog.denoised.exr`. The path that was written."""
        path = Path(path).expanduser()
        if self.is_denoised and not path.stem.endswith(".denoised"):
            path = path.with_name(f"{path.stem}.denoised{path.suffix}")
        self.writer(path.suffix.lower())(path)
        return path

    def writer(self, suffix: str) -> Any:
        """What writes files of that name."""
        if self.ndim != 3 or self.shape[2] != 3:
            raise Failure(f"an array of shape {self.shape} is no picture", "give (height, width, 3)")
        if suffix not in (".exr", ".png"):
            raise Failure(f"no image can be written as {suffix or 'a file without an extension'}", "name an .exr or a .png file")
        return self.write_exr if suffix == ".exr" else self.write_png

    def write_exr(self, path: Path) -> None:
        """OpenEXR, 32-bit floats."""
        alpha = {name: plane for name, plane in self.channels.get(exr.ROOT, {}).items() if name == "A"}
        root = {name: np.asarray(self[..., i]) for i, name in enumerate("RGB")}
        exr.write(path, {**self.channels, exr.ROOT: {**root, **alpha}}, self.metadata)

    def write_png(self, path: Path) -> None:
        """8-bit sRGB."""
        exr.whole(path, lambda partial: Path(partial).write_bytes(self.display.png(self, self.metadata)))

    def _repr_png_(self) -> bytes | None:
        """What a notebook shows; None of arrays that are no picture."""
        if self.ndim != 3 or self.shape[2] != 3 or self.size == 0:
            return None
        return self.display.png(self, self.metadata)


def read(path: str | Path) -> Picture:
    """The picture of an .exr file, with all of its layers."""
    path = Path(path).expanduser()
    channels = exr.read(path)
    return Picture(exr.colours(channels.get(exr.ROOT, {})), channels, exr.made(path))
