"""Every tracker, in media that vary: the closed forms of `varying.py` and `glowing.py`."""

from validation.closed_forms import glowing, varying
from validation.stability.case import TRACKERS, Case, oven, ball

ROW = "every tracker"
OF_FUNCTIONS = ("closed_form", *TRACKERS[1:])


def cases() -> list[Case]:
    """Slabs that thin upwards, or of layers, an absorbing cloud, and balls that scatter and glow."""
    layers = varying.grid(varying.uneven((1, 9, 1), 100), varying.STRETCH)
    uneven = glowing.equilibria()[1].scene.tree()["ball"]["interior"]
    thin, grids = by("pt", OF_FUNCTIONS) + by("bdpt", OF_FUNCTIONS[::3]), by("pt", TRACKERS) + by("bdpt", TRACKERS[::3])
    return [
        *slabs("that thins", varying.thinning(0.3), thin),
        *slabs("of smooth layers", layers, grids),
        Case(ROW, "cloud that absorbs", varying.cloud("cosine", varying.FUNCTIONS["cosine"]), lambda: varying.seen("cosine"), thin, "quadrature"),
        Case(ROW, "uneven ball in equilibrium", oven("uneven equilibrium", ball=ball(uneven)), 1, grids + by("lt", TRACKERS[::3]), "furnace"),
    ]


def by(integrator: str, trackers: tuple[str, ...]) -> tuple[str, ...]:
    """An integrator with each of them."""
    return tuple(f"{integrator}:{tracker}" for tracker in trackers)


def slabs(what: str, density: dict, methods: tuple[str, ...]) -> list[Case]:
    """The slab of the closed forms, with its extinction spread so."""
    return [
        Case(ROW, f"slab {what}, {total}", varying.varying_slab(varying.SLAB, f"{what} {total}", density, blocker), truth, methods, "adding-doubling")
        for total, truth, blocker in zip(("UR1", "UT1"), varying.SLAB.totals(), (-1.5, 1.5))
    ]
