"""What may be chosen of how paths are sampled: a guide that walks follow, starts of light subpaths that are learnt, whatever
the pilot of `bdpt` takes, and a sky that is only hit. The image is the same."""

from functools import partial

from tyndall.scene import Scene
from validation.closed_forms import varying
from validation.closed_forms.case import BLACK, NULL, rgb, scene
from validation.closed_forms.furnace import ball_of_medium
from validation.closed_forms.slab import Slab, lit_slab
from validation.stability import lamps, published, scale
from validation.stability.case import Case, Truth, ball, fog, lamp, oven
from validation.stability.half_space import reflectance

GUIDE, STARTS, PILOT, SKY = "walks that follow a guide", "starts of light subpaths that are learnt", "what the pilot chooses", "a sky that is only hit"
SLAB = Slab(0.9, 2, 0.75)
Believed = tuple[str, Scene, Truth, str]
"""A name, a scene, its truth and where that is from."""


def cases() -> list[Case]:
    """All of them."""
    found = [Case(GUIDE, name, there, truth, ("pt+guide", "bdpt+guide"), source) for name, there, truth, source in (*enclosed(), *open_ones())]
    found += [Case(STARTS, name, there, truth, ("bdpt+learnt", "lt+learnt"), source) for name, there, truth, source in enclosed()]
    found += [Case(PILOT, name, there, truth, ("bdpt+pilot",), source) for name, there, truth, source in (*enclosed(), *open_ones(), *under_skies())]
    return found + [Case(SKY, name, there, truth, ("pt+sky", "bdpt+sky"), source) for name, there, truth, source in under_skies()]


def enclosed() -> list[Believed]:
    """Scenes that light subpaths reach."""
    place = {"type": "point", "position": lamps.PLACE.tolist(), "intensity": rgb(1)}
    inside = varying.furnace(10, varying.CONTRAST).tree()["ball"]
    return [
        ("white ball in an oven, b 4", oven("choices oven", ball=ball(fog(2, 1, 0.5))), 1, "furnace"),
        ("white ball of uneven voxels in an oven", oven("choices uneven oven", ball=inside), 1, "furnace"),
        ("glowing ball in equilibrium", oven("choices equilibrium", ball=ball({**fog(2, 0.6), "radiance": 1.0})), 1, "furnace"),
        ("floor lit by a point", lamps.lit_floor("choices", place, lamps.FLOOR_VIEW), lamps.lit_image("sphere"), "inverse square"),
        ("room with fog", scale.room(), partial(scale.reference, "pt"), "itself, by pt"),
    ]


def open_ones() -> list[Believed]:
    """Scenes under a sky, which light subpaths do not start from far away for."""
    slabs: list[Believed] = [
        (f"slab {total}", lit_slab(SLAB, f"choices {total}", blocker), truth, "adding-doubling")
        for total, truth, blocker in zip(("UR1", "UT1"), SLAB.totals(), (-1.5, 1.5))
    ]
    return [("white ball under the sky, b 10", ball_of_medium(10, {"type": "isotropic"}, NULL, "choices"), 1, "furnace"), *slabs]


def under_skies() -> list[Believed]:
    """A furnace of sky and lamps alike, and a half space under a sky and a sun."""
    bulb = {"type": "sphere", "center": [0, 1.6, 0.4], "radius": 0.4, "bsdf": BLACK, "emitter": lamp(1)}
    furnace = ball_of_medium(4, {"type": "hg", "g": 0.8}, NULL, "sky and lamp").tree()
    both = published.under_sun("half space under a sky and a sun", Slab(0.9, 60, 0), published.ABOVE, published.ABOVE).tree()
    sum_of_both = reflectance(0.9) + 0.1225723
    return [
        ("white ball under a sky and a lamp of its radiance", scene("sky and lamp", **varying.parts(furnace), bulb=bulb), 1, "furnace"),
        ("half space of albedo 0.9 under a sky and a sun", scene("sky and sun", **varying.parts(both), sky={"type": "constant", "radiance": rgb(1)}), sum_of_both, "H function"),
    ]
