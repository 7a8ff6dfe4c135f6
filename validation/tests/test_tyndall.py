"""The program from Python: the binary renders what is small."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
import pytest

from validation import tyndall
from validation.failure import Failure
from validation.places import CROSSCHECK, ROOT, SCENES
from validation.scene import open_scene

SCENE = CROSSCHECK / "cube_in_room.json"
LAYERED = CROSSCHECK / "integrator_aov.json"


def test_options_are_those_of_the_command_line() -> None:
    given: dict[str, tyndall.Option] = {"heuristic": "power", "forced_interaction": True, "quiet": False, "spp": 4, "error": None, "strategies": ["hit", "join"]}
    assert tyndall.flags(given) == ["--heuristic=power", "--forced-interaction", "--spp=4", "--strategies=hit,join"]
    assert tyndall.flags({"max_depth": -1}) == ["--max-depth=-1"]  # not an option called -1
    assert tyndall.definitions(tyndall.as_scene({}, {"res": 48, "on": True}).parameters) == ["-D", "res=48", "-D", "on=true"]


def test_an_image_is_an_array_that_the_seed_decides() -> None:
    image = tyndall.render(SCENE, spp=2, size=(12, 8), integrator="pt", max_depth=3, strategies=["hit", "next-event"])
    assert image.shape == (8, 12, 3) and image.dtype == np.float64 and image.mean() > 0
    again = tyndall.render(str(SCENE), spp=2, size=(12, 8), integrator="pt", max_depth=3, strategies="hit,next-event", threads=1)
    assert (again == image).all()
    other = tyndall.render(SCENE, spp=2, size=(12, 8), integrator="pt", max_depth=3, strategies="hit,next-event", seed=1)
    assert (other != image).any()


def test_a_file_a_scene_and_a_dictionary_give_the_same_image(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CROSSCHECK)  # where file names in a dictionary start
    scenes: list[Any] = [SCENE, str(SCENE), open_scene(SCENE), json.loads(SCENE.read_text())]
    first, *others = [tyndall.render(scene, spp=1, size=(8, 8)) for scene in scenes]
    assert all((first == other).all() for other in others)


def test_layers_come_by_name() -> None:
    layers = tyndall.render(LAYERED, spp=1, layers=True)
    done = tyndall.run(LAYERED, spp=1)
    assert {"<root>", "nested", "normal", "place", "depth"} == layers.keys() == done.layers.keys()
    assert layers["normal"].shape == (*layers["depth"].shape, 3) and layers["normal"].dtype == np.float32
    assert (layers["<root>"] == done.image).all()
    assert done.samples_per_pixel == 1 and done.render_seconds > 0 and "load_seconds" in done.report


def test_batches_are_the_images_of_their_seeds() -> None:
    options: dict[str, Any] = {"spp": 1, "size": (8, 6), "integrator": "lt"}
    batches = tyndall.render_batches(SCENE, 3, seed=5, **options)
    assert (batches == np.stack([tyndall.render(SCENE, seed=seed, **options) for seed in (5, 6, 7)])).all()
    done = tyndall.run(SCENE, batches=3, seed=5, **options)
    assert np.allclose(done.image, batches.mean(axis=0), rtol=1e-3) and done.samples_per_pixel == 3
    error = batches.std(axis=0, ddof=1) / np.sqrt(3)
    assert np.allclose(done.layers["standard_error"], error, rtol=2e-3, atol=1e-6)


def test_parameters_and_info() -> None:
    lampbox = SCENES / "lampbox_up.xml"
    assert tyndall.render(lampbox, spp=1, parameters={"res": 6}).shape == (6, 6, 3)
    assert "6 x 6" in tyndall.info(lampbox, parameters={"res": 6})


def test_dictionaries_of_mitsubas_types_are_rendered() -> None:
    mi.set_variant("scalar_rgb")
    box = mi.cornell_box()
    image = tyndall.render(box, spp=64, size=(16, 16), integrator="pt")
    box["sensor"]["film"].update(width=16, height=16)
    truth = np.array(mi.render(mi.load_dict(box), spp=256))
    assert image.mean(axis=(0, 1)) == pytest.approx(truth.mean(axis=(0, 1)), rel=0.06)  # noise: some 1.5 %


def test_failures_carry_the_programs_message() -> None:
    with pytest.raises(Failure, match="no-such-option"):
        tyndall.render(SCENE, no_such_option=3)
    with pytest.raises(Failure, match="unicorn"):
        tyndall.render({"type": "scene", "thing": {"type": "unicorn"}})
    with pytest.raises(Failure, match="no such scene"):
        tyndall.render("nowhere.json")
    with pytest.raises(Failure, match="is no scene"):
        tyndall.render(7)  # type: ignore[call-overload]
    with pytest.raises(Failure, match="not finite"):
        tyndall.render({"type": "scene", "ball": {"type": "sphere", "radius": float("nan")}})
    with pytest.raises(Failure, match="none was written"):
        tyndall.render(SCENE, spp=1, size=(4, 4), frames="0..1")


def test_numbers_that_are_none_are_refused() -> None:
    image = np.ones((2, 3, 3))
    image[1, 2, 0] = np.inf
    with pytest.raises(Failure, match=r"pixel \(2, 1\), channel 0"):
        tyndall.finite(image)


def test_a_program_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TYNDALL_BINARY", "/nowhere/tyndall")
    with pytest.raises(Failure, match="no such program"):
        tyndall.render(SCENE)


def test_nothing_but_numpy_and_openexr_is_imported() -> None:
    heavy = "mitsuba", "drjit", "scipy", "jinja2"
    code = f"import sys; from validation import tyndall; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_other_files_are_no_scenes() -> None:
    with pytest.raises(Failure, match="neither .json nor .xml"):
        tyndall.render(Path(__file__))


def test_the_readmes_example_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    found = re.search(r"```python\n(.*?)```", (ROOT / "validation" / "README.md").read_text(), re.DOTALL)
    assert found
    code = found[1]
    for slow, quick in (("spp=64", "spp=1"), ("time_limit=10", "spp=1")):
        assert slow in code
        code = code.replace(slow, quick)
    names: dict[str, Any] = {}
    exec(code, names)
    assert names["image"].shape == (240, 320, 3) and names["image"].dtype == np.float64
    assert names["done"].image.shape == (120, 160, 3)
