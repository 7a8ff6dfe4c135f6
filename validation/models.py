"""Small scenes with one model each. They show what the efficiency of a whole scene averages away."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tyndall import exr
from tyndall.scene import Scene
from validation.closed_forms.case import film, rgb
from validation.places import CROSSCHECK, OUTPUT

Object = dict[str, Any]
FOLDER = OUTPUT / "models-scenes"
SIZE = (32, 24)
ASSETS = CROSSCHECK / "assets"


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


def cases() -> Iterator[Scene]:
    """Every model under every light, and every other emitter over a matt ball and over fog."""
    for name, thing in things():
        yield from (scene(f"{name}, {light}", thing, emitter) for light, emitter in LIGHTS.items())
    for name, emitter in EMITTERS.items():
        yield scene(f"emitter {name}, matt ball", ball(MATT), emitter)
        yield scene(f"emitter {name}, fog", fog({"type": "isotropic"}), emitter)


def scene(name: str, thing: Object, emitter: Object) -> Scene:
    """A thing over matt ground under a light."""
    flat = [{"type": "scale", "value": 4}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}, {"type": "translate", "value": [0, -1.01, 0]}]
    tree = {
        "type": "scene",
        "integrator": {"type": "bdpt"},
        "sensor": {"type": "perspective", "fov": 36, "to_world": at([0, 1, 5], [0, 0, 0]), "film": film(*SIZE)},
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


def scenes() -> list[Path]:
    """The files of all."""
    sun()
    files = {FOLDER / f"{case.name}.json": case.tree() for case in cases()}
    for file, tree in files.items():
        file.write_text(json.dumps(tree))
    return list(files)
