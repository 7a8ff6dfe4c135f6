"""Wide slabs against adding-doubling (iadpython): reflectance and transmittance, the unscattered part included.

A camera that looks straight down on a slab under a uniform half-space of radiance 1 sees, by reciprocity, what of a
beam falling straight down would go into that half-space: UT1 if it lies below, UR1 if above.
"""

from dataclasses import dataclass

import iadpython

from tyndall.scene import Scene
from validation.closed_forms.case import BLACK, NULL, SKY, Case, camera, medium, scene

QUADRATURE_POINTS = 16
HALF_WIDTH = 200
"""In thicknesses: what leaks in at the rim, between slab and blocker, is below 1e-5."""


@dataclass(frozen=True)
class Slab:
    """Albedo, optical thickness, mean cosine (Henyey-Greenstein), index of refraction."""

    a: float
    b: float
    g: float
    n: float = 1
    effort: float = 1

    def totals(self) -> tuple[float, float]:
        """UR1 and UT1."""
        sample = iadpython.Sample(a=self.a, b=self.b, g=self.g, n=self.n, quad_pts=QUADRATURE_POINTS)
        ur1, ut1, _, _ = sample.rt()
        return float(ur1), float(ut1)


SLABS = (
    Slab(0.9, 2, 0.75),
    Slab(0.5, 1, 0),
    Slab(0.2, 0.5, -0.5),
    Slab(0.99, 8, 0.5),
    Slab(1, 4, 0),
    Slab(0.95, 2, 0.5, n=1.4),
    Slab(0.99999, 100, 0, effort=0.1),
)


def cases() -> list[Case]:
    """Each slab, lit from below and from above. Few walks come through a thick one."""
    found = []
    for slab in SLABS:
        ur1, ut1 = slab.totals()
        quick = {"pt": 0, "bdpt": 0} if slab.b > 50 else {}
        found.append(Case(lit_slab(slab, "UT1", blocker_height=1.5), ut1, effort=slab.effort, quick=quick))
        found.append(Case(lit_slab(slab, "UR1", blocker_height=-1.5), ur1, effort=slab.effort))
    return found


def lit_slab(slab: Slab, name: str, blocker_height: float) -> Scene:
    """The slab from y = -1 to 0, the camera above it at 1; a black sheet shuts out the other half of the sky."""
    wide = {"type": "scale", "value": [HALF_WIDTH, HALF_WIDTH, 1]}
    upright = {"type": "rotate", "axis": [1, 0, 0], "angle": -90}
    glass = {"type": "dielectric", "int_ior": slab.n, "ext_ior": 1.0}
    return scene(
        f"slab {slab.a:g} {slab.b:g} {slab.g:g} {slab.n:g} {name}",
        sensor=camera((0, 1, 0), (0, 0, 0), 0.1, up=(0, 0, 1)),
        sky=SKY,
        slab={
            "type": "cube",
            "to_world": [
                {"type": "scale", "value": [HALF_WIDTH, 0.5, HALF_WIDTH]},
                {"type": "translate", "value": [0, -0.5, 0]},
            ],
            "bsdf": NULL if slab.n == 1 else glass,
            "interior": medium(slab.b, slab.a, {"type": "hg", "g": slab.g}),
        },
        blocker={
            "type": "rectangle",
            "to_world": [wide, upright, {"type": "translate", "value": [0, blocker_height, 0]}],
            "bsdf": BLACK,
        },
    )
