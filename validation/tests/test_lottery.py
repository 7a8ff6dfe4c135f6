"""Scenes by lot, and the judgement on them."""

from pathlib import Path

import numpy as np
import pytest

from tyndall.scene import Scene, scene_file
from validation import lottery
from validation.guide import Gain
from validation.lottery.judge import Cost, Reference, Shot, shot
from validation.lottery.scenes import drawn


@pytest.mark.parametrize("seed", range(3))
def test_every_scene_renders_and_is_the_same_again(seed: int, tmp_path: Path) -> None:
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
    again = [scene_file(Scene(drawn(seed).tree, "again"), folder) for folder in folders]
    assert again[0].read_text() == again[1].read_text()
    first = shot(again[0], lottery.OURS, 1, 1)
    assert first.image.shape == (24, 32, 3) and np.isfinite(first.image).all() and first.seconds >= 0


def test_attempts_and_seeds_differ() -> None:
    assert len({drawn(seed, attempt).words for seed in range(3) for attempt in range(3)}) == 9


def shots(truth: np.ndarray, noise: float, seed: int) -> list[Shot]:
    """Eight images with so much noise."""
    random = np.random.default_rng(seed)
    return [Shot(truth + random.normal(0, noise, truth.shape), 1, {}, []) for _ in range(8)]


TRUTH = np.ones((24, 32, 3))


def test_noise_of_the_reference_is_no_error() -> None:
    reference = Reference.of(shots(TRUTH, 0.1, 1))
    images = np.array([one.image for one in shots(TRUTH, 0.2, 2)])
    assert reference.relmse(images) == pytest.approx([0.04 / 1.01] * 8, rel=0.1)
    assert reference.relmse(np.array([TRUTH, TRUTH])) == pytest.approx([0, 0])


def test_another_image_is_seen() -> None:
    reference = Reference.of(shots(TRUTH, 0.1, 1))
    assert reference.score(shots(TRUTH, 0.1, 2)) < 1 < reference.score(shots(1.02 * TRUTH, 0.1, 2))


def test_what_is_surely_worse_is_marked() -> None:
    assert Cost([2, 3]).over(Cost([1, 1])).ratio == pytest.approx(2.5)
    row = lambda ratio, error: lottery.Row(3, "a room", "alike", {"best": Gain(ratio, error), "alike": Gain(1, 0)}, {}, {})
    assert not row(1.4, 0.1).is_marked and row(1.6, 0.1).is_marked
    assert lottery.line(row(1.6, 0.1)) == "| 3 | a room | alike | 1.60 ± 0.16 | does not reach all light | 1.00 ± 0.00 | WORSE |"
    text = lottery.summary([row(1, 0), row(4, 0)])
    assert "2 scenes, 1 of them marked" in text and "over best: geometric mean 2.00, mean 2.50" in text and "over pt" not in text
