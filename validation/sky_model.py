"""Writes the tables of the emitter `sunsky`: `python3 -m validation.sky_model src/emitter/sunsky/tables.bin`.

The sky's are those of Hosek and Wilkie's model in RGB, as the Mitsuba package ships them. The sun's are its irradiance as
Mitsuba has it, by turbidity and elevation. All numbers are f32, little-endian: nine coefficients and then the radiance of
[turbidity][albedo][control point][channel], then the irradiance of [turbidity][elevation][channel].
"""

import sys
from pathlib import Path

import mitsuba as mi
import numpy as np

TURBIDITIES, ELEVATIONS = 10, np.linspace(2, 89, 30)
"""Turbidities from 1, and elevations of the sun (degrees)."""
SOLID_ANGLE = 2 * np.pi * float(1 - np.cos(np.float32(np.radians(0.5 * 0.5358))))
"""Of the sun as it is seen from here (sr), rounded as in Mitsuba, which divides the irradiance by it."""


def sun(turbidity: float, degrees: float) -> np.ndarray:
    """Irradiance on a surface that faces the sun."""
    elevation = np.radians(degrees)
    direction = [np.cos(elevation), 0, np.sin(elevation)]
    emitter = mi.load_dict(
        {"type": "sunsky", "turbidity": turbidity, "sun_direction": direction, "sky_scale": 0.0}
    )
    point = mi.SurfaceInteraction3f()
    point.wi = mi.Vector3f([-x for x in direction])
    return np.array(emitter.eval(point)) * SOLID_ANGLE


def tensor(file: Path, name: str, count: int) -> np.ndarray:
    """The `count` numbers of a field of one of Mitsuba's files of tensors."""
    return np.frombuffer(file.read_bytes(), "<f8", count, mi.TensorFile(str(file))[name].offset)


def main() -> None:
    mi.set_variant("scalar_rgb")
    file = Path(mi.__file__).parent / "data/sunsky/sunsky_datasets.bin"
    per_channel = TURBIDITIES * 2 * 6
    sky = [tensor(file, "sky_params_rgb", per_channel * 27), tensor(file, "sky_rad_rgb", per_channel * 3)]
    suns = [sun(1.0 + turbidity, degrees) for turbidity in range(TURBIDITIES) for degrees in ELEVATIONS]
    numbers = np.concatenate([*(table.ravel() for table in sky), np.ravel(suns)])
    Path(sys.argv[1]).write_bytes(numbers.astype("<f4").tobytes())


if __name__ == "__main__":
    main()
