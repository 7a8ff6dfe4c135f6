"""Optical thickness from 1e-6 to 1e6."""

import numpy as np

from validation.closed_forms.case import BLACK, ISOTROPIC, NULL, camera, scene
from validation.closed_forms.furnace import ball_of_medium
from validation.closed_forms.slab import Slab, lit_slab
from validation.closed_forms.view import View, pixel_means
from validation.stability.case import ALL, EYE, Case, ball, fog, lamp, moved, named, oven, parallel, with_object
from validation.stability.half_space import reflectance

ROW = "optical thickness 1e-6 to 1e6"
DECADES = tuple(10.0**k for k in range(-6, 7))
ALBEDO = 0.9
AWAY = (0.37, 1.3, -0.21)
"""From where the origin would help: near 0 floating point numbers are finer than elsewhere."""
THICKEST = 100.0
"""Slabs thicker than this reflect as a half space does, to all digits."""


def cases() -> list[Case]:
    """All of them."""
    return [*glowing(), *boxes(), *furnaces(), *ovens(), *lamps_behind(), *scattering()]


def glowing() -> list[Case]:
    """Slabs that absorb and glow, and scatter nothing, before black: radiance 1 - exp(-b)."""
    flat = lit_slab(Slab(0, 1, 0), "", -1.5).tree()
    found = []
    for b in DECADES:
        slab = {**flat["slab"], "interior": {**fog(b, 0), "radiance": 1.0}}
        there = moved(scene(f"glow b {b:g}", sensor=flat["sensor"], slab=slab), AWAY)
        found.append(Case(ROW, f"glowing slab, b {b:g}", there, -np.expm1(-b), ("pt",), "1 - exp(-b)"))
    return found


def boxes() -> list[Case]:
    """Cubes that glow, under parallel rays along one axis: for light tracing, which starts all over the medium."""
    found = []
    for b in (b for b in DECADES if b <= 10):
        cube = {"type": "cube", "bsdf": NULL, "interior": {**fog(b / 2, 0), "radiance": 1.0}}
        source = scene(f"glow box b {b:g}", sensor=parallel(0.9), cube=cube)
        found.append(Case(ROW, f"glowing cube, b {b:g}", source, -np.expm1(-b), ("lt", "bdpt"), "1 - exp(-b)"))
    return found


def furnaces() -> list[Case]:
    """Balls that absorb nothing under a sky of radiance 1."""
    found = []
    for b in (b for b in DECADES if b <= 1e4):
        source = named(ball_of_medium(b, ISOTROPIC, NULL), f"furnace b {b:g}")
        # Walks that meet the sky, and nothing else, make no noise at all.
        chosen = EYE if b < 1e3 else ("pt/hit", *EYE)
        found.append(Case(ROW, f"white ball under the sky, b {b:g}", source, 1, chosen, "furnace"))
    return found


def ovens() -> list[Case]:
    """The same where light tracing can start: in an oven."""
    return [
        Case(ROW, f"white ball in an oven, b {b:g}", oven(f"oven b {b:g}", ball=ball(fog(b / 2, 1))), 1, ("lt",), "furnace")
        for b in (b for b in DECADES if b <= 100)
    ]


LAMP_DEPTHS = (1e-6, 1e-3, 1.0, 10.0, 80.0)


def lamps_behind() -> list[Case]:
    """A lamp seen through what only absorbs. Eye walks hardly come through, and `bdpt` leaves what is seen directly to them; light
    joined with the lens does."""
    found = []
    for b in LAMP_DEPTHS:
        cube = {"type": "cube", "bsdf": NULL, "interior": fog(b / 2, 0)}
        disk = {"type": "disk", "to_world": [{"type": "translate", "value": [0, 0, -1.5]}], "bsdf": BLACK, "emitter": lamp(1)}
        source = scene(f"behind b {b:g}", sensor={**camera((0, 0, 3), (0, 0, 0), 8)}, cube=cube, lamp=disk)
        chosen = ALL if b <= 1 else ("bdpt/next-event,join,lens", "lt")
        found.append(Case(ROW, f"lamp behind an absorber, b {b:g}", source, behind(b), chosen, "exp(-b / cos)"))
    return found


def behind(b: float) -> np.ndarray:
    """exp(-b / cos) averaged over each pixel of the lamp's view."""
    return pixel_means(np.exp(b / View((0, 0, 3), (0, 0, 0), 8).directions()[..., 2]))


def scattering() -> list[Case]:
    """Slabs of albedo 0.9 lit from above: adding-doubling, beyond b = 100 Chandrasekhar's H of the half space."""
    found = [near_slab()]
    for b in (*(b for b in DECADES if 1e-3 <= b <= 1e5), 2e5, 1e6):
        ur1, source = (Slab(ALBEDO, b, 0).totals()[0], "adding-doubling") if b <= THICKEST else (reflectance(ALBEDO), "H function")
        slab = moved(lit_slab(Slab(ALBEDO, b, 0), "UR1", -1.5), AWAY)
        found.append(Case(ROW, f"slab UR1, albedo {ALBEDO:g}, b {b:g}", slab, ur1, EYE, source, flaw=FLAW if b > 1e5 else "", flawed_by=0.08))
    return found


FLAW = (
    "a mean free path is 5e-6 or 1e-6 of the camera's distance, 80 or 16 steps of single precision; rays start up to 4 steps behind a"
    " boundary, and no collision can lie between"
)


def near_slab() -> Case:
    """The thickest slab, its top a tenth of a metre from the camera: nearer, numbers are finer."""
    b = DECADES[-1]
    flat = lit_slab(Slab(ALBEDO, b, 0), "UR1", -1.5)
    near = with_object(flat, "sensor", to_world=[{"type": "lookat", "origin": [0, 0.1, 0], "target": [0, 0, 0], "up": [0, 0, 1]}])
    name = f"slab UR1, albedo {ALBEDO:g}, b {b:g}, from nearby"
    return Case(ROW, name, named(near, "thick slab from nearby"), reflectance(ALBEDO), EYE, "H function")
