"""`tyndall.compare`: it tells what is the same from what is not."""

from dataclasses import replace

import numpy as np
import pytest

import tyndall
from tyndall import comparing, judging
from tyndall.failure import Failure
from validation.places import ROOT

FOG = ROOT / "scenes" / "crosscheck" / "fog_isotropic.json"


def test_mitsuba_and_tyndall_agree_on_fog_in_little_time() -> None:
    found = tyndall.compare(FOG, size=(16, 12), seconds=6, variant="scalar_rgb", progress=False)
    assert found.agrees and found.tyndall.shape == found.mitsuba.shape == found.scores.shape == (12, 16, 3)
    said = str(found)
    assert said.startswith("fog_isotropic, 16 x 12: Tyndall (bdpt) and Mitsuba agree.\n") and "would have been seen" in said
    assert found.seconds < 30 and min(found.samples) >= comparing.FEWEST
    # The same test refuses what is off by a tenth.
    random = np.random.default_rng(1)
    batches = np.asarray(found.mitsuba)[None] * (1 + 0.01 * random.standard_normal((8, 12, 16, 3)))
    worse = judging.judge("fog", "bdpt", judging.Measured.of(1.1 * batches), judging.Measured.of(batches), 1.0)
    assert not worse.passed and "differ so far" in str(replace(found, verdict=worse, samples=(9, 9)))
    assert "DISAGREE" in str(replace(found, verdict=worse, samples=(999, 999)))


def test_what_mitsuba_has_not_is_refused() -> None:
    fog = {"type": "heterogeneous", "sigma_t": {"type": "noise"}}
    box = {"type": "cube", "bsdf": {"type": "null"}, "interior": fog}
    scene = {"type": "scene", "box": box, "sky": {"type": "constant"}, "camera": {"type": "perspective"}}
    with pytest.raises(Failure, match="Mitsuba cannot load"):
        tyndall.compare(scene, size=(8, 8), variant="scalar_rgb")
