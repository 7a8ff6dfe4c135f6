"""Albedo 0, 1 - 1e-7 and 1."""

from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.case import ALL, EYE, Case, ball, fog, moved, oven
from validation.stability.half_space import reflectance
from validation.stability.thickness import AWAY

ROW = "albedo 0, 1 - 1e-7, 1"
NEARLY = 1 - 1e-7
DEEP = 1e5


def cases() -> list[Case]:
    """All of them."""
    return [*slabs(), half_space(), *equilibria()]


def slabs() -> list[Case]:
    """Slabs by adding-doubling; what only absorbs reflects nothing at all."""
    found = []
    for albedo, b in ((0.0, 1.0), (NEARLY, 8.0), (1.0, 8.0)):
        for total, truth, blocker in zip(("UR1", "UT1"), Slab(albedo, b, 0).totals(), (-1.5, 1.5)):
            source = moved(lit_slab(Slab(albedo, b, 0), total, blocker), AWAY)
            found.append(Case(ROW, f"slab {total}, albedo {told(albedo)}, b {b:g}", source, truth, EYE, "adding-doubling"))
    return found


def half_space() -> Case:
    """So deep that 9e-4 of the light is lost on the way, and all that is not comes back."""
    source = moved(lit_slab(Slab(NEARLY, DEEP, 0), "UR1", -1.5), AWAY)
    return Case(ROW, f"slab UR1, albedo 1 - 1e-7, b {DEEP:g}", source, reflectance(NEARLY), ("pt/hit", *EYE), "H function")


def equilibria() -> list[Case]:
    """Balls that glow as the oven around them does (Kirchhoff)."""
    found = []
    for albedo in (0.0, NEARLY, 1.0):
        inside = {**fog(2, albedo), "radiance": 1.0} if albedo < 1 else fog(2, albedo)
        source = oven(f"equilibrium a {albedo:.9g}", ball=ball(inside))
        found.append(Case(ROW, f"ball in equilibrium, albedo {told(albedo)}", source, 1, ALL, "furnace"))
    return found


def told(albedo: float) -> str:
    """As the table says it."""
    return "1 - 1e-7" if albedo == NEARLY else f"{albedo:g}"
