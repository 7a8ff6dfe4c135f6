"""The scenes and the verdicts of `python3 -m validation growth`."""

from typing import Any

import numpy as np
import pytest

import tyndall
from validation import growth


def test_balls_are_closed() -> None:
    faces = np.frombuffer(growth.ball(7).split(b"end_header\n")[1][8 * 8 * 12 :], dtype=[("count", "u1"), ("corners", "<i4", 3)])
    assert len(faces) == 2 * 7 * 7
    assert (faces["count"] == 3).all() and faces["corners"].min() == 0 and faces["corners"].max() == 8 * 8 - 1


@pytest.mark.parametrize("scene", [growth.white_room(), growth.box_of_fog({"ball": {"type": "sphere", "radius": 0.5}})])
def test_scenes_render(scene: dict[str, Any]) -> None:
    assert tyndall.run(scene, spp=1, size=(8, 8)).image.mean() > 0


def test_growth_beyond_the_bound_fails() -> None:
    assert growth.Curve("x", "y", [(1, 10.0), (8, 11.0)], most=1.1).holds
    assert not growth.Curve("x", "y", [(1, 10.0), (8, 11.1)], most=1.1).holds
