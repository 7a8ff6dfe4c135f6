"""Budgets from pilots, and what a study asks of a scene."""

import json
from pathlib import Path

import pytest

from validation import cli, mitsuba
from validation.failure import Failure
from validation.places import CROSSCHECK, SCENES
from validation.scene import Scene, open_scene
from validation.study import plan, rivals, scenes, tree
from validation.study.plan import Pilot


def test_budgets_double_up_to_the_time_there_is() -> None:
    assert plan.budgets(rate=100, top=1.6, points=5) == [10, 20, 40, 80, 160]
    assert plan.budgets(rate=4, top=2, points=5) == [1, 2, 4, 8]  # half a sample is none
    assert plan.budgets(rate=0.01, top=1, points=5) == [1]
    for rate in (0.3, 1, 7, 1000):
        found = plan.budgets(rate, 1.0, 4)
        assert all(b == 2 * a for a, b in zip(found, found[1:])) and found[0] >= 1
        assert rate < 1 or found[-1] <= 1.5 * rate


def test_all_renders_together_take_the_contenders_part_of_the_time() -> None:
    top = plan.top_seconds(100, contenders=3, seeds=8, points=4)
    assert 3 * 8 * top * (1 + 1 / 2 + 1 / 4 + 1 / 8) == pytest.approx(plan.CONTENDERS_PART * 100)


def test_the_reference_is_made_by_the_most_robust() -> None:
    pilots = {
        "tyndall pt": Pilot(10, 0.001),
        "tyndall bdpt": Pilot(4, 0.5),
        "mitsuba volpathmis a": Pilot(20, 0.3),
        "mitsuba volpathmis b": Pilot(5, 0.2),
        "mitsuba volpath b": Pilot(9, 0.1),
    }
    found = plan.reference_samples(pilots, 640)
    each = plan.REFERENCE_PART * 640 / (2 * plan.REFERENCE_BATCHES)
    assert found == {"tyndall bdpt": round(4 * each), "mitsuba volpathmis b": round(5 * each)}
    assert plan.reference_samples({"tyndall lt": Pilot(1, 1)}, 1e-6) == {"tyndall lt": 1}


@pytest.mark.parametrize(
    ("path", "applies"),
    [
        (CROSSCHECK / "grid_sparse.json", True),
        (SCENES / "lampbox_up.xml", False),  # the lens is in fog, which XML refers to
        (CROSSCHECK / "camera_inside_cube.json", False),
        (CROSSCHECK / "glass_ball_of_fog.json", False),
        (CROSSCHECK / "mirror_in_fog.json", False),
    ],
)
def test_light_tracing_is_asked_where_it_can_render(path: Path, applies: bool) -> None:
    assert tree.light_tracing_applies(tree.tree(open_scene(path))) == applies


def test_mitsubas_integrators_have_the_depths_of_the_scenes_own() -> None:
    lampbox = tree.tree(open_scene(SCENES / "lampbox_up.xml", {"res": "7"}))
    assert tree.path_integrator(lampbox, "volpathmis") == {"type": "volpathmis", "max_depth": 17, "rr_depth": 1000}
    assert lampbox["sensor"]["film"]["width"] == 7
    ours = {"type": "scene", "integrator": {"type": "bdpt", "max_depth": 5}}
    assert tree.path_integrator(ours, "volpath") == {"type": "volpath", "max_depth": 5, "rr_depth": mitsuba.ROULETTE[False]}
    theirs = {"type": "scene", "i": {"type": "aov", "nested": {"type": "path", "hide_emitters": True}}}
    assert tree.path_integrator(theirs, "volpath") == {"type": "volpath", "hide_emitters": True}


def test_the_standing_scenes_are_six_that_mitsuba_loads() -> None:
    subjects = scenes.standing()
    assert len({subject.scene.name for subject in subjects}) == 6
    for subject in subjects:
        assert mitsuba.load(subject.scene, "scalar_rgb", subject.size) is not None


def test_what_mitsuba_cannot_load_is_told() -> None:
    scene = Scene({"type": "scene", "thing": {"type": "unicorn"}}, "fable")
    with pytest.raises(Failure, match="Mitsuba cannot load fable .*unicorn"):
        mitsuba.load(scene)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ("--seeds 1", "--seeds is below 2"),
        ("--seeds 151", "too great"),
        ("--points 0", "--points is 0"),
        ("--minutes nan", "--minutes is nan"),
        ("--minutes inf", "--minutes is inf"),
        ("--size 8x8", "belong to scenes"),
        ("-D res=8", "belong to scenes"),
        ("--reference a.exr", "belongs to one scene"),
        ("a.json --reference nowhere.exr", "no such reference"),
        ("a.json b/a.json", "one name"),
        ("a.json", "no such scene"),
        ("--contenders pt,bdpt,pt", "names pt more than once"),
    ],
)
def test_what_makes_no_sense_is_refused(arguments: str, complaint: str, tmp_path: Path) -> None:
    with pytest.raises(Failure, match=complaint):
        cli.main(["convergence", *arguments.split(), "--output", str(tmp_path)])
    assert not list(tmp_path.iterdir())


def test_mitsuba_renders_by_another_integrator_than_the_scenes_own() -> None:
    whole = json.loads((CROSSCHECK / "cube_in_room.json").read_text())
    rival = rivals.rival(Scene(whole, "cube", base=CROSSCHECK), "volpath:scalar_rgb", (4, 3), 2)
    image, seconds = rival.render(1, 1)
    assert image.shape == (3, 4, 3) and seconds > 0 and rival.load_seconds is not None
