"""Mitsuba as a contender: what it renders, its protocol, and the studies that it takes part in."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tyndall import exr, load_dict, program
from tyndall.failure import Failure
from tyndall.scene import Scene, load, open_scene
from validation import contender, mitsuba, studies
from validation.places import CROSSCHECK, ROOT, SCENES
from validation.studies import Effort

ROOM = CROSSCHECK / "cube_in_room.json"


def rendered(folder: Path, *more: str) -> subprocess.CompletedProcess[str]:
    """The program as a study runs it."""
    options = ["--seed", "18446744073709551615", "--spp", "2,4", "--folder", str(folder), "--size", "4x3", *more]
    return subprocess.run([sys.executable, "-m", "validation.contender", *options], cwd=ROOT, capture_output=True, text=True)


def test_it_renders_growing_numbers_of_samples_and_reports_each(tmp_path: Path) -> None:
    done = rendered(tmp_path, str(ROOM), "--variant", "scalar_rgb", "--integrator", "volpathmis")
    assert done.returncode == 0, done.stderr
    first, last = map(json.loads, done.stdout.splitlines())
    assert (first["spp"], last["spp"]) == (2, 4) and 0 < first["seconds"] < last["seconds"] and first["load_seconds"] > 0
    images = [exr.read_image(tmp_path / f"{spp}.exr") for spp in (2, 4)]
    assert images[0].shape == (3, 4, 3) and (images[0] != images[1]).any() and np.isfinite(images).all()


def test_it_says_why_it_cannot(tmp_path: Path) -> None:
    scene = tmp_path / "fable.json"
    scene.write_text(json.dumps({"type": "scene", "thing": {"type": "unicorn"}}))
    done = rendered(tmp_path, str(scene), "--variant", "scalar_rgb")
    assert done.returncode != 0 and "unicorn" in done.stderr.strip().splitlines()[-1]


def test_no_two_passes_share_random_numbers() -> None:
    seeds = [contender.seed_of(seed, number) for seed in (0, 1, 2**63, 2**64 - 1) for number in range(100)]
    assert len(set(seeds)) == len(seeds) and max(seeds) < 2**32


def test_mitsubas_integrators_have_the_depths_of_the_scenes_own() -> None:
    lampbox = load(open_scene(SCENES / "lampbox_up.xml", {"res": "7"}))
    assert contender.integrator_like(lampbox, "volpathmis") == {"type": "volpathmis", "max_depth": 17, "rr_depth": 1000}
    assert lampbox["sensor"]["film"]["width"] == 7
    ours = {"type": "scene", "integrator": {"type": "bdpt", "max_depth": 5}}
    assert contender.integrator_like(ours, "volpath") == {"type": "volpath", "max_depth": 5, "rr_depth": load_dict.ROULETTE[False]}
    theirs = {"type": "scene", "i": {"type": "aov", "nested": {"type": "path", "hide_emitters": True}}}
    assert contender.integrator_like(theirs, "volpath") == {"type": "volpath", "hide_emitters": True}


def test_what_mitsuba_cannot_load_is_told() -> None:
    scene = Scene({"type": "scene", "thing": {"type": "unicorn"}}, "fable")
    with pytest.raises(Failure, match="Mitsuba cannot load fable .*unicorn"):
        mitsuba.load(scene)


def test_tyndall_is_a_process_for_each_number_of_samples(tmp_path: Path) -> None:
    done = rendered(tmp_path, str(ROOM), "--tyndall=--integrator pt --guide auto")
    first, last = map(json.loads, done.stdout.splitlines())
    assert (first["spp"], last["spp"]) == (2, 4) and min(first["seconds"], last["seconds"], last["load_seconds"]) > 0
    assert exr.read_image(tmp_path / "4.exr").shape == (3, 4, 3)
    unknown = rendered(tmp_path, str(ROOM), "--tyndall=--integrator ptt")
    assert unknown.returncode != 0 and "ptt" in unknown.stderr.strip().splitlines()[-1]


def test_all_take_turns_in_a_study_against_a_reference_that_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(studies, "OUTPUT", tmp_path)
    effort = Effort(2, 0.02, 0.2, "8x8", 1, points=2)
    study = studies.measured([ROOM], {"tyndall": studies.BDPT, "pt": "--integrator pt", "volpath:scalar_rgb": ""}, effort, tmp_path / "study")
    [scene] = study.scenes
    assert list(scene.costs) == ["tyndall", "pt", "mitsuba volpath scalar_rgb"] and not [note for note in scene.notes if "nobody" in note]
    assert all(len(costs) == 2 and min(costs) > 0 for costs in scene.costs.values())
    assert scene.told["contenders"][2]["load_seconds"] > 0 and scene.noise > 0
    kept = studies.reference(ROOM, effort)
    image = exr.read_image(kept.image)
    assert image.shape == (8, 8, 3) and studies.reference(ROOM, effort) == kept and (exr.read_image(kept.image) == image).all()
    program.call([str(program.binary()), "report", str(tmp_path / "study"), "--record", str(tmp_path / "record")])
    assert {path.name for path in (tmp_path / "record").iterdir()} == {"convergence.md", "convergence.svg", "convergence_strips.svg"}


def test_the_references_own_error_is_no_error() -> None:
    scene = {"name": "pool", "reference": {"own_relmse": 0.01}, "contenders": [{"name": "a", "points": [{"samples": 4}, {"samples": 8}]}]}
    row = {"contender": "a", "seconds": "2"}
    rows = [{**row, "samples": samples, "relmse": relmse} for samples, relmse in (("4", "9"), ("8", "0.03"), ("8", "0.012"))]
    assert studies.found(scene, rows).costs == {"a": pytest.approx([0.04, 0.012])}
