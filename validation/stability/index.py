"""Indices of refraction 1 +- 1e-6: the image is that without the interface."""

import numpy as np

from validation.closed_forms.case import camera, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability.case import ALL, EYE, Case, ball, fog, lamp, moved, named, oven, with_object
from validation.stability.thickness import AWAY
from validation.closed_forms.view import View, pixel_means

ROW = "index 1 +- 1e-6"
INDICES = (1 + 1e-6, 1 - 1e-6)
SLAB = Slab(0.9, 2, 0.75)


def cases() -> list[Case]:
    """Each interface, with either index."""
    return [case for index in INDICES for case in (*slabs(index), absorber(index), white_ball(index), floor(index))]


def interface(kind: str, index: float) -> dict:
    """It."""
    return {"type": kind, "int_ior": index, "ext_ior": 1.0, **({"alpha": 0.1} if kind.startswith("rough") else {})}


def slabs(index: float) -> list[Case]:
    """Slabs of a medium within smooth and rough interfaces."""
    found = []
    for kind in ("dielectric", "roughdielectric"):
        for total, truth, blocker in zip(("UR1", "UT1"), SLAB.totals(), (-1.5, 1.5)):
            flat = with_object(lit_slab(SLAB, total, blocker), "slab", bsdf=interface(kind, index))
            source = named(moved(flat, AWAY), f"{kind} {index:.6f} {total}")
            found.append(Case(ROW, f"slab {total} in {kind} {told(index)}", source, truth, EYE, "adding-doubling"))
    return found


def told(index: float) -> str:
    """As the table says it."""
    return "1 + 1e-6" if index > 1 else "1 - 1e-6"


FOV = 20.0


def absorber(index: float) -> Case:
    """A ball that only absorbs under the sky: exp(-chord)."""
    sky = {"type": "constant", "radiance": 1.0}
    glass = ball(fog(0.5, 0), interface("dielectric", index))
    source = scene(f"absorber {index:.6f}", sensor=camera((0, 0, 5), (0, 0, 0), FOV), sky=sky, ball=glass)
    return Case(ROW, f"absorbing ball in dielectric {told(index)}", source, chords(), EYE, "exp(-chord)")


def chords() -> np.ndarray:
    """exp(-0.5 chord) of the unit ball, averaged over each pixel."""
    cosine = View((0, 0, 5), (0, 0, 0), FOV).directions() @ np.array([0.0, 0, -1])
    chord = 2 * np.sqrt(np.maximum(0, 1 - 25 * (1 - cosine**2)))
    return pixel_means(np.exp(-0.5 * chord))


def white_ball(index: float) -> Case:
    """A ball of white fog in an oven, in a rough interface, which is as good as smooth: light tracing cannot see through."""
    source = oven(f"oven {index:.6f}", ball=ball(fog(1, 1), interface("roughdielectric", index)))
    return Case(ROW, f"white ball in roughdielectric {told(index)}", source, 1, EYE, "furnace")


def floor(index: float) -> Case:
    """A thin pane over a lamp: it is not there."""
    pane = {"type": "rectangle", "bsdf": interface("thindielectric", index)}
    light = {"type": "rectangle", "to_world": [{"type": "translate", "value": [0, 0, -1]}], "emitter": lamp(1)}
    source = scene(f"pane {index:.6f}", sensor=camera((0, 0, 3), (0, 0, 0), 10), pane=pane, lamp=light)
    return Case(ROW, f"lamp behind thindielectric {told(index)}", source, 1, ALL, "nothing in between")
