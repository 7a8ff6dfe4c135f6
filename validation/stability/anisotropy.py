"""g = 0, +-1e-4, +-0.999, +-0.99999 (Henyey-Greenstein)."""

from functools import cache, partial

import numpy as np

from validation.closed_forms import point_light
from validation.closed_forms.case import medium
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability import photons
from validation.stability.case import ALL, EYE, Case, Sampled, ball, moved, named, oven
from validation.stability.thickness import AWAY

ROW = "g = 0, +-1e-4, +-0.999, +-0.99999"
VALUES, SHARPEST = (0.0, 1e-4, -1e-4, 0.999, -0.999), (0.99999, -0.99999)
SLABS = {0.999: (1.0, 100.0)}
"""Albedo and optical thickness, where hardly any light would come back from those of the others:"""
USUAL = (0.9, 2.0)


def cases() -> list[Case]:
    """All of them."""
    return [case for g in VALUES for case in (*slabs(g), in_oven(g), single(g))] + [case for g in SHARPEST for case in (in_oven(g), single(g))]


def slabs(g: float) -> list[Case]:
    """Reflectance and transmittance; see `photons.py` for the sharp ones."""
    found = []
    for i, (total, blocker) in enumerate((("UR1", -1.5), ("UT1", 1.5))):
        sharp = abs(g) > 0.9
        slab = Slab(*SLABS.get(g, USUAL), g)
        truth = partial(traced, g, i) if sharp else slab.totals()[i]
        source = named(moved(lit_slab(slab, total, blocker), AWAY), f"slab g {g:g} {total}")
        told = "photons in double precision" if sharp else "adding-doubling"
        found.append(Case(ROW, f"slab {total}, g {g:g}", source, truth, EYE, told))
    return found


def traced(g: float, which: int) -> Sampled:
    """One of the totals."""
    return photons.totals(*SLABS.get(g, USUAL), g)[which]


def in_oven(g: float) -> Case:
    """A white ball in an oven. Light that passes nearly straight on hardly ever points at the lens."""
    inside = medium(1, 1, {"type": "hg", "g": g})
    return Case(ROW, f"white ball in an oven, g {g:g}", oven(f"oven g {g:g}", ball=ball(inside)), 1, ALL if abs(g) < 0.9 else EYE, "furnace")


@cache
def fog_image(g: float) -> np.ndarray:
    """The fog of the closed forms under a point light."""
    return point_light.image(partial(point_light.henyey_greenstein, g=g))


def single(g: float) -> Case:
    """A point light in fog, scattered once."""
    source = point_light.lit(f"g {g:g}", {"type": "hg", "g": g})
    return Case(ROW, f"point light in fog, scattered once, g {g:g}", source, partial(fog_image, g), EYE, "quadrature")
