"""Walks of 10 000 vertices."""

from tyndall.scene import Scene
from validation.closed_forms.case import NULL, camera, diffuse, scene
from validation.closed_forms.furnace import ball_of_medium
from validation.stability.case import Case, lamp, named

ROW = "walks of 10 000 vertices"
LOSS = 1e-4
"""Of light at each reflection: walks have 10 000 vertices in the mean."""
THICK = 1.5e4
"""A ball of this optical diameter: light that crosses it anyhow collides 2/3 so often in the mean."""


def cases() -> list[Case]:
    """A ball that loses nothing, and rooms that all but lose nothing."""
    furnace = named(ball_of_medium(THICK, {"type": "isotropic"}, NULL), "long walks in a medium")
    return [
        Case(ROW, f"white ball under the sky, b {THICK:g}", furnace, 1, ("pt/hit", "pt", "bdpt"), "furnace"),
        Case(ROW, "hollow sphere that shines and reflects 0.9999", hollow(), 1, ("pt", "lt"), "E / (1 - albedo)"),
    ]


def hollow() -> Scene:
    """Every point emits what it absorbs of radiance 1, and is seen from inside."""
    wall = {"type": "sphere", "flip_normals": True, "bsdf": diffuse(1 - LOSS), "emitter": lamp(LOSS)}
    return scene("hollow sphere", sensor=camera((0.2, 0.1, 0.5), (0, 0, 0), 60), wall=wall)
