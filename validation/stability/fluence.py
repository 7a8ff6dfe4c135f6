"""Fluence at a point: radiance from all directions, seen by six cameras that look through the faces of a cube.

- Beside a lamp in fog without end: singular eigenfunctions (Case and Zweifel, Linear Transport Theory, 1967).
- Voids beside shields: the benchmarks of Kobayashi, Sugimura and Nagaya (OECD/NEA 2000), mirrored at their reflecting faces.
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from tyndall.scene import Scene
from validation.closed_forms.case import NULL, SIZE, camera, film, rgb, scene
from validation.stability.case import ALL, EYE, Case, Sampled, Truth, fog

LAMPS, VOIDS = "fluence beside a lamp in endless fog", "fluence in voids beside shields"
SIDE = 48
"""Pixels of a face: small beside the source as it is seen, for each has one weight."""
FACES = tuple((sign * axis, up) for axis, up in zip(np.eye(3), np.eye(3)[[1, 2, 0]]) for sign in (1, -1))
FAR = ("bdpt",)
"""Eye walks seldom find a lamp so far away, and vertices of light next to the lens are bright without a bound."""
BESIDE_LAMP = ((1, 0.5, 0.7375849, EYE), (1, 0.9, 1.800558, EYE), (10, 0.5, 5.791427e-6, FAR), (10, 0.99, 0.05259142, FAR))
"""Distance in mean free paths from a lamp of 1 W/sr, albedo, fluence."""
SHIELD, VOID = 0.1, 1e-4
"""Extinctions per metre."""
SOURCE, CAVITY, WALL, DUCT = 10.0, 50.0, 100.0, (60.0, 100.0, 60.0)
"""Half widths, in metres."""
KNOWN_BY = 0.002
"""The relative standard error of what is known of them; 0.6 % is thrice that."""
IN_CAVITY = (
    ((5, 5, 5), (5.95659, EYE), (8.29260, EYE)),
    ((5, 25, 5), (0.500871, ALL), (0.713986, ALL)),
    ((5, 95, 5), (3.46846e-4, ("lt",)), (1.85082e-3, ("bdpt",))),
)
BY_DUCT = (((5, 95, 5), (0.0320574, ALL), (0.0544807, ALL)), ((55, 95, 5), (4.14132e-6, ("lt",)), (6.02771e-5, ("bdpt",))))
"""Places, and by albedo, 0 and 0.5, the fluence there and who sees it. Light tracing does where nothing next to the lens scatters or
shines. The last is not decided in its time: that would take twice as long."""


def cases() -> list[Case]:
    """All of them."""
    return [*beside_lamps(), *in_voids("cube of void", cavity, IN_CAVITY), *in_voids("duct of void", duct, BY_DUCT)]


def fluence_of(images: np.ndarray) -> np.ndarray:
    """Of images of the six faces side by side: the sum over solid angles, everywhere."""
    edges = np.linspace(-1, 1, SIDE + 1)
    u, v = edges[:, None], edges
    corner = np.arctan(u * v / np.sqrt(1 + u * u + v * v))
    angles = np.tile(np.diff(np.diff(corner, axis=0), axis=1), (1, len(FACES)))
    total = (images * angles[..., None]).sum(axis=(1, 2), keepdims=True)
    return np.broadcast_to(total, (len(images), SIZE, SIZE, images.shape[-1]))


def around(place: tuple[float, ...], medium: str) -> dict[str, Any]:
    """The cameras."""
    view = {"near_clip": 1e-6, "film": film(SIDE, SIDE), "medium": {"type": "ref", "id": medium}}
    faces = (camera(place, (np.array(place) + towards).tolist(), 90, up=up.tolist(), **view) for towards, up in FACES)
    return {f"sensor{i}": face for i, face in enumerate(faces)}


def case(row: str, name: str, there: Scene, truth: Truth, methods: tuple[str, ...], source: str) -> Case:
    """A fluence."""
    return Case(row, name, there, truth, methods, source, seen=fluence_of, sensors=len(FACES))


def beside_lamps() -> Iterator[Case]:
    """The lamp stands in the origin; cameras do not see it itself."""
    for r, albedo, fluence, methods in BESIDE_LAMP:
        lamp = {"type": "point", "position": [0, 0, 0], "intensity": rgb(1), "medium": {"type": "ref", "id": "fog"}}
        name = f"{r} mean free path{'s' if r > 1 else ''} from a lamp, albedo {albedo:g}"
        there = scene(name, fog={**fog(1, albedo), "id": "fog"}, lamp=lamp, **around((r, 0, 0), "fog"))
        yield case(LAMPS, name, there, fluence - math.exp(-r) / r**2, methods, "singular eigenfunctions, the lamp's own light left out")


def in_voids(what: str, build: Any, known: tuple) -> Iterator[Case]:
    """By albedo and place."""
    for place, *told in known:
        for albedo, (fluence, methods) in zip((0.0, 0.5), told):
            name = f"{what}, albedo {albedo:g}, at {place}"
            yield case(VOIDS, name, build(name, albedo, place), uncertain(fluence), methods, "Kobayashi et al. 2000")


def uncertain(value: float) -> Sampled:
    """A number with its error, as batches that tell as much."""
    steps = np.linspace(-1, 1, 16)
    return Sampled(value * (1 + KNOWN_BY * steps * math.sqrt(16) / steps.std(ddof=1)))


def media(albedo: float) -> dict[str, Any]:
    """Of both problems: each place has a medium that another one may be beside."""
    kinds = {"source": {**fog(SHIELD, albedo), "emission": 1 / (4 * math.pi)}, "void": fog(VOID, albedo), "shield": fog(SHIELD, albedo)}
    return {name: {**kind, "id": name} for name, kind in kinds.items()}


def block(half: tuple[float, ...], inside: str, outside: str | None, at: tuple[float, ...] = (0, 0, 0)) -> dict[str, Any]:
    """A box of a medium in another one."""
    to_world = [{"type": "scale", "value": list(half)}, {"type": "translate", "value": list(at)}]
    exterior = {"exterior": {"type": "ref", "id": outside}} if outside else {}
    return {"type": "cube", "to_world": to_world, "bsdf": NULL, "interior": {"type": "ref", "id": inside}, **exterior}


def cavity(name: str, albedo: float, place: tuple[float, ...]) -> Scene:
    """A source in a void in a shield."""
    where = "source" if max(place) < SOURCE else "void" if max(place) < CAVITY else "shield"
    parts: dict[str, Any] = {"core": block(3 * (SOURCE,), "source", "void"), "cave": block(3 * (CAVITY,), "void", "shield"), "wall": block(3 * (WALL,), "shield", None)}
    return scene(name, **media(albedo), **parts, **around(place, where))


def duct(name: str, albedo: float, place: tuple[float, ...]) -> Scene:
    """A source in a shield, and a void as wide on either side of it, which reaches through the shield."""
    long = (DUCT[1] - SOURCE) / 2
    ducts = {f"duct{i}": block((SOURCE, long, SOURCE), "void", "shield", (0, side * (SOURCE + long), 0)) for i, side in enumerate((1, -1))}
    parts: dict[str, Any] = {"core": block(3 * (SOURCE,), "source", "shield"), **ducts, "wall": block(DUCT, "shield", None)}
    return scene(name, **media(albedo), **parts, **around(place, "void" if place[0] < SOURCE else "shield"))
