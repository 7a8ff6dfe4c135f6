"""Model by model against Mitsuba: the variance of a pixel sample and its time, by path tracing in small scenes that have a model
each. What a whole scene's efficiency averages away shows here."""

import argparse
import math
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import tyndall
from tyndall import exr
from tyndall.failure import Failure
from tyndall.scene import Scene
from validation import mitsuba
from validation.contender import VARIANTS
from validation.made_by import made_by_command
from validation.places import CROSSCHECK, OUTPUT

Object = dict[str, Any]
FOLDER = OUTPUT / "models"
SIZE = (32, 24)
ROUNDS = 4
"""Turns that both take; of their times the median counts."""
ASSETS = CROSSCHECK / "assets"


def rgb(*value: float) -> Object:
    """A colour."""
    return {"type": "rgb", "value": list(value)}


def at(origin: list[float], target: list[float]) -> list[Object]:
    """A place and where to look from it."""
    return [{"type": "lookat", "origin": origin, "target": target, "up": [0, 1, 0]}]


MATT: Object = {"type": "diffuse", "reflectance": rgb(0.7, 0.5, 0.3)}
PLASTIC: Object = {"type": "plastic", "diffuse_reflectance": rgb(0.5, 0.2, 0.1)}
BSDFS: dict[str, Object] = {
    "diffuse": MATT,
    "dielectric": {"type": "dielectric"},
    "thindielectric": {"type": "thindielectric"},
    "conductor": {"type": "conductor", "material": "Au"},
    "plastic": PLASTIC,
    **{f"{kind} {facets} {alpha}": {"type": kind, "distribution": facets, "alpha": alpha, **more}
       for kind, more in (("roughdielectric", {}), ("roughconductor", {"material": "Cu"}), ("roughplastic", {}))
       for facets in ("beckmann", "ggx") for alpha in (0.05, 0.2, 0.5)},
    "roughconductor anisotropic": {"type": "roughconductor", "material": "Ag", "alpha_u": 0.05, "alpha_v": 0.4},
    "twosided": {"type": "twosided", "bsdf": PLASTIC},
    "mask": {"type": "mask", "opacity": 0.5, "bsdf": MATT},
    "blendbsdf": {"type": "blendbsdf", "weight": 0.4, "first": MATT, "second": {"type": "roughconductor", "alpha": 0.2}},
}  # fmt: skip
TEXTURES: dict[str, Object] = {
    "checkerboard": {"type": "checkerboard", "to_uv": [{"type": "scale", "value": [8, 8, 1]}]},
    "bitmap": {"type": "bitmap", "filename": str(ASSETS / "tiles.png")},
}
PHASES: dict[str, Object] = {
    "isotropic": {"type": "isotropic"},
    "rayleigh": {"type": "rayleigh"},
    **{f"hg {g}": {"type": "hg", "g": g} for g in (-0.5, 0.5, 0.9)},
    "tabphase": {"type": "tabphase", "values": "0.3, 1.0, 0.4, 0.2, 2.0"},
    "blendphase": {"type": "blendphase", "weight": 0.4, "first": {"type": "isotropic"}, "second": {"type": "hg", "g": 0.8}},
}
UNIT = [{"type": "translate", "value": [-0.5, -0.5, -0.5]}, {"type": "scale", "value": 2}]
GRIDS: dict[str, Object] = {
    f"gridvolume {name} x {scale}": {"type": "heterogeneous", "albedo": 0.95, "scale": scale,
                                     "sigma_t": {"type": "gridvolume", "filename": str(ASSETS / f"{name}.vol"), "to_world": UNIT}}
    for name in ("smoke", "puffs") for scale in (0.5, 10)
}  # fmt: skip
LAMP: Object = {"type": "sphere", "center": [2, 3, 2], "radius": 0.4, "emitter": {"type": "area", "radiance": 30.0}}
ABOVE = at([1, 3, 1], [0, 0, 0])
LIGHTS: dict[str, Object] = {
    "sky": {"type": "constant", "radiance": rgb(0.8, 1.0, 1.2)},
    "map": {"type": "envmap", "filename": str(FOLDER / "sun.exr")},
    "lamp": LAMP,
}
EMITTERS: dict[str, Object] = {
    "area rectangle": {"type": "rectangle", "to_world": at([1, 3, 1], [0, 0, 0]), "emitter": {"type": "area", "radiance": 5.0}},
    "point": {"type": "point", "position": [1, 3, 2], "intensity": 20.0},
    "spot": {"type": "spot", "to_world": ABOVE, "intensity": 20.0, "cutoff_angle": 25},
    "projector": {"type": "projector", "to_world": ABOVE, "irradiance": {"type": "bitmap", "filename": str(ASSETS / "slide.hdr"), "raw": True}},
    "directional": {"type": "directional", "direction": [-1, -3, -1], "irradiance": 3.0},
}


def ball(bsdf: Object, **more: Any) -> Object:
    """A sphere around the origin."""
    return {"type": "sphere", "bsdf": bsdf, **more}


def fog(phase: Object) -> Object:
    """A ball of it."""
    return ball({"type": "null"}, interior={"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.95, "phase": phase})


def cloud(medium: Object) -> Object:
    """A cube of it."""
    return {"type": "cube", "bsdf": {"type": "null"}, "interior": medium}


def things() -> Iterator[tuple[str, Object]]:
    """Every model as a thing to be lit."""
    yield from ((f"bsdf {name}", ball(model)) for name, model in BSDFS.items())
    yield from ((f"texture {name}", ball({"type": "diffuse", "reflectance": model})) for name, model in TEXTURES.items())
    yield from ((f"phase {name}", fog(model)) for name, model in PHASES.items())
    yield from ((f"medium {name}", cloud(model)) for name, model in GRIDS.items())


def scenes() -> Iterator[Scene]:
    """Every model under every light, and every other emitter over a matt ball and over fog."""
    for name, thing in things():
        yield from (scene(f"{name}, {light}", thing, emitter) for light, emitter in LIGHTS.items())
    for name, emitter in EMITTERS.items():
        yield scene(f"emitter {name}, matt ball", ball(MATT), emitter)
        yield scene(f"emitter {name}, fog", fog({"type": "isotropic"}), emitter)


def scene(name: str, thing: Object, emitter: Object) -> Scene:
    """A thing over matt ground under a light."""
    film = {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "pixel_format": "rgb", "rfilter": {"type": "box"}}
    flat = [{"type": "scale", "value": 4}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}, {"type": "translate", "value": [0, -1.01, 0]}]
    tree = {
        "type": "scene",
        "integrator": {"type": "bdpt"},
        "sensor": {"type": "perspective", "fov": 36, "to_world": at([0, 1, 5], [0, 0, 0]), "film": film},
        "ground": {"type": "rectangle", "to_world": flat, "bsdf": {"type": "diffuse", "reflectance": 0.5}},
        "thing": thing,
        "light": emitter,
    }
    return Scene(tree, name)


def sun() -> None:
    """Writes the map: a sky that is brighter towards the horizon, dark ground, and a sun of some degrees."""
    y, x = np.mgrid[0:64, 0:128]
    height = np.cos(np.pi * y / 63)
    sky = np.where(height > 0, 1.2 - 0.8 * height, 0.2)[..., None] * [0.6, 0.8, 1.0]
    sky[(abs(y - 18) < 2) & (abs(x - 40) < 2)] = [400, 380, 300]
    FOLDER.mkdir(parents=True, exist_ok=True)
    exr.write_image(FOLDER / "sun.exr", sky)


@dataclass(frozen=True)
class Sampled:
    """What independent images of a scene say of one sample a pixel."""

    variance: float
    """Of a value, averaged over pixels and channels."""
    seconds: float
    """Those of the pilot are among ours, those of compiling not among Mitsuba's."""
    mean: float
    error: float
    """Of the mean."""

    @staticmethod
    def of(images: np.ndarray, seconds: list[float], spp: int) -> "Sampled":
        """Images (image, height, width, 3), and the seconds that each took."""
        means = images.mean(axis=(1, 2, 3))
        each = statistics.median(seconds) / (spp * SIZE[0] * SIZE[1])
        return Sampled(float(images.var(axis=0, ddof=1).mean() * spp), each, float(means.mean()), float(means.std(ddof=1) / math.sqrt(len(means))))


@dataclass(frozen=True)
class Row:
    """A model in one light."""

    name: str
    theirs: Sampled
    ours: Sampled

    @property
    def variance(self) -> float:
        """Mitsuba's over ours."""
        return self.theirs.variance / self.ours.variance

    @property
    def times(self) -> float:
        """Mitsuba's seconds over ours."""
        return self.theirs.seconds / self.ours.seconds

    @property
    def apart(self) -> float:
        """The means, in standard errors."""
        return (self.ours.mean - self.theirs.mean) / math.hypot(self.ours.error, self.theirs.error)

    def __str__(self) -> str:
        product = self.variance * self.times
        return (f"| {self.name} | {self.theirs.variance:.3g} | {self.ours.variance:.3g} | {self.variance:.2f} | {1e9 * self.theirs.seconds:.0f} |"
                f" {1e9 * self.ours.seconds:.0f} | {self.times:.2f} | {product:.2f} | {self.apart:+.1f} |")  # fmt: skip


HEADER = "| model | Mitsuba's variance | ours | ratio | Mitsuba's ns | ours | ratio | product | means, se |\n" + "|---" * 9 + "|"


def measured(case: Scene, options: argparse.Namespace) -> Row:
    """Both take turns."""
    import drjit as dr  # only importable inside the environment

    print(case.name, file=sys.stderr, flush=True)
    dr.set_thread_count(options.threads)
    loaded = mitsuba.load(case, options.variant)
    mitsuba.image(loaded, options.spp, 0)  # compiles
    theirs, ours, taken, own = [], [], [], []
    for first in range(0, ROUNDS * options.batches, options.batches):
        start = time.perf_counter()
        theirs += [mitsuba.image(loaded, options.spp, 1 + first + i) for i in range(options.batches)]
        taken.append((time.perf_counter() - start) / options.batches)
        found = tyndall.run(case, integrator="pt", batches=options.batches, spp=options.spp, seed=first, threads=options.threads)
        ours += list(found.batches if found.batches is not None else [])
        own.append(found.render_seconds / options.batches)
    return Row(case.name, Sampled.of(np.stack(theirs), taken, options.spp), Sampled.of(np.stack(ours), own, options.spp))


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--only", default="", help="only models whose name contains this, such as 'bsdf rough' or ', map'")
    command.add_argument("--batches", type=int, default=4, help=f"images in each of {ROUNDS} turns (default %(default)s)")
    command.add_argument("--spp", type=int, default=64, help="samples a pixel in each (default %(default)s)")
    command.add_argument("--threads", type=int, default=2, help="of both alike (default %(default)s)")
    command.add_argument("--variant", choices=VARIANTS, default=VARIANTS[0], help="Mitsuba's; of scalar_rgb times say little (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Prints a row a model, where Mitsuba is furthest ahead first."""
    sun()
    chosen = [case for case in scenes() if options.only in case.name]
    if not chosen:
        raise Failure(f"--only {options.only}: no model has this in its name", "name another part, such as bsdf, phase or map")
    rows = [measured(case, options) for case in chosen]
    rows.sort(key=lambda row: row.variance * row.times)
    print(HEADER, *rows, sep="\n")
    products, variances = ([value(row) for row in rows] for value in (lambda row: row.variance * row.times, lambda row: row.variance))
    print(f"\nmedian of {len(rows)}: variance {statistics.median(variances):.2f}, variance x time {statistics.median(products):.2f} (Mitsuba's over ours)")
    print(f"made by: {made_by_command()}")
    return True
