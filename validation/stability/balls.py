"""Balls of radius 1 under parallel rays: the mean over the disc that is seen, by the integral equation of the sphere. A ball that
gains a radiance of 1 a metre shows 4/3 of the chance that a photon born in it escapes; one that absorbs nothing shows 4/3, the mean
chord, however it scatters. The same balls in a white furnace show what is left of 1 (Kirchhoff)."""

import math

from tyndall.scene import Scene
from validation.closed_forms.case import orthographic, scene
from validation.stability.case import ALL, Case, ball, fog, mean, oven, parallel

ROW = "balls by the integral equation of the sphere"
SHOWN = ((1.0, 0.0, 0.703003), (1.0, 0.5, 0.915486), (1.0, 0.9, 1.21994), (5.0, 0.9, 0.753031), (10.0, 0.9, 0.453714), (10.0, 0.999, 1.298339))
"""Optical radius, albedo, and the mean of the disc."""
WHITE = ((1e-3, 0.0), (1.0, 0.9), (1.0, -0.9), (30.0, 0.0), (300.0, 0.0), (500.0, 0.9))
"""Optical radius and mean cosine, of those that absorb nothing."""
DISC = math.pi / 4
"""Of the square that it touches."""
DEEP = 100
"""From this optical radius on, light that starts inside takes too many steps to get out, in the square of the radius."""


def cases() -> list[Case]:
    """Those that shine, and the same in a furnace."""
    found = [shining(tau, albedo, 0, shown) for tau, albedo, shown in SHOWN]
    found += [shining(tau, 1, g, 4 / 3) for tau, g in WHITE]
    return found + [heated(tau, albedo, 1 - (1 - albedo) * tau * shown) for tau, albedo, shown in SHOWN if albedo >= 0.9]


def shining(tau: float, albedo: float, g: float, shown: float) -> Case:
    """Before black."""
    there = scene(f"ball {tau:g} {albedo:g} {g:g}", sensor=parallel(1), ball=ball({**fog(tau, albedo, g), "emission": 1.0}))
    told = f", g {g:g}" if g else ""
    return case(f"ball that shines, tau {tau:g}, albedo {albedo:g}{told}", there, DISC * shown, ("pt",) if tau >= DEEP else ALL)


def heated(tau: float, albedo: float, shown: float) -> Case:
    """In an oven of radiance 1, which is seen around it."""
    name = f"heated ball {tau:g} {albedo:g}"
    there = Scene({**oven(name, ball=ball(fog(tau, albedo))).tree(), "sensor": orthographic((0, 0, 2.5), (0, 0, 0), 1)}, name)
    return case(f"ball in a white furnace, tau {tau:g}, albedo {albedo:g}", there, DISC * shown + 1 - DISC, ALL)


def case(name: str, there: Scene, shown: float, methods: tuple[str, ...]) -> Case:
    """Its whole square is judged as one."""
    return Case(ROW, name, there, shown, methods, "integral equation", seen=mean)
