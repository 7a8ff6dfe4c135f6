"""Mitsuba as a contender: what it renders, its protocol, and the studies that it takes part in."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tyndall import exr, load_dict, program
from tyndall.failure import Failure
from tyndall.scene import Scene, open_scene
from validation import cli, contender, mitsuba, studies
from validation.places import CROSSCHECK, ROOT, SCENES

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
    lampbox = contender.tree(open_scene(SCENES / "lampbox_up.xml", {"res": "7"}))
    assert contender.integrator_like(lampbox, "volpathmis") == {"type": "volpathmis", "max_depth": 17, "rr_depth": 1000}
    assert lampbox["sensor"]["film"]["width"] == 7
    ours = {"type": "scene", "integrator": {"type": "bdpt", "max_depth": 5}}
    assert contender.integrator_like(ours, "volpath") == {"type": "volpath", "max_depth": 5, "rr_depth": load_dict.ROULETTE[False]}
    theirs = {"type": "scene", "i": {"type": "aov", "nested": {"type": "path", "hide_emitters": True}}}
    assert contender.integrator_like(theirs, "volpath") == {"type": "volpath", "hide_emitters": True}


def test_the_six_scenes_are_some_that_mitsuba_loads() -> None:
    assert len(set(studies.SIX)) == 6
    for path in studies.SIX:
        assert mitsuba.load(open_scene(path), "scalar_rgb", (96, 96)) is not None


def test_what_mitsuba_cannot_load_is_told() -> None:
    scene = Scene({"type": "scene", "thing": {"type": "unicorn"}}, "fable")
    with pytest.raises(Failure, match="Mitsuba cannot load fable .*unicorn"):
        mitsuba.load(scene)


def test_minutes_become_the_seconds_of_a_render() -> None:
    lines: list[list[str]] = []

    def run(line: list[str]) -> bool:
        lines.append(line)
        return True

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(studies, "run", run)
        assert cli.main(["convergence", "--minutes", "10", "--seeds", "4", "--contenders", "bdpt,pt,volpath:scalar_rgb", "-D", "res=8"]) == 0
    [line] = lines
    seconds = next(word for word in line if word.startswith("--seconds="))
    assert float(seconds.partition("=")[2]) == pytest.approx(studies.USED * 600 / (6 * 4 * (3 + 4)), rel=0.01)
    assert line[0] == "study" and len([word for word in line if word.endswith((".xml", ".json"))]) == 6
    assert line[line.index("--external") + 1].startswith("mitsuba volpath scalar_rgb: ")
    assert line[line.index("--integrators") + 1] == "bdpt,pt" and "res=8" in line


@pytest.mark.parametrize(("words", "complaint"), [("--contenders volpth", "volpth: no such contender"), ("--minutes nan", "--minutes is nan")])
def test_what_makes_no_sense_is_refused(words: str, complaint: str) -> None:
    with pytest.raises(Failure, match=complaint):
        cli.main(["convergence", *words.split()])


def test_mitsuba_takes_part_in_a_study(tmp_path: Path) -> None:
    line = studies.words([ROOM], ["bdpt", "volpath:scalar_rgb"], {"spp": 4, "doublings": 2, "seeds": 2, "reference_spp": 32, "size": "8x8"}, ["-o", str(tmp_path)])
    assert studies.run(line)
    [scene] = json.loads((tmp_path / "study.json").read_text())["scenes"]
    theirs, ours = scene["contenders"]
    assert (theirs["name"], ours["name"]) == ("mitsuba volpath scalar_rgb", "bdpt")
    assert theirs["load_seconds"] > 0 and theirs["points"][1]["relmse"]["mean"] > 0 and ours["ratio"]["mean"] > 0
    assert "mitsuba volpath scalar_rgb" in scene["reference"]["how"]
    print(program.call([str(program.binary()), "report", str(tmp_path), "--record", str(tmp_path / "record")]).stdout)
    assert {path.name for path in (tmp_path / "record").iterdir()} == {"convergence.md", "convergence.svg", "convergence_strips.svg"}
