"""Numbers that others published, for light that is scattered many times in thick media: isotropic scattering and index-matched
boundaries, unless a line says otherwise.

- Half spaces under a sun: Chandrasekhar's H functions (Radiative Transfer, 1950).
- Slabs that absorb nothing: Hopf's constant 0.71044609 gives what comes through.
- Half spaces behind a surface like glass: Giovanelli 1955, and adding-doubling.
- A point lamp in fog without end: singular eigenfunctions (Case and Zweifel, Linear Transport Theory, 1967).
"""

from typing import Any

from tyndall.scene import Scene
from validation.closed_forms.case import camera, rgb, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.case import EYE, Case, fog

ROW = "published numbers"
NARROW = 0.1
"""Degrees: the whole view sees the same."""
THICKNESS = {0.5: 60.0, 0.9: 150.0, 0.999: 1500.0, 1.0: 100.0}
"""By albedo, of what stands for a half space; the last is a slab of its own."""
ABOVE, ASLANT = (0.0, 1.0, 0.0), (3**0.5, 1.0, 0.0)
"""Towards the sun, or the camera: straight up, or 60 degrees off."""
UNDER_SUN = (
    (0.5, ABOVE, ABOVE, 0.0311476),
    (0.9, ABOVE, ABOVE, 0.1225723),
    (0.999, ABOVE, ABOVE, 0.3019304),
    (1.0, ABOVE, ABOVE, 0.3297939),
    (0.5, ABOVE, ASLANT, 0.0394217),
    (0.9, ABOVE, ASLANT, 0.1374533),
    (0.9, ASLANT, ABOVE, 0.1374533 / 2),
)
"""Albedo, where the sun is, where the camera is, and the radiance that it sees, for an irradiance of 1 across the beam."""
THROUGH = {10.0: 0.1469960, 100.0: 0.01655305}
"""By optical thickness, the radiance seen straight through a slab that absorbs nothing, for even light of 1 from below."""
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
        b, aslant = THICKNESS[albedo], [f"{what} 60 degrees off" for what, place in (("sun", sun), ("seen", eye)) if place == ASLANT]
        name = ", ".join([f"{'half space' if albedo < 1 else 'slab, b 100'} under a sun, albedo {albedo:g}", *aslant])
        found.append(Case(ROW, name, under_sun(name, Slab(albedo, b, 0), sun, eye), radiance, EYE, "H function"))
    return found


def under_sun(name: str, slab: Slab, sun: tuple[float, ...], eye: tuple[float, ...]) -> Scene:
    """The slab of `slab.py`, the sun in place of its sky."""
    flat = lit_slab(slab, "", -1.5).tree()
    light = {"type": "directional", "direction": [-x for x in sun], "irradiance": rgb(1)}
    view = camera(eye, (0, 0, 0), NARROW, up=(0, 0, 1))
    return scene(name, sensor=view, sun=light, slab=flat["slab"])


def slabs() -> list[Case]:
    """Lit by a sky, from below or from above."""
    found = []
    for b, radiance in THROUGH.items():
        source = lit_slab(Slab(1, b, 0), "UT1", 1.5)
        found.append(Case(ROW, f"through a white slab, b {b:g}", source, radiance, ("pt",), "Hopf's constant"))
    for slab, part in REFLECTED:
        source = lit_slab(slab, "UR1", -1.5)
        name = f"half space behind a surface of index {slab.n:g}, albedo {slab.a:g}, g {slab.g:g}"
        found.append(Case(ROW, name, source, part, EYE, "Giovanelli" if slab.g == 0 else "adding-doubling"))
    return found


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
