"""Media that emit.

- What absorbs and glows like a layer of radiance L shows L (1 - exp(-tau)), however it varies.
- A gain of radiance per metre without any matter shows the gain times the length.
- In equilibrium, under a sky of the radiance that the medium has itself, everything shows that radiance, whatever is
  absorbed, scattered and emitted on the way (Kirchhoff).
"""

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms import varying
from validation.closed_forms.case import ISOTROPIC, NULL, SKY, Case, camera, rgb, scene
from validation.closed_forms.case import medium as homogeneous
from validation.closed_forms.slab import Slab, lit_slab

ALL = ("pt", "lt", "bdpt")
RADIANCE = np.array([1.0, 0.5, 0.2])
COLOUR = rgb(*RADIANCE)
DEPTH = np.array([0.4, 1.0, 2.5])
GAIN = 0.7


def cases() -> list[Case]:
    """All of them."""
    return [*slabs(), *clouds(), *equilibria()]


def slabs() -> list[Case]:
    """Slabs of thickness 1, seen from straight above, before black."""
    stiff = varying.grid(varying.uneven((1, 16, 1), varying.CONTRAST), varying.STRETCH, filter_type="nearest")
    chromatic = {**homogeneous(DEPTH, 0, ISOTROPIC), "radiance": COLOUR}
    empty = {"type": "homogeneous", "sigma_t": 0.0, "emission": GAIN}
    thick = 2.0
    truth = RADIANCE * -np.expm1(-thick)
    found = [
        Case(slab("chromatic", chromatic), RADIANCE * -np.expm1(-DEPTH)),
        Case(slab("of gain only", empty), GAIN),
    ]
    for name, density in (("exponential", varying.thinning(0.3)), ("stiff layers", stiff)):
        found.append(Case(slab(name, {**varying.medium(density, 0, scale=thick), "radiance": COLOUR}), truth))
    return found


def slab(name: str, inside: dict) -> Scene:
    """The slab of `slab.py` without a sky."""
    flat = lit_slab(Slab(0, 1, 0), "", -1.5).tree()
    return scene(f"glowing slab {name}", sensor=flat["sensor"], slab={**flat["slab"], "interior": inside})


def clouds() -> list[Case]:
    """The absorbing boxes of `varying.py`, glowing before black."""
    return [cloud(name, density) for name, density in varying.FUNCTIONS.items()]


def cloud(name: str, density: dict) -> Case:
    """One of them."""
    dark = varying.cloud(name, density).tree()
    glowing = {**dark["cloud"], "interior": {**dark["cloud"]["interior"], "radiance": COLOUR}}
    truth = RADIANCE * (1 - varying.seen(name))
    return Case(scene(f"glowing {name}", sensor=dark["sensor"], cloud=glowing), truth, ALL, effort=0.5)


def equilibria() -> list[Case]:
    """Balls in equilibrium with the sky: even, and of uneven voxels."""
    even = {**homogeneous(2, 0.6, {"type": "hg", "g": 0.5}), "radiance": 1.0}
    to_world = [{"type": "translate", "value": [-0.5, -0.5, -0.5]}, {"type": "scale", "value": 2.0}]
    uneven = {**varying.medium(varying.grid(varying.uneven((4, 5, 6), 1e3), to_world), 0.8, scale=3), "radiance": 1.0}
    return [equilibrium("even", even), equilibrium("uneven", uneven)]


def equilibrium(name: str, inside: dict) -> Case:
    """A unit sphere under the sky."""
    ball = {"type": "sphere", "bsdf": NULL, "interior": inside}
    return Case(scene(f"equilibrium {name}", sensor=camera((0, 0, 5), (0, 0, 0), 25), sky=SKY, ball=ball), 1)
