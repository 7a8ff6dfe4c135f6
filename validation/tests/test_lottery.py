"""Scenes by lot, and the judgement on them."""

from pathlib import Path

import numpy as np
import pytest

import tyndall
from tyndall.scene import Scene, scene_file
from validation import lottery, reach
from validation.lottery.scenes import drawn
from validation.reach import Reach
from tyndall.statistics import Ratio


@pytest.mark.parametrize("seed", range(3))
def test_every_scene_renders_and_is_the_same_again(seed: int, tmp_path: Path) -> None:
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
    again = [scene_file(Scene(drawn(seed).tree, "again"), folder) for folder in folders]
    assert again[0].read_text() == again[1].read_text()
    first = tyndall.run(again[0], spp=1, seed=1)
    assert first.image.shape == (24, 32, 3) and np.isfinite(first.image).all()
    alike, hit = (Reach.of(reach.plan(str(again[0]), *words.split())) for words in (lottery.ALIKE, "--strategies hit"))
    assert not alike.beyond(hit, False)


def test_attempts_and_seeds_differ() -> None:
    assert len({drawn(seed, attempt).words for seed in range(3) for attempt in range(3)}) == 9


def test_what_is_surely_worse_is_marked() -> None:
    row = lambda low, mean: lottery.Row(3, "a room", "alike", {"best": Ratio(low, mean, 2), "alike": Ratio(1, 1, 1)}, {}, ["pt: apart"], {})
    assert not row(1.1, 1.4).is_marked and row(1.3, 1.6).is_marked
    assert lottery.line(row(1.3, 1.6)) == "| 3 | a room | alike | 1.6 [1.3, 2] | does not reach all light | 1 [1, 1] | WORSE |\npt: apart"
    text = lottery.summary([row(1, 1), row(3, 4)])
    assert "2 scenes, 1 of them marked" in text and "over best: geometric mean 2.00, mean 2.50" in text and "over pt" not in text


def test_a_black_image_is_no_best() -> None:
    """However little time it took."""
    costs = {"alike": 0.3, "hit": 0.001, "pt": 0.5}
    assert lottery.cheapest(costs, {"hit": ["its mean differs"]}) == "alike"
    assert lottery.cheapest(costs, {}) == "hit"
