"""Grazing incidence, 89.99 degrees from the normal."""

import numpy as np

from validation.closed_forms.case import BLACK, NULL, camera, diffuse, orthographic, scene
from validation.stability.case import EYE, Case, fog, named
from validation.stability.half_space import reflectance

ROW = "grazing incidence 89.99 degrees"
ANGLE = np.radians(89.99)
COSINE = float(np.cos(ANGLE))
WIDE = 2e4
"""Half width [m] of what is seen so flat from so near that its rim does not matter."""
INDEX = 1.5


def cases() -> list[Case]:
    """Light that grazes, and views that do."""
    return [sunlit_floor(), *glass(), absorber(), half_space()]


def sunlit_floor() -> Case:
    """A floor under a sun that sets: albedo / pi times irradiance times cosine."""
    sun = {"type": "directional", "direction": [float(np.sin(ANGLE)), -COSINE, 0], "irradiance": 3.0}
    flat = [{"type": "rotate", "axis": [1, 0, 0], "angle": -90}]
    floor = {"type": "rectangle", "to_world": flat, "bsdf": diffuse(0.5)}
    source = scene("setting sun", sensor=camera((0, 2, 0), (0, 0, 0), 30, up=(0, 0, 1)), sun=sun, floor=floor)
    return Case(ROW, "floor under a sun", source, 3 * 0.5 / np.pi * COSINE, EYE, "E cos / pi")


def flat_view() -> dict:
    """Parallel rays that meet the plane y = 0 near the origin at the angle."""
    away = 10.0
    eye = [0, away * COSINE, away * float(np.sin(ANGLE))]
    return orthographic(eye, (0, 0, 0), 1e-5)


def upwards(half_width: float, y: float, bsdf: dict) -> dict:
    """A square that faces up."""
    to_world = [{"type": "scale", "value": half_width}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}]
    return {"type": "rectangle", "to_world": [*to_world, {"type": "translate", "value": [0, y, 0]}], "bsdf": bsdf}


def sky() -> dict:
    """Radiance 1 from everywhere."""
    return {"type": "constant", "radiance": 1.0}


def glass() -> list[Case]:
    """A glass surface before black, seen so flat that it is all but a mirror."""
    surface = upwards(WIDE, 0, {"type": "dielectric", "int_ior": INDEX, "ext_ior": 1.0})
    source = scene("grazed glass", sensor=flat_view(), sky=sky(), glass=surface, below=upwards(WIDE, -1, BLACK))
    return [Case(ROW, "glass under the sky", source, fresnel(COSINE), EYE, "Fresnel")]


def fresnel(cosine: float) -> float:
    """Reflectance of the glass."""
    inner = np.sqrt(1 - (1 - cosine**2) / INDEX**2)
    s = (cosine - INDEX * inner) / (cosine + INDEX * inner)
    p = (INDEX * cosine - inner) / (INDEX * cosine + inner)
    return float((s * s + p * p) / 2)


def slab(name: str, interior: dict, depth: float) -> dict:
    """A wide layer below y = 0."""
    step = [{"type": "scale", "value": [WIDE, depth / 2, WIDE]}, {"type": "translate", "value": [0, -depth / 2, 0]}]
    return {"type": "cube", "to_world": step, "bsdf": NULL, "interior": interior}


def absorber() -> Case:
    """The sky through a thin layer that absorbs 1e-4 straight down and half of what grazes."""
    b = 1e-4
    layer = slab("layer", fog(1.0, 0), b)
    source = scene("grazed absorber", sensor=flat_view(), sky=sky(), layer=layer)
    return Case(ROW, "sky through an absorbing layer, b 1e-4", source, float(np.exp(-b / COSINE)), EYE, "exp(-b / cos)")


def half_space() -> Case:
    """A half space of albedo 0.9: what comes back of a beam that grazes it."""
    ground = slab("ground", fog(1.0, 0.9), 50)
    source = scene("grazed half space", sensor=flat_view(), sky=sky(), ground=ground, below=upwards(WIDE, -51, BLACK))
    return Case(ROW, "half space of albedo 0.9", named(source, "grazed half space"), reflectance(0.9, COSINE), EYE, "H function")
