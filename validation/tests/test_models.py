"""What `models` measures, and in what."""

import numpy as np

from validation.models import SIZE, Row, Sampled, scenes, sun


def test_the_variance_is_that_of_a_sample() -> None:
    random = np.random.default_rng(1)
    images = lambda deviation: random.normal(1, deviation / 4, (16, SIZE[1], SIZE[0], 3))
    noisy, clean = (Sampled.of(images(deviation), [2.0, 3.0, 9.0], 16) for deviation in (2, 1))
    assert abs(noisy.variance - 4) < 0.1 and abs(noisy.seconds - 3 / 16 / SIZE[0] / SIZE[1]) < 1e-9
    row = Row("a", noisy, clean)
    assert abs(row.variance - 4) < 0.2 and row.times == 1 and abs(row.apart) < 4


def test_every_model_has_a_scene_of_its_own() -> None:
    sun()
    cases = list(scenes())
    assert len({case.name for case in cases}) == len(cases) > 90
