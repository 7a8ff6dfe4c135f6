"""Media that vary in space, where theory still knows the answer.

- Furnaces: what absorbs nothing shows radiance 1, however unevenly it scatters.
- Slabs: light in a plane slab knows heights only as optical depths, so that any vertical profile of the same total
  thickness has the reflectance and transmittance of the homogeneous slab.
- Rods: an absorbing block of voxels seen by parallel rays along the voxels' rows; each pixel is exp(-tau) of its row.
- Absorbing clouds under rays in all directions: tau by quadrature.
- Single scattering of sunlight in a layer that thins upwards: one integral, by quadrature.

Stiff rows have neighbouring voxels 1e6 apart, or an optical thickness of 1e4.
"""

import hashlib
from functools import cache
from typing import Any

import numpy as np

from tyndall.scene import Scene
from tyndall.volume_file import vol
from validation import densities
from validation.closed_forms.case import ISOTROPIC, NULL, SIZE, SKY, Case, camera, orthographic, rgb, scene
from validation.closed_forms.slab import HALF_WIDTH, Slab, lit_slab
from validation.closed_forms.view import View, pixel_means
from validation.places import TARGET

FOLDER = TARGET / "validation-volumes"
CONTRAST = 1e6
GRID = ("pt:exact", "pt:march", "pt:null_collision", "bdpt")
FUNCTION = ("pt:closed_form", "pt:march", "pt:null_collision", "bdpt")


def cases() -> list[Case]:
    """All of them."""
    return [*furnaces(), *slabs(), *rods(), *clouds(), *sunlit()]


def grid(samples: np.ndarray, to_world: list, **more: Any) -> dict:
    """A gridvolume of these samples, (z, y, x)."""
    content = vol(samples)
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{hashlib.sha256(content).hexdigest()[:20]}.vol"
    path.write_bytes(content)
    return {"type": "gridvolume", "filename": str(path), "to_world": to_world, **more}


def medium(sigma_t: dict, albedo: float, phase: dict = ISOTROPIC, scale: float = 1.0) -> dict:
    """A medium whose extinction varies."""
    return {"type": "heterogeneous", "sigma_t": sigma_t, "albedo": float(albedo), "scale": float(scale), "phase": phase}


def uneven(shape: tuple[int, ...], contrast: float, seed: int = 5) -> np.ndarray:
    """Random voxels between 1 / contrast and 1, the mean being 1: about as many of every magnitude."""
    values = contrast ** -np.random.default_rng(seed).uniform(0, 1, shape)
    values.flat[0], values.flat[1] = 1, 1 / contrast
    return values / values.mean()


# Furnaces


def furnaces() -> list[Case]:
    """Balls that hold a grid of white medium."""
    return [
        Case(furnace(2, 10), 1, GRID),
        Case(furnace(10, 10, filter_type="nearest"), 1),
        Case(furnace(10, CONTRAST), 1, GRID),
        Case(furnace(1e4, 10), 1, ("pt", "bdpt"), effort=0.01, quick={"bdpt": 0}),
    ]


def furnace(thickness: float, contrast: float, **options: Any) -> Scene:
    """A unit sphere under the sky, of this mean optical diameter."""
    to_world = [{"type": "translate", "value": [-0.5, -0.5, -0.5]}, {"type": "scale", "value": 2.0}]
    density = grid(uneven((4, 5, 6), contrast), to_world, **options)
    return scene(
        f"furnace grid b {thickness:g} contrast {contrast:g}",
        sensor=camera((0, 0, 5), (0, 0, 0), 25),
        sky=SKY,
        ball={"type": "sphere", "bsdf": NULL, "interior": medium(density, 1, scale=thickness / 2)},
    )


# Slabs


SLAB = Slab(0.9, 2, 0.75)
WHITE_SLAB = Slab(1, 4, 0)
STRETCH = [
    {"type": "scale", "value": [2 * HALF_WIDTH, 1, 2 * HALF_WIDTH]},
    {"type": "translate", "value": [-HALF_WIDTH, -1, -HALF_WIDTH]},
]
"""From the unit cube to the slab."""


def slabs() -> list[Case]:
    """Slabs that vary with height only."""
    found = []
    for slab, name, density, methods in (
        (SLAB, "exponential", thinning(0.3), FUNCTION),
        (WHITE_SLAB, "exponential", thinning(0.1), ("pt", "bdpt")),
        (SLAB, "layers", grid(uneven((1, 9, 1), 100), STRETCH), GRID),
        (SLAB, "stiff layers", grid(uneven((1, 16, 1), CONTRAST), STRETCH, filter_type="nearest"), GRID),
        (WHITE_SLAB, "stiff layers", grid(uneven((1, 16, 1), CONTRAST), STRETCH), ("pt", "bdpt")),
    ):
        for total, truth, blocker, march in zip(("UR1", "UT1"), slab.totals(), (-1.5, 1.5), (0.5, 0)):
            lit = varying_slab(slab, f"{name} {total}", density, blocker)
            found.append(Case(lit, truth, methods, effort=0.5, quick={"pt:march": march}))
    return found


def thinning(scale_height: float) -> dict:
    """exp(-y / h) between y = -1 and 0, times what makes its integral 1."""
    value = 1 / (scale_height * np.expm1(1 / scale_height))
    return {"type": "exponential", "scale_height": scale_height, "value": float(value)}


def varying_slab(slab: Slab, name: str, density: dict, blocker: float) -> Scene:
    """The slab of `slab.py`, its extinction spread over the height by `density`, whose vertical integral is 1."""
    flat = lit_slab(slab, name, blocker)
    inside = medium(density, slab.a, {"type": "hg", "g": slab.g}, slab.b)
    changed = {**flat.tree()["slab"], "interior": inside}
    return scene(f"slab {slab.a:g} {slab.b:g} {slab.g:g} {name}", **{**parts(flat.tree()), "slab": changed})


def parts(tree: dict) -> dict:
    """The objects of a scene."""
    return {name: o for name, o in tree.items() if name not in ("type", "integrator")}


# Rods


def rods() -> list[Case]:
    """Blocks whose rows along z are uneven, even, or as stiff as can be."""
    random = uneven((SIZE, SIZE, SIZE), CONTRAST)
    thick = np.broadcast_to(np.where(np.indices((SIZE, SIZE)).sum(axis=0) % 2, 1e4, 0.7), (3, SIZE, SIZE))
    return [
        Case(block("uneven", random), image_of(random), GRID),
        Case(block("thickness 1e4", thick), image_of(thick), GRID, effort=0.05),
    ]


def block(name: str, samples: np.ndarray) -> Scene:
    """A block of nearest voxels from z = 0 to 1 under the sky, seen along z, a pixel for each row."""
    density = grid(samples, [], filter_type="nearest")
    box = [{"type": "translate", "value": [1, 1, 1]}, {"type": "scale", "value": 0.5}]
    return scene(
        f"block {name}",
        sensor=orthographic((0.5, 0.5, 3), (0.5, 0.5, 0), 0.5),
        sky=SKY,
        block={"type": "cube", "to_world": box, "bsdf": NULL, "interior": medium(density, 0)},
    )


def image_of(samples: np.ndarray) -> np.ndarray:
    """exp(-tau) of each row; pixels run downwards, voxels upwards."""
    return np.exp(-samples.mean(axis=0))[::-1, :, None]


# Clouds


BOX = np.array([[-0.8, 0.0, -0.6], [0.8, 1.3, 0.6]])
VIEW = View((0.4, 1.9, 3.0), (0.0, 0.6, 0.0), 17.0, nodes=6)
"""The box fills it: of a pixel that it only grazes, hardly a sample would know of it."""
STEPS = 1000


WAVE = {"type": "wave", "amplitude": 0.7, "vector": [5, -3, 2], "phase": 0.4}
FUNCTIONS = {
    "cosine": {"type": "cosine", "value": 1, "first": WAVE},
    "polynomial": {"type": "polynomial", "half_width": 0.5, "x": "0.5, 0.2, -1", "y": "1, 0, 3", "value": 0.6},
    "equipotential": {"type": "equipotential", "center": [0.1, 0.6, 0], "c": 0.1, "d": 3, "value": 0.5},
    "exponential": {"type": "exponential", "scale_height": 0.4, "up": [0.3, 1, 0.2], "value": 2},
}


def clouds() -> list[Case]:
    """Absorbing boxes of each density function."""
    return [Case(cloud(name, function), seen(name), FUNCTION, effort=0.5) for name, function in FUNCTIONS.items()]


def cloud(name: str, density: dict) -> Scene:
    """A box of it under the sky."""
    half, middle = (BOX[1] - BOX[0]) / 2, BOX.mean(axis=0)
    to_world = [{"type": "scale", "value": half.tolist()}, {"type": "translate", "value": middle.tolist()}]
    return scene(
        f"absorbing {name}",
        sensor=camera(VIEW.eye, VIEW.target, VIEW.fov),
        sky=SKY,
        cloud={"type": "cube", "to_world": to_world, "bsdf": NULL, "interior": medium(density, 0)},
    )


@cache
def seen(name: str) -> np.ndarray:
    """exp(-tau) of the box of a function, averaged over each pixel."""
    directions = VIEW.directions()
    depths = np.array([[depth(FUNCTIONS[name], row) for row in pixels] for pixels in directions.reshape(SIZE, SIZE, -1, 3)])
    return pixel_means(np.exp(-depths).reshape(directions.shape[:-1]))


def depth(density: dict, directions: np.ndarray) -> np.ndarray:
    """Optical depth of the box along rays from the eye, by the midpoint rule."""
    ends = np.sort((BOX[:, None] - np.asarray(VIEW.eye)) / directions, axis=0)
    start, stop = np.maximum(ends[0].max(axis=-1), 0), ends[1].min(axis=-1)
    length = np.maximum(stop - start, 0)
    t = start + length * ((np.arange(STEPS) + 0.5) / STEPS)[:, None]
    points = np.asarray(VIEW.eye) + t[..., None] * directions
    return densities.value(density, points)[..., 0].mean(axis=0) * length


# Sunlight


SUNS = ((0.0, -1.0, 0.0), (0.6, -0.8, 0.0))
IRRADIANCE, LAYER_ALBEDO, LAYER_DEPTH, LAYER_SCALE = 3.0, 0.8, 2.5, 0.25


def sunlit() -> list[Case]:
    """Single scattering in a layer of exponential density, seen from above, lit from above."""
    return [Case(sunlit_layer(i, sun), single(sun), FUNCTION) for i, sun in enumerate(SUNS)]


def sunlit_layer(number: int, sun: tuple[float, ...]) -> Scene:
    """The slab of `slab.py`, once more."""
    flat = lit_slab(Slab(LAYER_ALBEDO, LAYER_DEPTH, 0), "", -1.5).tree()
    # What marching gets wrong of so little light must stay below what the picture resolves.
    inside = {**medium(thinning(LAYER_SCALE), LAYER_ALBEDO, scale=LAYER_DEPTH), "march_error": 1e-4}
    return scene(
        f"single scattering in a layer, sun {number}",
        max_depth=2,
        sensor=flat["sensor"],
        sun={"type": "directional", "direction": list(sun), "irradiance": rgb(IRRADIANCE)},
        slab={**flat["slab"], "interior": inside},
    )


def single(sun: tuple[float, ...]) -> float:
    """Light goes down to the optical depth d along 1 / mu and comes straight up; over d it is one exponential."""
    mu = -sun[1]
    there_and_back = 1 + 1 / mu
    return IRRADIANCE * LAYER_ALBEDO / (4 * np.pi) * -np.expm1(-LAYER_DEPTH * there_and_back) / there_and_back
