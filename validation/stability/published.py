"""Numbers that others published, for light that is scattered many times in thick media: isotropic scattering and index-matched
boundaries, unless a line says otherwise.

- Half spaces under a sun: Chandrasekhar's H functions (Radiative Transfer, 1950).
- Slabs that absorb nothing: Hopf's constant 0.71044609 gives what comes through.
- Half spaces behind a surface like glass: Giovanelli 1955, and adding-doubling.
- A point lamp in fog without end: singular eigenfunctions (Case and Zweifel, Linear Transport Theory, 1967).
"""

import math
from typing import Any

from tyndall.scene import Scene
from validation.closed_forms.case import BLACK, camera, film, rgb, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.case import EYE, Case, fog, mean, named, with_object
from validation.stability.half_space import h_function

ROW = "published numbers"
NARROW = 0.1
"""Degrees: the whole view sees the same."""
THICKNESS = {0.5: 60.0, 0.9: 150.0, 0.999: 1500.0, 1.0: 300.0}
"""By albedo, of what stands for a half space; where nothing is absorbed, what comes through it is known."""
ABOVE, ASLANT = (0.0, 1.0, 0.0), (3**0.5, 1.0, 0.0)
"""Towards the sun, or the camera: straight up, or 60 degrees off."""
UNDER_SUN = (
    (0.5, ABOVE, ABOVE, 0.0311476),
    (0.9, ABOVE, ABOVE, 0.1225723),
    (0.999, ABOVE, ABOVE, 0.3019304),
    (1.0, ABOVE, ABOVE, 0.3364282),
    (0.5, ABOVE, ASLANT, 0.0394217),
    (0.9, ABOVE, ASLANT, 0.1374533),
    (1.0, ABOVE, ASLANT, 0.3104996),
    (0.5, ASLANT, ABOVE, 0.0394217 / 2),
    (0.9, ASLANT, ABOVE, 0.1374533 / 2),
    (1.0, ASLANT, ABOVE, 0.3104996 / 2),
)
"""Albedo, where the sun is, where the camera is, and the radiance that it sees, for an irradiance of 1 across the beam."""
SLAB_UNDER_SUN = (100.0, 0.3297939)
"""Optical thickness of a slab of albedo 1, and the same of it, all straight up."""
HOPF = 0.71044609
THROUGH = {10.0: 0.1469960, 100.0: 0.01655305}
"""By optical thickness, the radiance seen straight through a slab that absorbs nothing, for even light of 1 from below."""
MILNE, FLAT = 2.331190, 0.1
"""The radiance that leaves a thick slab straight up, over that at this cosine; and the slab's thickness, above 30."""
MILNE_THROUGH = 30.0
STRAIGHT = 1.259119
"""The same over what leaves it in all, as radiance that is even."""
WHITE_SKY = (0.9, 0.478025)
"""Albedo of a half space, and the part of a white sky's light that it sends back."""
REFLECTED = ((Slab(0.9, 60, 0, n=1.5), 0.2600), (Slab(0.99, 2000, 0.9, n=1.4), 0.278707))
"""The part of a beam along the normal that comes back, surface and all."""
FROM_LAMP = {0.5: (0.0092946, 0.01639569), 0.99: (0.1105181, 0.1516277)}
"""By albedo, the radiance one mean free path from a lamp of 1 W/sr: straight away from it, and across."""


def cases() -> list[Case]:
    """All of them."""
    return [*half_spaces(), *slabs(), *beside_lamps()]


def half_spaces() -> list[Case]:
    """Under a sun."""
    found = []
    for albedo, sun, eye, radiance in UNDER_SUN:
        aslant = [f"{what} 60 degrees off" for what, place in (("sun", sun), ("seen", eye)) if place == ASLANT]
        name = ", ".join([f"half space under a sun, albedo {albedo:g}", *aslant])
        there = under_sun(name, Slab(albedo, THICKNESS[albedo], 0), sun, eye)
        lost = let_through(THICKNESS[albedo], sun, eye) if albedo == 1 else 0
        found.append(Case(ROW, name, there, radiance - lost, EYE, "H function"))
    b, radiance = SLAB_UNDER_SUN
    thick = under_sun("white slab under a sun", Slab(1, b, 0), ABOVE, ABOVE)
    return [*found, Case(ROW, f"slab under a sun, albedo 1, b {b:g}", thick, radiance, EYE, "adding-doubling"), white_sky()]


def let_through(b: float, sun: tuple[float, ...], eye: tuple[float, ...]) -> float:
    """What the radiance of a slab that absorbs nothing lacks of a half space's: the light that leaves it below, to all digits where
    it is thick."""
    h = [h_function(1, place[1] / math.hypot(*place)) for place in (sun, eye)]
    return h[0] * h[1] * sun[1] / math.hypot(*sun) / (4 * math.pi * (b + 2 * HOPF))


def under_sun(name: str, slab: Slab, sun: tuple[float, ...], eye: tuple[float, ...]) -> Scene:
    """The slab of `slab.py`, the sun in place of its sky."""
    flat = lit_slab(slab, "", -1.5).tree()
    light = {"type": "directional", "direction": [-x for x in sun], "irradiance": rgb(1)}
    view = camera(eye, (0, 0, 0), NARROW, up=(0, 0, 1))
    return scene(name, sensor=view, sun=light, slab=flat["slab"])


def slabs() -> list[Case]:
    """Lit by a sky, from below or from above."""
    found = [through(b, 1.0, radiance) for b, radiance in THROUGH.items()]
    found.append(through(MILNE_THROUGH, FLAT, flux(MILNE_THROUGH) * STRAIGHT / MILNE))
    found += [metered(f"flux through a white slab, b {b:g}", lit_slab(Slab(1, b, 0), "UT1", 1.5), flux(b), "Hopf's constant") for b in THROUGH]
    for slab, part in REFLECTED:
        source = lit_slab(slab, "UR1", -1.5)
        name = f"half space behind a surface of index {slab.n:g}, albedo {slab.a:g}, g {slab.g:g}"
        found.append(Case(ROW, name, source, part, EYE, "Giovanelli" if slab.g == 0 else "adding-doubling"))
    return found


def flux(b: float) -> float:
    """The part of even light that comes through a slab which absorbs nothing."""
    return 4 / 3 / (b + 2 * HOPF)


def through(b: float, cosine: float, radiance: float) -> Case:
    """A slab that absorbs nothing, seen at the cosine."""
    name = f"through a white slab, b {b:g}" + (f", at cosine {cosine:g}" if cosine < 1 else "")
    flat, aside = lit_slab(Slab(1, b, 0), "UT1", 1.5), (1 / cosine**2 - 1) ** 0.5
    view = camera((aside, 1.0, 0), (0, 0, 0), NARROW, up=(0, 0, 1))
    return Case(ROW, name, named(with_object(flat, "sensor", to_world=view["to_world"], fov=NARROW), name), radiance, EYE, "Hopf's constant")


def white_sky() -> Case:
    """What a half space sends back of a sky."""
    albedo, part = WHITE_SKY
    return metered(f"half space under a white sky, albedo {albedo:g}", lit_slab(Slab(albedo, THICKNESS[albedo], 0), "UR1", -1.5), part, "H function")


def metered(name: str, flat: Scene, part: float, source: str) -> Case:
    """The slab below a meter so small that it casts no shadow: irradiance from a radiance of 1 is pi."""
    down = {"type": "rotate", "axis": [1, 0, 0], "angle": 90}
    place = [{"type": "scale", "value": 1e-4}, down, {"type": "translate", "value": [0, 1, 0]}]
    sensor = {"type": "irradiancemeter", "film": film(1, 1), "sampler": {"type": "independent"}}
    meter = {"type": "rectangle", "to_world": place, "bsdf": BLACK, "sensor": sensor}
    rest = {k: v for k, v in flat.tree().items() if k not in ("type", "integrator", "sensor")}
    return Case(ROW, name, scene(name, **rest, meter=meter), math.pi * part, EYE, source, seen=mean)


def beside_lamps() -> list[Case]:
    """In fog without end."""
    found = []
    for albedo, radiances in FROM_LAMP.items():
        for (words, target), radiance in zip((("away from", (2, 0, 0)), ("across from", (1, 0, 1))), radiances):
            name = f"{words} a lamp in endless fog, albedo {albedo:g}"
            found.append(Case(ROW, name, beside_lamp(name, albedo, target), radiance, EYE, "singular eigenfunctions"))
    return found


def beside_lamp(name: str, albedo: float, target: tuple[float, ...]) -> Scene:
    """The lamp stands in the origin, the camera at x = 1. What is nearer to it than its clip distance is not seen."""
    reference: dict[str, Any] = {"type": "ref", "id": "fog"}
    sensor = camera((1, 0, 0), target, NARROW, near_clip=1e-6, medium=reference)
    lamp = {"type": "point", "position": [0, 0, 0], "intensity": rgb(1), "medium": reference}
    return scene(name, fog={**fog(1, albedo), "id": "fog"}, sensor=sensor, lamp=lamp)
