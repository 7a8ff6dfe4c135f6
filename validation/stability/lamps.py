"""Emitter radius 1e-5, light against a surface, radiance 1e-20 and 1e20."""

from functools import partial

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms import point_light
from validation.closed_forms.case import BLACK, ISOTROPIC, NULL, diffuse, rgb, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.anisotropy import fog_image
from validation.stability.case import ALL, EYE, Case, ball, fog, lamp, named, oven, parallel, with_object
from validation.closed_forms.view import View, unit

RADIUS = "emitter radius 1e-5"
AGAINST = "light against a surface"
RADIANCE = "radiance 1e-20 and 1e20"


def cases() -> list[Case]:
    """All of them."""
    return [*tiny(), *against(), *radiances()]


# Emitter radius

TINY = 1e-5
PLACE = np.array([0.31, 0.77, -0.23])
"""Of the lamp over the floor y = 0."""
ALBEDO, SIGMA_T = 0.5, 0.9
FLOOR_VIEW = View((0, 2, 1.5), (0, 0, 0), 30)


def tiny() -> list[Case]:
    """A floor lit by a lamp of intensity 1 [W/sr] in vacuum and in what only absorbs, and fog lit by one."""
    found = []
    for name, sigma_t in (("vacuum", 0.0), ("absorber", SIGMA_T)):
        for shape in ("sphere", "disk"):
            source = lit_floor(f"{shape} in {name}", tiny_lamp(shape), FLOOR_VIEW, sigma_t)
            truth = lit_image(shape, sigma_t)
            found.append(Case(RADIUS, f"floor lit by a {shape} in {name}", source, truth, ALL, "inverse square, exp(-tau)"))
    found.append(Case(RADIUS, "fog lit by a sphere, scattered once", lit_fog(), partial(fog_image, 0), EYE, "quadrature"))
    return found


def tiny_lamp(shape: str) -> dict:
    """A lamp whose intensity, straight down at least, is 1."""
    down = [{"type": "rotate", "axis": [1, 0, 0], "angle": 90}] if shape == "disk" else []
    to_world = [{"type": "scale", "value": TINY}, *down, {"type": "translate", "value": PLACE.tolist()}]
    return {"type": shape, "to_world": to_world, "bsdf": BLACK, "emitter": lamp(1 / (np.pi * TINY**2))}


def lit_floor(name: str, source: dict, view: View, sigma_t: float = 0, air: dict | None = None) -> Scene:
    """A grey floor, a lamp over it, and all of it in `air`: an absorber, vacuum if sigma_t is 0."""
    flat = [{"type": "scale", "value": 2}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}]
    floor = {"type": "rectangle", "to_world": flat, "bsdf": diffuse(ALBEDO)}
    if not sigma_t and not air:
        return scene(f"lit floor {name}", sensor=view.sensor(), floor=floor, lamp=source)
    everywhere = {"type": "ref", "id": "air"}
    around = {"medium": everywhere} if source["type"] == "point" else {"exterior": everywhere}
    return scene(
        f"lit floor {name}",
        air=air or fog(sigma_t, 0),
        sensor={**view.sensor(), "medium": everywhere},
        floor={**floor, "exterior": everywhere, "interior": everywhere},
        lamp={**source, **around},
    )


def lit_image(shape: str, sigma_t: float = 0) -> np.ndarray:
    """The floor under a lamp that is all but a point: a disk that looks down, or else the same in all directions."""

    def radiance(points: np.ndarray, from_eye: np.ndarray) -> np.ndarray:
        to_lamp = PLACE - points
        distance = np.linalg.norm(to_lamp, axis=-1)
        cosine = to_lamp[..., 1] / distance
        irradiance = cosine ** (2 if shape == "disk" else 1) / distance**2
        return ALBEDO / np.pi * irradiance * np.exp(-sigma_t * (distance + from_eye - NEAR / FORWARD))

    # With a near plane the camera's rays start beyond it.
    NEAR, FORWARD = 1e-4, FLOOR_VIEW.directions() @ unit(np.subtract(FLOOR_VIEW.target, FLOOR_VIEW.eye))
    return FLOOR_VIEW.image(radiance)


def lit_fog() -> Scene:
    """The point light of the closed forms, a ball of its intensity in its place."""
    source = point_light.lit("tiny", ISOTROPIC)
    radiance = point_light.INTENSITY / (np.pi * TINY**2)
    air = {"type": "ref", "id": "fog"}
    place = {"center": point_light.LIGHT.tolist(), "radius": TINY}
    bulb = {"type": "sphere", **place, "bsdf": BLACK, "exterior": air, "emitter": lamp(radiance)}
    return Scene({**source.tree(), "light": bulb}, "tiny lamp in fog", {})


# Against a surface

GAP = 1e-4
BACK = -0.3
"""z of the lamp that stands on the floor."""
AFAR = View((0, 2, 1.5), (0, 0, 0.6), 30)
NEARBY = View((0.1, 0.02, BACK + 1e-3), (0.1, 0, BACK + 1e-3), 5, up=(0, 0, 1))
"""Its picture ends a tenth of a millimetre before the lamp."""
BESIDE = np.array([0.7, 0.3, -0.4])
"""Where the gap is: away from the origin."""
HALF_LAMP = 1e-3
WITHIN = View((0, GAP / 2, 0), (0, 0, 0), 60, up=(0, 0, 1))


def against() -> list[Case]:
    """A lamp that stands 1e-4 off a floor, and the floor in the gap below one that lies over it."""
    upright = np.array([[-0.5, GAP, BACK], [0.5, GAP, BACK], [0.5, 1 + GAP, BACK], [-0.5, 1 + GAP, BACK]])
    to_world = [{"type": "scale", "value": 0.5}, {"type": "translate", "value": [0, 0.5 + GAP, BACK]}]
    panel = {"type": "rectangle", "to_world": to_world, "bsdf": BLACK, "emitter": lamp(1)}
    formula = "Lambert's polygon formula"
    found = []
    for name, view, chosen in (("from afar", AFAR, ALL), ("its foot", NEARBY, EYE)):
        source = lit_floor(f"upright lamp {name}", panel, view)
        found.append(Case(AGAINST, f"floor before a lamp 1e-4 above it, {name}", source, polygon_image(view, upright), chosen, formula))
    s = HALF_LAMP
    over = np.array([[-s, GAP, -s], [s, GAP, -s], [s, GAP, s], [-s, GAP, s]])
    found.append(Case(AGAINST, "floor seen from within a gap of 1e-4", gap(), polygon_image(WITHIN, over), ALL, formula))
    return found


def polygon_image(view: View, corners: np.ndarray) -> np.ndarray:
    """The floor lit by a polygon of radiance 1."""
    return view.image(lambda points, _: ALBEDO / np.pi * polygon(points, corners))


def polygon(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Irradiance of points that face up from a polygon of radiance 1 above them (Lambert 1760)."""
    total = np.zeros(points.shape[:-1])
    for a, b in zip(corners, np.roll(corners, -1, axis=0)):
        to_a, to_b = unit(a - points), unit(b - points)
        normal = np.cross(to_a, to_b)
        length = np.linalg.norm(normal, axis=-1)
        angle = np.arctan2(length, (to_a * to_b).sum(axis=-1))
        total += angle * normal[..., 1] / np.where(length > 0, length, 1)
    return np.abs(total) / 2


def gap() -> Scene:
    """A lamp of half width 1e-3 over a floor, the camera between the two."""
    down = {"type": "rotate", "axis": [1, 0, 0], "angle": 90}
    over = [{"type": "scale", "value": HALF_LAMP}, down, {"type": "translate", "value": (BESIDE + [0, GAP, 0]).tolist()}]
    flat = [{"type": "scale", "value": 2}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}, {"type": "translate", "value": BESIDE.tolist()}]
    there = View(tuple((BESIDE + WITHIN.eye).tolist()), tuple((BESIDE + WITHIN.target).tolist()), WITHIN.fov, WITHIN.up)
    return scene(
        "gap",
        sensor=there.sensor(near=1e-7),
        floor={"type": "rectangle", "to_world": flat, "bsdf": diffuse(ALBEDO)},
        lamp={"type": "rectangle", "to_world": over, "bsdf": BLACK, "emitter": lamp(1)},
    )


# Radiance

SLAB = Slab(0.9, 2, 0.75)


def radiances() -> list[Case]:
    """Light of any strength obeys the same laws."""
    return [case for radiance in (1e-20, 1e20) for case in of_strength(radiance)]


def of_strength(radiance: float) -> list[Case]:
    """A furnace, a slab, a point light and a medium that glows."""
    name = f"{radiance:g}"
    flat = with_object(lit_slab(SLAB, "UR1", -1.5), "sky", radiance=rgb(radiance))
    point = {"type": "point", "position": PLACE.tolist(), "intensity": rgb(radiance)}
    cube = {"type": "cube", "bsdf": NULL, "interior": {**fog(0.5, 0), "radiance": radiance}}
    return [
        Case(RADIANCE, f"white ball in an oven, {name}", oven(f"oven {name}", radiance, ball=ball(fog(1, 1))), radiance, ALL, "furnace"),
        Case(RADIANCE, f"slab UR1 under a sky, {name}", named(flat, f"slab {name}"), radiance * SLAB.totals()[0], EYE, "adding-doubling"),
        Case(RADIANCE, f"floor lit by a point, {name}", lit_floor(f"point {name}", point, FLOOR_VIEW), radiance * lit_image("sphere"), ALL, "inverse square"),
        Case(RADIANCE, f"glowing cube, {name}", scene(f"glow {name}", sensor=parallel(0.9), cube=cube), radiance * -np.expm1(-1), ALL, "1 - exp(-b)"),
    ]
