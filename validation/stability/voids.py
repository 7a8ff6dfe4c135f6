"""Empty media, and media with one lit voxel."""

from typing import Any

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms import varying
from validation.closed_forms.case import NULL, SIZE, diffuse, orthographic, scene
from validation.stability.case import ALL, TRACKERS, Case, lamp
from validation.stability.lamps import FLOOR_VIEW, PLACE, lit_floor, lit_image

EMPTY = "empty medium"
VOXEL = "medium with one lit voxel"
GRID = ("pt", *(f"pt:{tracker}" for tracker in TRACKERS), "bdpt", "lt", "lt:null_collision")


def cases() -> list[Case]:
    """All of them."""
    return [*empty(), *voxels()]


def empty() -> list[Case]:
    """A floor lit by a point light through nothing: media without extinction of every kind."""
    point = {"type": "point", "position": PLACE.tolist(), "intensity": 1.0}
    over = [{"type": "scale", "value": 8}, {"type": "translate", "value": [-4, -4, -4]}]
    zero = varying.medium(varying.grid(np.zeros((4, 4, 4)), over), 0.9)
    kinds = {
        "homogeneous": ({"type": "homogeneous", "sigma_t": 0.0, "albedo": 0.9}, ALL),
        "grid of zeros": (zero, GRID),
        "constvolume 0": (varying.medium({"type": "constvolume", "value": 0.0, "to_world": over}, 0.9), ALL),
        "exponential of value 0": (varying.medium({"type": "exponential", "scale_height": 1.0, "value": 0.0}, 0.9), ALL),
    }
    return [
        Case(EMPTY, f"floor lit by a point through a {name}", lit_floor(f"empty {name}", point, FLOOR_VIEW, air=air), lit_image("sphere"), chosen, "inverse square")
        for name, (air, chosen) in kinds.items()
    ]


# One voxel

VOXELS = 8
LIT = (5, 2, 6)
"""z, y, x."""


def voxels() -> list[Case]:
    """A grid, all of it empty but for one voxel, which absorbs or glows, under parallel rays along z."""
    methods = ("pt", *(f"pt:{tracker}" for tracker in TRACKERS), "bdpt", "bdpt:null_collision", "lt", "lt:null_collision")
    found = [Case(VOXEL, "one voxel absorbs, before a lamp", behind(), image(float(np.exp(-STRENGTH)), 1), GRID, "exp(-tau)")]
    for name, source, lit, truth in (("without matter", alone(), GAIN / VOXELS, "gain x length"), ("in an absorber", within(), dimmed(), "one integral")):
        found.append(Case(VOXEL, f"one voxel shines {name}", source, image(lit, 0), methods, truth))
    return found


STRENGTH = 1.2
"""Optical depth of the voxel."""
GAIN = 3.0
"""Radiance gained per metre."""
AIR = 2.0
"""Extinction around the voxel."""


def one(value: float) -> dict:
    """The grid over the unit cube."""
    samples = np.zeros((VOXELS, VOXELS, VOXELS))
    samples[LIT] = value
    return varying.grid(samples, [], filter_type="nearest")


def image(lit: float, others: float) -> np.ndarray:
    """The quarter of the picture that shows the voxel, and the rest."""
    picture = np.full((SIZE, SIZE, 1), float(others))
    picture[SIZE // 2 :, SIZE // 2 :] = lit
    return picture


def dimmed() -> float:
    """What the voxel gains, less what is absorbed before the camera."""
    over = (VOXELS - 1 - LIT[0]) / VOXELS
    return GAIN / AIR * float(np.exp(-AIR * over) - np.exp(-AIR * (over + 1 / VOXELS)))


def block(name: str, interior: dict, **more: Any) -> Scene:
    """The unit cube along z: two by two rows of voxels, that which is lit below at the right."""
    x, y = LIT[2] / VOXELS, (LIT[1] + 1) / VOXELS
    sensor = orthographic((x, y, 3), (x, y, 0), 1 / VOXELS)
    box = [{"type": "translate", "value": [1, 1, 1]}, {"type": "scale", "value": 0.5}]
    cube = {"type": "cube", "to_world": box, "bsdf": NULL, "interior": interior}
    return scene(f"voxel {name}", sensor=sensor, cube=cube, **more)


def behind() -> Scene:
    """The voxel before a lamp."""
    place = [{"type": "scale", "value": 1.5}, {"type": "translate", "value": [0.5, 0.5, -1]}]
    light = {"type": "rectangle", "to_world": place, "bsdf": diffuse(0), "emitter": lamp(1)}
    return block("absorbs", varying.medium(one(STRENGTH * VOXELS), 0), lamp=light)


def alone() -> Scene:
    """No matter: the extinction is a grid of zeros."""
    nothing = varying.grid(np.zeros((VOXELS, VOXELS, VOXELS)), [], filter_type="nearest")
    return block("shines", {**varying.medium(nothing, 0), "emission": one(GAIN)})


def within() -> Scene:
    """In an even absorber."""
    even = varying.grid(np.ones((VOXELS, VOXELS, VOXELS)), [], filter_type="nearest")
    return block("shines in an absorber", {**varying.medium(even, 0, scale=AIR), "emission": one(GAIN)})
