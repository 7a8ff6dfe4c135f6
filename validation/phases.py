"""The phase functions of scenes in numpy, written after their definitions, up to a factor: those of the angle that Mitsuba lacks.
Mitsuba gets them as tables of the cosine, `tabphase`, which it normalises over the sphere. Only `specular_sphere` has no table:
straight on it is steeper than any line."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import brentq

from tyndall.failure import Failure

ERROR = 1e-3
"""Largest relative error of a line between two values; where little is scattered, of the mean over all directions."""
FEWEST, MOST = 65, 2**20 + 1
"""Values in a table: odd numbers, as some functions have a kink at a right angle."""


def is_function(o: Any) -> bool:
    """True for an object that `value` knows. A `gaussian` is a reconstruction filter too, which has no gamma."""
    return isinstance(o, dict) and o.get("type") in FUNCTIONS and (o["type"] != "gaussian" or "gamma" in o)


def value(o: dict, cosine: np.ndarray) -> np.ndarray:
    """The phase function that `o` describes, up to a factor; a cosine of 1 is straight on."""
    return FUNCTIONS[o["type"]](o, cosine)


def tabulated(o: dict) -> dict:
    """The phase function as Mitsuba's table, of as many values as it needs."""
    count = FEWEST
    while error(o, count) > ERROR:
        if count == MOST:
            raise Failure(f"the phase function {o['type']} is too narrow for a table of {MOST} values", "make its lobe wider")
        count = 2 * count - 1
    values = value(o, np.linspace(-1, 1, count))
    return {"type": "tabphase", "values": ",".join(f"{v:.9g}" for v in values / values.mean())}


def error(o: dict, count: int) -> float:
    """The largest error of a table in the middle between two values."""
    steps = np.linspace(-1, 1, 2 * count - 1)
    values = value(o, steps)
    lines = (values[:-2:2] + values[2::2]) / 2
    return float(np.max(np.abs(lines - values[1::2]) / np.maximum(values[1::2], values.mean())))


def schlick(o: dict, cosine: np.ndarray) -> np.ndarray:
    """(1 - k^2) / (1 - k cos)^2"""
    return schlick_lobe(o.get("k", 0.0), cosine)


def schlick_lobe(k: float, cosine: np.ndarray) -> np.ndarray:
    """The same of a number; its mean over the sphere is 1."""
    return (1 - k * k) / (1 - k * cosine) ** 2


def henyey_greenstein(g: float, cosine: np.ndarray) -> np.ndarray:
    """(1 - g^2) / (1 + g^2 - 2 g cos)^1.5; its mean over the sphere is 1."""
    return (1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5


def two_terms(o: dict, cosine: np.ndarray) -> np.ndarray:
    """r lobe(g1) + (1 - r) lobe(g2)"""
    lobe = schlick_lobe if o["type"] == "two_term_schlick" else henyey_greenstein
    return o["r"] * lobe(o["g1"], cosine) + (1 - o["r"]) * lobe(o["g2"], cosine)


def cornette_shanks(o: dict, cosine: np.ndarray) -> np.ndarray:
    """Henyey and Greenstein's times 1 + cos^2; `u` is the mean cosine 3 g (4 + g^2) / (5 (2 + g^2))."""
    mean = lambda g: 3 * g * (4 + g * g) / (5 * (2 + g * g)) - o["u"]
    g = brentq(mean, -1, 1, xtol=1e-15) if "u" in o else o.get("g", 0.8)
    return henyey_greenstein(g, cosine) * (1 + cosine**2)


def linear(o: dict, cosine: np.ndarray) -> np.ndarray:
    """1 + g cos"""
    return 1 + o.get("g", 0.0) * cosine


def lobe_over_constant(m: float, n: float, cosine: np.ndarray) -> np.ndarray:
    """1 + m cos^n(theta / 2)"""
    return 1 + m * ((1 + cosine) / 2) ** (n / 2)


def murky(o: dict, cosine: np.ndarray) -> np.ndarray:
    """Nishita et al.'s or Blasi et al.'s."""
    return lobe_over_constant({"nishita": 50, "blasi": 33}[o.get("form", "nishita")], 64, cosine)


def reflecting(o: dict, cosine: np.ndarray) -> np.ndarray:
    """(1 - cos / 2)^2 + (cos - 1/2)^2"""
    return (1 - cosine / 2) ** 2 + (cosine - 0.5) ** 2


def sakas(o: dict, cosine: np.ndarray) -> np.ndarray:
    """1 + |cos|^n"""
    return 1 + np.abs(cosine) ** o["n"]


def gaussian(o: dict, cosine: np.ndarray) -> np.ndarray:
    """exp(-gamma theta^2)"""
    return np.exp(-o["gamma"] * np.arccos(cosine) ** 2)


def diffuse_sphere(o: dict, cosine: np.ndarray) -> np.ndarray:
    """sin(theta) - theta cos"""
    angle = np.arccos(cosine)
    return np.maximum(np.sin(angle) - angle * cosine, 0)


FUNCTIONS: dict[str, Callable[[dict, np.ndarray], np.ndarray]] = {
    "schlick": schlick,
    "two_term_schlick": two_terms,
    "two_term_hg": two_terms,
    "cornette_shanks": cornette_shanks,
    "linear": linear,
    "mie": lambda o, cosine: lobe_over_constant(o["m"], o["n"], cosine),
    "mie_hazy": lambda o, cosine: lobe_over_constant(9, 16, cosine),
    "mie_murky": murky,
    "mie_reflecting": reflecting,
    "sakas": sakas,
    "gaussian": gaussian,
    "diffuse_sphere": diffuse_sphere,
}
