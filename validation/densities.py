"""The density functions of scenes as numpy sees them, written after their definitions: what Tyndall's are held to."""

from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np

from tyndall import load_dict
from tyndall.failure import Failure

FAR_BELOW = 60.0
"""Scale heights below which `exponential` grows no further."""


def is_function(o: Any) -> bool:
    """True for an object that `value` knows."""
    return isinstance(o, dict) and o.get("type") in {**FUNCTIONS, **COMBINATIONS}


def value(o: dict, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """The volume that `o` describes at world points (..., 3): (..., 1) or, of a coloured one, (..., 3). Of combinations
    only the parts have a place and a factor."""
    return COMBINATIONS[o["type"]](o, points, time) if o["type"] in COMBINATIONS else placed(o, points)


def placed(o: dict, points: np.ndarray) -> np.ndarray:
    """A function with its place, its factor and its box."""
    if o["type"] == "constvolume":
        return factor(o.get("value", 1.0))
    if o["type"] not in FUNCTIONS:
        raise Failure(f"{o['type']} in a density: found no such function in numpy", "name a scene without it, or contenders without Mitsuba")
    own = to_own(o, points)
    shape = FUNCTIONS[o["type"]](o, own)
    bounds = [np.asarray(o.get(name, [limit] * 3)) for name, limit in (("min", -np.inf), ("max", np.inf))]
    inside = np.all((own >= bounds[0]) & (own <= bounds[1]), axis=-1, keepdims=True)
    return factor(o.get("value", 1.0)) * np.where(inside, shape, 0.0)


def factor(given: Any) -> np.ndarray:
    """A number or a colour."""
    return np.atleast_1d(np.asarray(given["value"] if isinstance(given, dict) else given, dtype=float))


def to_own(o: dict, points: np.ndarray) -> np.ndarray:
    """World points in the function's own coordinates."""
    if "to_world" not in o:
        return points
    matrix = np.linalg.inv(np.array(load_dict.transform(o["to_world"]).matrix, dtype=float))
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def children(o: dict) -> list[dict]:
    """The nested objects, but for transforms and colours."""
    return [child for child in o.values() if isinstance(child, dict) and child.get("type") not in (None, "rgb", "ref")]


def cosine(o: dict, x: np.ndarray) -> np.ndarray:
    """c_0 + sum c_i cos(k_i . x + phi_i)"""
    waves = (w.get("amplitude", 1.0) * np.cos(x @ np.asarray(w["vector"], float) + w.get("phase", 0.0)) for w in children(o))
    return (o.get("constant", 1.0) + sum(waves))[..., None]


def exponential(o: dict, x: np.ndarray) -> np.ndarray:
    """exp(-(up . x - height) / scale_height)"""
    up = np.asarray(o.get("up", [0, 1, 0]), float)
    along = x @ (up / np.linalg.norm(up))
    return np.exp(np.minimum((o.get("height", 0.0) - along) / o.get("scale_height", 1.0), FAR_BELOW))[..., None]


def polynomial(o: dict, x: np.ndarray) -> np.ndarray:
    """Polynomials of the coordinates on the box [-C, C], repeated in space or 0 outside."""
    half, repeats = o.get("half_width", 1.0), o.get("wrap", "repeat") == "repeat"
    local = x - 2 * half * np.round(x / (2 * half)) if repeats else x
    lists = [[float(c) for c in o.get(axis, "0").replace(",", " ").split()] for axis in "xyz"]
    total = sum(np.polynomial.polynomial.polyval(local[..., i], coefficients) for i, coefficients in enumerate(lists))
    terms = [(t.get("coefficient", 1.0), np.asarray(t["powers"])) for t in children(o)]
    total = total + sum(c * np.prod(local**powers, axis=-1) for c, powers in terms)
    mixes = np.any(np.array([[False] * 3, *(powers > 0 for _, powers in terms)]), axis=0)
    depends = mixes | [len(one) > 1 for one in lists]
    within = repeats | (np.abs(x) <= half) | ~depends
    return np.where(within.all(axis=-1), total, 0.0)[..., None]


def equipotential(o: dict, x: np.ndarray) -> np.ndarray:
    """strength / (c + d r^2)"""
    squared = {"point": around, "line": beside, "segment": beside, "sphere": outside}[o.get("shape", "point")](o, x)
    return (o.get("strength", 1.0) / (o.get("c", 1.0) + o.get("d", 1.0) * squared))[..., None]


def around(o: dict, x: np.ndarray) -> np.ndarray:
    """Squared distance to a point."""
    return ((x - np.asarray(o.get("center", [0, 0, 0]), float)) ** 2).sum(axis=-1)


def beside(o: dict, x: np.ndarray) -> np.ndarray:
    """Squared distance to a line or a segment."""
    start, end = np.asarray(o["p0"], float), np.asarray(o["p1"], float)
    along = (x - start) @ (end - start) / ((end - start) ** 2).sum()
    held = np.clip(along, 0, 1) if o["shape"] == "segment" else along
    return ((x - start - held[..., None] * (end - start)) ** 2).sum(axis=-1)


def outside(o: dict, x: np.ndarray) -> np.ndarray:
    """Square of the tangent's length to a sphere; 0 within."""
    return np.maximum(around(o, x) - o.get("radius", 1.0) ** 2, 0.0)


def added(o: dict, x: np.ndarray, time: float) -> np.ndarray:
    """The sum of the nested volumes."""
    return sum((value(child, x, time) for child in children(o)), np.zeros(1))


def multiplied(o: dict, x: np.ndarray, time: float) -> np.ndarray:
    """The product of the nested volumes."""
    return reduce(np.multiply, (value(child, x, time) for child in children(o)))


def blown(o: dict, x: np.ndarray, time: float) -> np.ndarray:
    """The nested volume, drifted."""
    [inner] = children(o)
    return value(inner, x - time * np.asarray(o["velocity"], float), time)


FUNCTIONS: dict[str, Callable[[dict, np.ndarray], np.ndarray]] = {
    "cosine": cosine,
    "polynomial": polynomial,
    "equipotential": equipotential,
    "exponential": exponential,
}
COMBINATIONS: dict[str, Callable[[dict, np.ndarray, float], np.ndarray]] = {
    "sum": added,
    "product": multiplied,
    "wind": blown,
}
