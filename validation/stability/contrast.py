"""Extinction contrast: 1e-3 : 1 : 1e3 between channels, 1e6 and 1e12 between neighbouring voxels."""

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms import varying
from validation.closed_forms.case import BLACK, NULL, SIZE, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.case import ALL, EYE, TRACKERS, Case, ball, fog, lamp, moved, named, oven, parallel, with_object
from validation.stability.thickness import AWAY

CHANNELS = "extinction 1e-3 : 1 : 1e3 between channels"
VOXELS = "extinction 1e6 and 1e12 between neighbouring voxels"
EXTREME = 1e12
RATIOS = np.array([1e-3, 1.0, 1e3])
GRID = ("pt", "pt:exact", "pt:null_collision", "pt:residual_ratio", "bdpt")


def cases() -> list[Case]:
    """All of them."""
    return [*chromatic_slabs(), chromatic_oven(), chromatic_lamp(), chromatic_glow(), *voxels()]


def chromatic_slabs() -> list[Case]:
    """A slab that is thin, of depth 2 and opaque."""
    found = []
    totals = np.array([Slab(0.9, b, 0).totals() for b in np.minimum(2 * RATIOS, 100)])
    totals[totals < DARK] = 0
    for total, truth, blocker in zip(("UR1", "UT1"), totals.T, (-1.5, 1.5)):
        flat = wider(lit_slab(Slab(0.9, 2, 0), total, blocker))
        source = moved(with_object(flat, "slab", interior=fog(tuple(2 * RATIOS), 0.9)), AWAY)
        found.append(Case(CHANNELS, f"slab {total}", named(source, f"chromatic {total}"), truth, EYE, "adding-doubling"))
    return found


DARK = 1e-20
"""Transmittances below this are black."""


def wider(flat: Scene) -> Scene:
    """The scene with a blocker beyond whose rim next to no light comes in: one channel is to be black."""
    to_world = [{"type": "scale", "value": [1e3, 1, 1e3]}]
    return with_object(flat, "blocker", to_world=[*flat.dictionary()["blocker"]["to_world"], *to_world])


def chromatic_oven() -> Case:
    """A white ball in an oven."""
    source = oven("chromatic oven", ball=ball(fog(tuple(RATIOS), 1)))
    return Case(CHANNELS, "white ball in an oven", source, 1, ALL, "furnace")


def chromatic_lamp() -> Case:
    """A lamp behind an absorber so thick in one channel that nothing of it is left in single precision."""
    cube = {"type": "cube", "bsdf": NULL, "interior": fog(tuple(RATIOS / 2), 0)}
    disk = {"type": "disk", "to_world": [{"type": "translate", "value": [0, 0, -1.5]}], "bsdf": BLACK, "emitter": lamp(1)}
    source = scene("chromatic absorber", sensor=parallel(0.4), cube=cube, lamp=disk)
    return Case(CHANNELS, "lamp behind an absorber", source, np.exp(-RATIOS), ALL, "exp(-b)")


def chromatic_glow() -> Case:
    """A cube that glows."""
    cube = {"type": "cube", "bsdf": NULL, "interior": {**fog(tuple(RATIOS / 2), 0), "radiance": 1.0}}
    return Case(CHANNELS, "glowing cube", scene("chromatic glow", sensor=parallel(0.9), cube=cube), -np.expm1(-RATIOS), EYE, "1 - exp(-b)")


def voxels() -> list[Case]:
    """The stiff grids of the closed forms, and one in an oven for light tracing."""
    furnace = varying.furnace(10, varying.CONTRAST)
    random = varying.uneven((SIZE, SIZE, SIZE), varying.CONTRAST)
    rods, seen = varying.block("uneven", random), varying.image_of(random)
    extreme = varying.uneven((SIZE, SIZE, SIZE), EXTREME)
    found = [
        Case(VOXELS, "white ball under the sky", furnace, 1, (*GRID, "pt:march"), "furnace"),
        Case(VOXELS, "absorbing rows", rods, seen, (*GRID, "pt:march"), "exp(-tau)"),
        Case(VOXELS, "white ball under the sky, 1e12", varying.furnace(10, EXTREME), 1, GRID, "furnace"),
        Case(VOXELS, "absorbing rows, 1e12", varying.block("extreme", extreme), varying.image_of(extreme), GRID, "exp(-tau)"),
    ]
    layers = varying.grid(varying.uneven((1, 16, 1), varying.CONTRAST), varying.STRETCH, filter_type="nearest")
    for total, truth, blocker in zip(("UR1", "UT1"), varying.SLAB.totals(), (-1.5, 1.5)):
        source = varying.varying_slab(varying.SLAB, f"stiff {total}", layers, blocker)
        found.append(Case(VOXELS, f"slab of layers, {total}", source, truth, GRID, "adding-doubling"))
    to_world = [{"type": "translate", "value": [-0.5, -0.5, -0.5]}, {"type": "scale", "value": 2.0}]
    uneven = varying.grid(varying.uneven((4, 5, 6), varying.CONTRAST), to_world, filter_type="nearest")
    heated = oven("uneven oven", ball=ball(varying.medium(uneven, 1, scale=2)))
    trackers = (f"{integrator}:{tracker}" for integrator in ("lt", "bdpt") for tracker in TRACKERS if (integrator, tracker) != ("lt", "march"))
    found.append(Case(VOXELS, "white ball in an oven", heated, 1, tuple(trackers), "furnace"))
    return found
