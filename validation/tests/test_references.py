"""Mitsuba's images in the repository: they are read as they were written, for their scene alone, and judge as new ones do."""

from pathlib import Path

import numpy as np
import pytest

from tyndall.failure import Failure
from tyndall.judging import Measured
from tyndall.scene import Scene, open_scene
from validation import compare, matrix, references
from validation.compare import Effort
from validation.places import CROSSCHECK

EFFORT = Effort(batches=8, spp=4)
SCENE = Scene({"type": "scene"}, "little")


def test_what_is_kept_is_what_was_measured(tmp_path: Path) -> None:
    measured = Measured.of(np.random.default_rng(1).uniform(0.5, 1, (8, 6, 8, 3)))
    references.keep(tmp_path / "kept.npz", measured)
    with np.load(tmp_path / "kept.npz") as kept:
        again = references.measured_of(kept, EFFORT)
    for name in references.PARTS:
        one, other = getattr(measured, name), getattr(again, name)
        assert np.allclose(one.mean, other.mean, rtol=1e-6) and np.allclose(one.variance, other.variance, rtol=1e-5)
        assert one.freedom == other.freedom


def test_an_image_of_another_scene_or_effort_or_of_none_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(references, "RECORDED", tmp_path)
    with pytest.raises(Failure, match="is not there"):
        references.read(SCENE, EFFORT, "scalar_rgb")
    measured = Measured.exactly(np.ones((6, 8, 3)))
    references.keep(tmp_path / "little.npz", measured, key=np.array(references.key_of(SCENE, EFFORT, "scalar_rgb")))
    assert (references.recorded(SCENE, EFFORT)(Effort()).pixels.mean == 1).all()
    for scene, effort, variant in ((Scene({"type": "other"}, "little"), EFFORT, "scalar_rgb"), (SCENE, Effort(), "scalar_rgb"), (SCENE, EFFORT, "scalar_spectral")):
        with pytest.raises(Failure, match="other files"):
            references.read(scene, effort, variant)


def test_an_extinction_that_is_off_by_a_twentieth_is_refused() -> None:
    scene = open_scene(CROSSCHECK / "fog_isotropic.json")
    reference = references.recorded(scene, matrix.RECORDED_EFFORT)
    for perturbation, passes in ((0, True), (0.05, False)):
        candidate = compare.candidate_renderer(compare.perturbed(scene, perturbation), "bdpt")
        assert compare.compare(scene, "bdpt", matrix.quick_effort("bdpt"), reference, candidate).passed == passes
