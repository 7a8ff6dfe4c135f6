"""Small scenes for models."""

from validation import models


def test_every_model_has_a_scene_of_its_own() -> None:
    files = models.scenes()
    assert len(set(files)) == len(list(models.cases())) > 90 and all(file.is_file() for file in files)
