"""In what `models` measures."""

from validation.models import scenes, sun


def test_every_model_has_a_scene_of_its_own() -> None:
    sun()
    cases = list(scenes())
    assert len({case.name for case in cases}) == len(cases) > 90
