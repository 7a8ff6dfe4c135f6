"""Media that overlap: both are there, and their coefficients add."""

from typing import Any

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms import varying
from validation.closed_forms.case import BLACK, NULL, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.boundaries import layer
from validation.stability.case import ALL, EYE, Case, ball, fog, lamp, moved, oven, parallel
from validation.stability.thickness import AWAY

ROW = "media that overlap"
SLAB = Slab(0.9, 2, 0.75)
GRIDS = (*ALL, "pt:exact", "pt:null_collision", "pt:residual_ratio", "bdpt:residual_ratio")


def cases() -> list[Case]:
    """Slabs, absorbers, and what is white or in equilibrium."""
    slabs = [
        Case(ROW, f"slab of two that overlap, {total}", moved(sheets(total, blocker), AWAY), truth, EYE, "adding-doubling")
        for total, truth, blocker in zip(("UR1", "UT1"), SLAB.totals(), (-1.5, 1.5))
    ]
    white: dict[str, Any] = {"one": box((-0.7, 0.8), fog(1, 1)), "other": box((-0.4, 1.1), fog(3, 1, 0.7))}
    glowing: dict[str, Any] = {"one": box((-0.7, 0.8), {**fog(1, 0.5), "radiance": 1.0}), "other": box((-0.4, 1.1), {**fog(3, 0), "radiance": 1.0})}
    return [
        *slabs,
        absorbers(),
        Case(ROW, "two white cubes in an oven", oven("overlapping white cubes", **white), 1, ALL, "furnace"),
        Case(ROW, "two cubes in equilibrium", oven("overlapping cubes that glow", **glowing), 1, ALL, "furnace"),
        Case(ROW, "white smoke in white fog, in an oven", smoke(), 1, GRIDS, "furnace"),
    ]


def sheets(total: str, blocker: float) -> Scene:
    """The slab as two, of which the upper 0.7 of the height is one and the lower 0.7 the other. They differ, or they would be one
    medium, which is there once."""
    tree = lit_slab(SLAB, total, blocker).tree()
    part = {
        name: {"type": "cube", "to_world": layer(low, high), "bsdf": NULL, "interior": fog(sigma_t, SLAB.a, SLAB.g)}
        for name, low, high, sigma_t in (("upper", -0.7, 0.0, 1.6), ("lower", -1.0, -0.3, SLAB.b / 0.7 - 1.6))
    }
    return scene(f"overlapping slabs {total}", **{**varying.parts(tree), "slab": part["upper"], "lower": part["lower"]})


def box(z: tuple[float, float], interior: dict) -> dict:
    """A cube of half width 0.6, stretched along z."""
    low, high = z
    return {
        "type": "cube",
        "to_world": [{"type": "scale", "value": [0.6, 0.6, (high - low) / 2]}, {"type": "translate", "value": [0.1, 0, (high + low) / 2]}],
        "bsdf": NULL,
        "interior": interior,
    }


def absorbers() -> Case:
    """Two before a lamp."""
    parts: dict[str, Any] = {"near": box((-0.3, 1.3), fog(0.5, 0)), "far": box((-1.1, 0.6), fog(0.9, 0))}
    disk = {"type": "disk", "to_world": [{"type": "translate", "value": [0, 0, -1.5]}], "bsdf": BLACK, "emitter": lamp(1)}
    truth = float(np.exp(-0.5 * 1.6 - 0.9 * 1.7))
    return Case(ROW, "two absorbers before a lamp", scene("overlapping absorbers", sensor=parallel(0.4), lamp=disk, **parts), truth, ALL, "exp(-tau)")


def smoke() -> Scene:
    """Uneven voxels in a ball within a larger one of even fog, which the smoke does not name."""
    interior = varying.furnace(10, 1e3).tree()["ball"]["interior"]
    small = {"to_world": [{"type": "scale", "value": 0.9}]}
    return oven("smoke in fog", fog={**ball(fog(1, 1, 0.5)), "radius": 1.3}, smoke={**ball(interior), **small})
