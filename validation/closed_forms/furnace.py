"""Furnaces: whatever absorbs nothing, under radiance 1 from everywhere, shows radiance 1 everywhere."""

from typing import Any

from tyndall.scene import Scene
from validation.closed_forms.case import ISOTROPIC, NULL, SKY, Case, camera, diffuse, medium, scene

FORWARD = {"type": "hg", "g": 0.8}
GLASS = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
WHITE = {"type": "twosided", "material": diffuse(1)}


def cases() -> list[Case]:
    """Media from thin to thick, and surfaces."""
    media = [
        Case(ball_of_medium(thickness, ISOTROPIC, NULL), 1, effort=min(1, 10 / thickness))
        for thickness in (0.01, 0.1, 1, 10, 100)
    ]
    return [
        *media,
        Case(ball_of_medium(10, FORWARD, NULL, "forward"), 1),
        Case(ball_of_medium(2, ISOTROPIC, GLASS, "in glass"), 1),
        Case(ball("white sphere", WHITE), 1),
        Case(ball("glass sphere", GLASS), 1),
        Case(ball("mirror sphere", {"type": "conductor", "material": "none"}), 1),
        Case(white_pit(), 1),
    ]


def view() -> dict:
    """The ball and a little of the sky around it."""
    return camera((0, 0, 5), (0, 0, 0), 25)


def ball(name: str, bsdf: dict, **more: Any) -> Scene:
    """A unit sphere under the sky."""
    return scene(f"furnace {name}", sensor=view(), sky=SKY, ball={"type": "sphere", "bsdf": bsdf, **more})


def ball_of_medium(thickness: float, phase: dict, bsdf: dict, name: str = "") -> Scene:
    """A ball of medium that absorbs nothing, of this optical diameter."""
    return ball(f"b {thickness:g} {name}".strip(), bsdf, interior=medium(thickness / 2, 1, phase))


def white_pit() -> Scene:
    """Deep interreflection: the inside of a box that is open towards the camera."""
    towards = [{"type": "translate", "value": [0, 0, -1]}]
    turned = {"back": ([0, 1, 0], 0), "left": ([0, 1, 0], 90), "right": ([0, 1, 0], -90)}
    turned |= {"below": ([1, 0, 0], -90), "above": ([1, 0, 0], 90)}
    sides: dict[str, Any] = {
        name: {
            "type": "rectangle",
            "to_world": [*towards, {"type": "rotate", "axis": axis, "angle": angle}],
            "bsdf": WHITE,
        }
        for name, (axis, angle) in turned.items()
    }
    return scene("furnace white pit", sensor=view(), sky=SKY, **sides)
