"""Scene scale 1e-10 to 1e10 with extinction scaled inversely, and a scene far from the origin: the same image."""

from functools import partial

import tyndall
from tyndall.scene import Scene
from validation.closed_forms import point_light
from validation.closed_forms.case import ISOTROPIC, NULL, camera, diffuse, scene
from validation.closed_forms.slab import Slab, lit_slab
from validation.compare import options_of
from validation.stability.anisotropy import fog_image
from validation.stability.case import ALL, EYE, Case, Sampled, fog, lamp, moved, named, scaled
from validation.stability.kept import binary, kept

SCALE = "scene scale 1e-10 to 1e10"
ORIGIN = "a scene 1e5 to 1e10 units from the origin"
SCALES = tuple(10.0**k for k in range(-6, 7))
FAR, FARTHEST = (1e5, -1e5, 1e5), (1e10, -1e10, 1e10)
BATCHES, SAMPLES, SEED = 16, 5_000, 900_000_001
"""Of the room's truth: more than ten times the samples of a line."""
BY = {"pt": "bdpt", "bdpt": "pt", "lt": "bdpt"}
"""Whose image is whose truth."""
SLAB = Slab(0.9, 2, 0.75)


def cases() -> list[Case]:
    """All of them."""
    found = [case for size in SCALES[::2] for case in rooms(SCALE, scaled(room(), size), f", x {size:g}", size in (1e-6, 1.0, 1e6))]
    for size in (1e-10, 1e-6, 1e6, 1e10):
        found += [Case(SCALE, f"{case.name}, x {size:g}", scaled(case.scene, size), case.truth, case.methods, case.source) for case in known()]
    found += rooms(ORIGIN, moved(room(), FAR), ", 1e5", True)
    for by in (FAR, FARTHEST):
        found += [Case(ORIGIN, f"{case.name}, {by[0]:g}", moved(case.scene, by), case.truth, case.methods, case.source) for case in known()]
    return found


def rooms(row: str, there: Scene, remark: str, by_light: bool) -> list[Case]:
    """The room by each integrator, beside what another one shows of it as it is."""
    methods = ALL if by_light else EYE
    return [Case(row, f"room with fog{remark}", there, partial(reference, BY[method]), (method,), f"itself, by {BY[method]}") for method in methods]


def room() -> Scene:
    """A floor, a matt ball, a ball of fog and a lamp."""
    flat = [{"type": "rotate", "axis": [1, 0, 0], "angle": -90}]
    over = [{"type": "scale", "value": 0.6}, {"type": "rotate", "axis": [1, 0, 0], "angle": 90}, {"type": "translate", "value": [0.2, 2, 0.3]}]
    return scene(
        "room",
        sensor=camera((0.3, 1.6, 4), (0, 0.5, 0), 32),
        floor={"type": "rectangle", "to_world": [{"type": "scale", "value": 2}, *flat], "bsdf": diffuse(0.6)},
        stone={"type": "sphere", "center": [0.7, 0.4, -0.4], "radius": 0.4, "bsdf": diffuse(0.8)},
        cloud={"type": "sphere", "center": [-0.5, 0.7, 0.1], "radius": 0.6, "bsdf": NULL, "interior": fog((1, 2, 4), 0.9, 0.5)},
        lamp={"type": "rectangle", "to_world": over, "bsdf": diffuse(0), "emitter": lamp(5)},
    )


def reference(method: str) -> Sampled:
    """The room in its own size and place."""
    make = lambda: tyndall.render_batches(room(), BATCHES, spp=SAMPLES, seed=SEED, **options_of(method))
    return Sampled(kept(f"room-{method}", (room().key(), BATCHES, SAMPLES, SEED, binary()), make))


def known() -> list[Case]:
    """Scenes of known image: a slab, and a point light in fog."""
    slabs = [
        Case("", f"slab {total}", named(lit_slab(SLAB, total, blocker), f"slab {total}"), truth, EYE, "adding-doubling")
        for total, truth, blocker in zip(("UR1", "UT1"), SLAB.totals(), (-1.5, 1.5))
    ]
    return [*slabs, Case("", "point light in fog", point_light.lit("fog", ISOTROPIC), partial(fog_image, 0), EYE, "quadrature")]
