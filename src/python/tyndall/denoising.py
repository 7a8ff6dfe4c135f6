"""Open Image Denoise on pictures, with albedo and normals where a render made them. Its package is an extra:
`pip install tyndall[denoise]`."""

import warnings
from typing import Any

import numpy as np

from tyndall.failure import Failure, TyndallWarning
from tyndall.picture import Picture
from tyndall.scene import Scene, integrator, load

ALBEDO, NORMAL = "albedo", "normal"
"""Names of the layers."""


def with_features(scene: Scene) -> Scene:
    """The scene with layers for denoising: its integrator inside an `aov`."""
    tree = load(scene)
    own = integrator(tree) or "integrator"
    layers = {"type": "aov", "aovs": f"{ALBEDO}:first_albedo,{NORMAL}:first_normal", "image": tree.get(own, {"type": "volpath"})}
    return Scene({**tree, own: layers}, scene.name)


def library() -> Any:
    """The package of Open Image Denoise, an extra."""
    try:
        import pyoidn
    except ImportError:
        raise Failure("Open Image Denoise is not installed", "pip install pyoidn, or tyndall[denoise] in place of tyndall") from None
    return pyoidn


def denoised(picture: Picture) -> Picture:
    """The picture as Open Image Denoise sees it. A warning says where much noise will stay."""
    pyoidn = library()
    if picture.metadata.get("shares_samples"):
        warnings.warn("pixels of this picture share samples. The denoiser leaves much of such noise: render it with features=True, or with film_samples='apart'", TyndallWarning, stacklevel=3)  # fmt: skip
    layers = picture.layers
    features: dict[str, Any] = {name: single(layers[name]) for name in (ALBEDO, NORMAL) if name in layers}
    found = pyoidn.denoise(single(picture), hdr=True, **features)
    return Picture(found, {}, picture.metadata | {"denoised": "Open Image Denoise"}, picture.report, is_denoised=True, display=picture.display)


def single(image: np.ndarray) -> np.ndarray:
    """In single precision."""
    return np.ascontiguousarray(image, dtype=np.float32)

