"""Camera on a boundary, coincident faces of touching media."""

from typing import Any

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms.case import BLACK, NULL, camera, diffuse, scene
from validation.closed_forms.slab import HALF_WIDTH, Slab, lit_slab
from validation.stability.case import ALL, EYE, Case, fog, lamp, moved, oven, parallel
from validation.stability.thickness import AWAY

CAMERA = "camera on a boundary"
TOUCHING = "coincident faces of touching media"
SLAB = Slab(0.9, 2, 0)
NEAR = 1e-6


def cases() -> list[Case]:
    """All of them."""
    return [*on_boundary(), *touching()]


# Camera on a boundary


def on_boundary() -> list[Case]:
    """Cameras exactly in the top face of a slab, looking in and out."""
    ur1, ut1 = SLAB.totals()
    return [
        Case(CAMERA, "in the slab, looking in, UR1", seen("in", -1.5, inside=True), ur1, EYE, "adding-doubling"),
        Case(CAMERA, "in the slab, looking in, UT1", seen("in lit", 1.5, inside=True), ut1, EYE, "adding-doubling"),
        Case(CAMERA, "no medium given, looking in, UR1", seen("above", -1.5, inside=False), ur1, EYE, "adding-doubling"),
        Case(CAMERA, "above the slab, looking out at the sky", seen("out", -1.5, inside=False, outwards=True), 1, EYE, "nothing in between"),
        glowing(),
    ]


def seen(name: str, blocker: float, inside: bool, outwards: bool = False) -> Scene:
    """The slab of the closed forms with its camera in its top face."""
    tree = lit_slab(SLAB, name, blocker).tree()
    view = camera((0, 0, 0), (0, 1 if outwards else -1, 0), 0.1, up=(0, 0, 1), near_clip=NEAR)
    medium = {"medium": {"type": "ref", "id": "matter"}} if inside else {}
    slab = {**tree["slab"], "interior": {"type": "ref", "id": "matter"}}
    # "matter" first: references look back
    return Scene({"type": "scene", "matter": tree["slab"]["interior"], **tree, "sensor": {**view, **medium}, "slab": slab}, f"camera {name}", {})


def glowing() -> Case:
    """The same of a cube that glows, under a wider view, for all integrators."""
    matter = {"type": "ref", "id": "matter"}
    view = camera((0, 0, 1), (0, 0, 0), 0.5, near_clip=NEAR, medium=matter)
    source = scene("camera on a glowing cube", matter={**fog(1, 0), "radiance": 1.0}, sensor=view, cube={"type": "cube", "bsdf": NULL, "interior": matter})
    return Case(CAMERA, "in a glowing cube, looking in", source, -np.expm1(-2.0), EYE, "1 - exp(-b)")


# Coincident faces


def touching() -> list[Case]:
    """Slabs cut in two, absorbers one on the other, white cubes side by side in an oven."""
    found = []
    for total, truth, blocker in zip(("UR1", "UT1"), SLAB.totals(), (-1.5, 1.5)):
        source = moved(halves(total, blocker), AWAY)
        found.append(Case(TOUCHING, f"slab cut in two, {total}", source, truth, EYE, "adding-doubling"))
    return [*found, absorbers(), pair(), on_lamp(), on_white(), in_glass(), cells()]


CUT = 0.3
"""Depth of the cut; no number that single precision holds exactly."""


def halves(total: str, blocker: float) -> Scene:
    """The slab as two cubes that share a face."""
    tree = lit_slab(SLAB, total, blocker).tree()
    matter = {"type": "ref", "id": "matter"}
    parts = {
        name: {"type": "cube", "to_world": layer(low, high), "bsdf": NULL, "interior": matter}
        for name, low, high in (("upper", -CUT, 0.0), ("lower", -1.0, -CUT))
    }
    rest = {k: v for k, v in tree.items() if k not in ("type", "slab")}
    return Scene({"type": "scene", "matter": tree["slab"]["interior"], **rest, **parts}, f"halves {total}", {})


def layer(low: float, high: float) -> list[dict]:
    """From the cube to a wide layer between two heights."""
    return [{"type": "scale", "value": [HALF_WIDTH, (high - low) / 2, HALF_WIDTH]}, {"type": "translate", "value": [0, (high + low) / 2, 0]}]


DEPTHS = (0.3, 1.1, 0.7)


def absorbers() -> Case:
    """Three absorbers, one on the other, before a lamp."""
    edges = np.array([-1, -0.37, 0.21, 1])
    parts: dict[str, Any] = {}
    for i, (low, high, depth) in enumerate(zip(edges, edges[1:], DEPTHS)):
        to_world = [{"type": "scale", "value": [1, 1, (high - low) / 2]}, {"type": "translate", "value": [0, 0, (high + low) / 2]}]
        parts[f"part{i}"] = {"type": "cube", "to_world": to_world, "bsdf": NULL, "interior": fog(depth / (high - low), 0)}
    disk = {"type": "disk", "to_world": [{"type": "translate", "value": [0, 0, -1.5]}], "bsdf": BLACK, "emitter": lamp(1)}
    source = scene("three absorbers", sensor=parallel(0.4), lamp=disk, **parts)
    return Case(TOUCHING, "three absorbers before a lamp", source, float(np.exp(-sum(DEPTHS))), ALL, "exp(-tau)")


def pair() -> Case:
    """Two white cubes of different media side by side."""
    parts: dict[str, Any] = {
        name: {"type": "cube", "to_world": [{"type": "scale", "value": 0.6}, {"type": "translate", "value": [x, 0.1, 0]}], "bsdf": NULL, "interior": fog(s, 1, g)}
        for name, x, s, g in (("left", -0.6, 1, 0.0), ("right", 0.6, 5, 0.5))
    }
    return Case(TOUCHING, "two white cubes in an oven", oven("pair", **parts), 1, ALL, "furnace")


def standing(half: tuple[float, float, float], at: tuple[float, float, float], **more: Any) -> dict:
    """A cube that is so wide, and stands on y = at[1]."""
    x, y, z = at
    return {"type": "cube", "to_world": [{"type": "scale", "value": list(half)}, {"type": "translate", "value": [x, y + half[1], z]}], **more}


def on_lamp() -> Case:
    """An absorber that lies on a lamp."""
    disk = {"type": "disk", "bsdf": BLACK, "emitter": lamp(1)}
    upon = {"type": "cube", "to_world": [{"type": "scale", "value": [1, 1, 0.35]}, {"type": "translate", "value": [0, 0, 0.35]}], "bsdf": NULL, "interior": fog(2, 0)}
    source = scene("absorber on a lamp", sensor=parallel(0.4), lamp=disk, absorber=upon)
    return Case(TOUCHING, "absorber that lies on a lamp", source, float(np.exp(-2 * 0.7)), ALL, "exp(-tau)")


def on_white() -> Case:
    """A slab of white fog on a white floor: what absorbs nothing, in an oven."""
    floor = standing((1.1, 0.1, 1.1), (0, -0.67, 0), bsdf=diffuse(1))
    source = oven("fog on a floor", floor=floor, fog=standing((0.7, 0.4, 0.7), (0.1, -0.67 + 0.2, 0), bsdf=NULL, interior=fog(2, 1, 0.3)))
    return Case(TOUCHING, "white fog that stands on a white floor, in an oven", source, 1, ALL, "furnace")


def in_glass() -> Case:
    """White fog that fills a ball of glass of its own size."""
    shell = {"type": "sphere", "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}}
    source = oven("fog in glass of its size", glass=shell, fog={"type": "sphere", "bsdf": NULL, "interior": fog(1, 1)})
    return Case(TOUCHING, "white fog in glass of its size, in an oven", source, 1, EYE, "furnace")


def cells() -> Case:
    """Eight cubes that share faces, edges and corners: white fogs, and one that is matt."""
    parts: dict[str, Any] = {}
    for i in range(8):
        x, y, z = (0.5 * ((i >> k) & 1) - 0.25 for k in range(3))
        inside = {"bsdf": diffuse(1)} if i == 5 else {"bsdf": NULL, "interior": fog(0.3 * 3 ** (i % 4), 1, 0.2 * (i % 3))}
        parts[f"cell{i}"] = standing((0.25, 0.25, 0.25), (x + CUT, y - 0.25, z), **inside)
    return Case(TOUCHING, "eight white cells in an oven", oven("cells", **parts), 1, ALL, "furnace")
