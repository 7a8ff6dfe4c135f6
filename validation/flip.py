"""FLIP, the perceived difference of two images (Andersson et al. 2020), by `tyndall diff`."""

import json
import tempfile
from pathlib import Path

import numpy as np

from tyndall import exr, program


def compared(reference: np.ndarray, image: np.ndarray) -> tuple[bytes, float]:
    """The map of differences as a PNG file (black 0 to yellow 1), and its mean, of images in linear RGB."""
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder:
        ours, theirs, found, shown = (Path(folder, name) for name in ("image.exr", "reference.exr", "found.json", "map.png"))
        exr.write_image(ours, image)
        exr.write_image(theirs, reference)
        options = program.flags({"report": found, "map": shown, "map_of": "flip"})
        program.call([str(program.binary()), "diff", str(ours), str(theirs), *options])
        return shown.read_bytes(), float(json.loads(found.read_text())["flip"])
