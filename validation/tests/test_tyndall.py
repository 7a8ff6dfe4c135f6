"""The program from Python: the binary renders what is small."""

import inspect
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, Unpack

import mitsuba as mi
import numpy as np
import pytest

import tyndall
from tyndall import arguments, display, program, rendering
from tyndall.failure import Failure
from tyndall.option_types import RenderOptions
from tyndall.scene import as_scene, open_scene
from tyndall.volume_file import vol
from validation.places import CROSSCHECK, ROOT, SCENES

SCENE = CROSSCHECK / "cube_in_room.json"
LAYERED = CROSSCHECK / "integrator_aov.json"


def test_options_are_those_of_the_command_line() -> None:
    given: dict[str, program.Option] = {"heuristic": "power", "forced_interaction": True, "quiet": False, "spp": 4, "error": None, "strategies": ["hit", "join"]}
    assert program.flags(given) == ["--heuristic=power", "--forced-interaction", "--spp=4", "--strategies=hit,join"]
    assert program.flags({"max_depth": -1}) == ["--max-depth=-1"]  # not an option called -1
    assert program.definitions(as_scene({}, {"res": 48, "on": True}).parameters) == ["-D", "res=48", "-D", "on=true"]


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
    layers = tyndall.render(LAYERED, spp=1).layers
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
    assert json.loads(tyndall.info(lampbox, json=True, integrator="pt"))["plan"]["integrator"] == "pt"


def test_dictionaries_of_mitsubas_types_are_rendered() -> None:
    mi.set_variant("scalar_rgb")
    box = mi.cornell_box()
    image = tyndall.render(box, spp=64, size=(16, 16), integrator="pt")
    box["sensor"]["film"].update(width=16, height=16)
    truth = np.array(mi.render(mi.load_dict(box), spp=256))
    assert image.mean(axis=(0, 1)) == pytest.approx(truth.mean(axis=(0, 1)), rel=0.06)  # noise: some 1.5 %


def test_failures_carry_the_programs_message() -> None:
    with pytest.raises(Failure, match="unicorn"):
        tyndall.render({"type": "scene", "thing": {"type": "unicorn"}})
    with pytest.raises(Failure, match="no such scene"):
        tyndall.render("nowhere.json")
    with pytest.raises(Failure, match="is no scene"):
        tyndall.render(7)  # type: ignore[arg-type]
    with pytest.raises(Failure, match="not finite"):
        tyndall.render({"type": "scene", "ball": {"type": "sphere", "radius": float("nan")}})


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"max_dept": 3}, "did you mean max_depth"),
        ({"no_such_option": 3}, "there is no option no_such_option"),
        ({"parameter": {}}, "did you mean parameters"),
        ({"size": 64}, r"give size=\(64, 64\)"),
        ({"size": (64, 0)}, "from 1 to 65536"),
        ({"size": (64.5, 3)}, r"expected \(width, height\)"),
        ({"frames": "0..3"}, "for frame in range"),
        ({"spp": -3}, "invalid value '-3' for spp: expected a whole number"),
        ({"spp": True}, "a value is required for spp"),
        ({"integrator": "bdp"}, "a similar value exists: 'bdpt'"),
        ({"strategies": ["hit", "jion"]}, "'join'"),
        ({"batches": 4, "error": 0.1}, "the argument batches cannot be used with error"),
        ({"output": "fog.exr"}, r"\.save"),
        ({"report": "fog.json"}, r"\.report"),
    ],
)
def test_options_are_checked_before_anything_runs(options: dict[str, Any], said: str) -> None:
    with pytest.raises(Failure, match=said):
        tyndall.render(UNREADABLE, **options)


UNREADABLE = {"type": "scene", "thing": {"type": "unicorn"}}
"""What is found wrong with the options is found before this."""


def test_the_programs_help_names_the_options() -> None:
    names = arguments.names()
    assert {"spp", "max_depth", "forced_interaction", "sums", "checkpoint", "sums_every", "tev", "crop", "size"} <= set(names)
    assert re.search(r"^max_depth <N> +Maximum number", tyndall.options(), re.MULTILINE) and "\nreport" not in tyndall.options()
    assert len(tyndall.options().splitlines()) > 20 and "--" not in tyndall.options()
    assert "contender" in arguments.names("study")
    assert arguments.words({"contender": {"a": "--spp 1", "b": ""}, "vary": ["integrator=pt,lt", "spp=1"], "reference": ["a.exr", "b.exr"]}, "study") == [
        "--contender=a: --spp 1",
        "--contender=b: ",
        "--vary=integrator=pt,lt",
        "--vary=spp=1",
        "--reference=a.exr",
        "--reference=b.exr",
    ]


def test_messages_name_no_file_that_is_gone() -> None:
    def refused(scene: Any) -> str:
        with pytest.raises(Failure) as found:
            tyndall.render(scene)
        assert "/tmp" not in str(found.value) and "remedy: " in str(found.value)
        return str(found.value)

    assert refused(UNREADABLE).startswith("the scene $.thing: expected the type of a plugin")
    smoke = {"type": "heterogeneous", "sigma_t": {"type": "gridvolume", "data": -np.ones((2, 2, 2))}}
    scene = {"type": "scene", "camera": {"type": "perspective"}, "cloud": {"type": "cube", "interior": smoke}}
    assert refused(scene).startswith("$.cloud.interior.sigma_t.data: expected voxels")


def test_renders_of_dictionaries_go_on(tmp_path: Path) -> None:
    voxels = np.random.default_rng(1).uniform(0, 1, (4, 4, 4))
    smoke = {"type": "heterogeneous", "sigma_t": {"type": "gridvolume", "data": voxels}}
    cube = {"type": "cube", "bsdf": {"type": "null"}, "interior": smoke}
    sensor = {"type": "perspective", "to_world": [{"type": "translate", "value": [0.5, 0.5, -4]}]}
    scene = {"type": "scene", "sensor": sensor, "sky": {"type": "constant"}, "cloud": cube}
    options: dict[str, Any] = {"size": (8, 8), "sums": tmp_path / "cloud.sums"}
    tyndall.render(scene, spp=2, **options)
    assert (tyndall.render(scene, spp=4, resume=True, **options) == tyndall.render(scene, spp=4, size=(8, 8))).all()


def test_one_frame_is_a_picture() -> None:
    image = tyndall.render(CROSSCHECK / "function_wind.json", spp=1, size=(8, 8), frames=3)
    assert image.shape == (8, 8, 3) and image.report["frame"] == 3


def test_numbers_that_are_none_are_refused() -> None:
    image = np.ones((2, 3, 3))
    image[1, 2, 0] = np.inf
    with pytest.raises(Failure, match=r"pixel \(2, 1\), channel 0"):
        rendering.finite(image)


def test_a_program_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TYNDALL_BINARY", "/nowhere/tyndall")
    with pytest.raises(Failure, match="no such program"):
        tyndall.render(SCENE)


def test_nothing_but_numpy_and_openexr_is_imported() -> None:
    heavy = "mitsuba", "drjit", "scipy", "jinja2"
    code = f"import sys; import tyndall; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_other_files_are_no_scenes() -> None:
    with pytest.raises(Failure, match="neither .json nor .xml"):
        tyndall.render(Path(__file__))


def test_the_manuals_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(SCENES)
    found = re.search(r"```python\n(.*?)```", (SCENES / "manual" / "python.md").read_text(), re.DOTALL)
    assert found
    code = found[1]
    for slow, quick in (("spp=64", "spp=1"), ("time_limit=10", "spp=1")):
        assert slow in code
        code = code.replace(slow, quick)
    names: dict[str, Any] = {}
    exec(code, names)
    assert names["image"].shape == (240, 320, 3) and names["image"].dtype == np.float64
    assert names["cloud"].shape == (120, 160, 3) and (tmp_path / "foggy_room.exr").is_file()


def test_types_of_options_are_those_of_the_program() -> None:
    known = {*arguments.names()} - {*arguments.OTHERWISE, "progress"}
    assert set(RenderOptions.__annotations__) == known
    read = inspect.signature(tyndall.render).parameters["options"].annotation
    assert read == Unpack[RenderOptions]


def test_a_volume_file_is_rendered_without_a_scene(tmp_path: Path) -> None:
    voxels = np.zeros((6, 6, 6), np.float32)
    voxels[1:5, 1:5, 1:5] = 1
    path = tmp_path / "puff.vol"
    path.write_bytes(vol(voxels))
    image = tyndall.render(path, size=(12, 12), spp=2)
    bare = tyndall.render(path, size=(12, 12), spp=2, parameters={"density_scale": 0})
    assert image.shape == (12, 12, 3) and np.abs(image - bare).max() > 0.1
    assert tyndall.load(path)["smoke"]["filename"] == str(path)
