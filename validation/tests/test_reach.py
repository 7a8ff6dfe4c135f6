"""`compare`: what is checked first, what it takes for no fault, and what it needs."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tyndall.failure import Failure
from tyndall.scene import open_scene
from validation import cli, mitsuba, reach
from validation.places import CROSSCHECK, ROOT

STEPS = [{"type": "lookat", "origin": [0, 3, 5], "target": [0, 0, 0], "up": [0, 1, 0]}]


def caustic(folder: Path, bsdf: str = "dielectric") -> Path:
    """A ball between a spot and a floor."""
    film = {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}}
    lamp = [{"type": "lookat", "origin": [0, 3, 0], "target": [0, 0, 0], "up": [1, 0, 0]}]
    floor = [{"type": "rotate", "axis": [1, 0, 0], "angle": -90}, {"type": "scale", "value": 3}]
    scene = {
        "type": "scene",
        "sensor": {"type": "perspective", "fov": 45, "film": film, "to_world": STEPS},
        "lamp": {"type": "spot", "intensity": 20, "cutoff_angle": 25, "to_world": lamp},
        "ball": {"type": "sphere", "radius": 0.6, "center": [0, 1, 0], "bsdf": {"type": bsdf}},
        "floor": {"type": "rectangle", "to_world": floor, "bsdf": {"type": "diffuse", "reflectance": 0.6}},
    }
    (folder / "caustic.json").write_text(json.dumps(scene))
    return folder / "caustic.json"


def test_light_that_one_side_does_not_reach_is_no_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = caustic(tmp_path)
    output = tmp_path / "output"
    assert cli.main(["compare", str(scene), "--integrators", "pt,bdpt", "--batches", "8", "--spp", "16", "--output", str(output)]) == 0
    said = capsys.readouterr().out
    [row] = [line for line in said.splitlines() if " bdpt " in line]
    assert "DIFFER" in row and "trials" not in row
    assert said.count("no fault: Mitsuba does not reach light of spot emitters by way of smooth glass (caustics)\n") == 1
    page = (output / "caustic.html").read_text()
    assert "No fault: Mitsuba does not reach light of spot emitters" in page and ">DIFFER<" in page


def test_where_both_reach_all_nothing_is_excused(tmp_path: Path) -> None:
    assert reach.differences(open_scene(caustic(tmp_path, "diffuse")), ["pt", "bdpt", "lt", "mitsuba"]) == {"pt": [], "bdpt": [], "lt": [], "mitsuba": []}
    through_glass = reach.differences(open_scene(caustic(tmp_path)), ["pt", "lt"])
    assert through_glass["pt"] == [] and any(reason.startswith("lt does not reach") for reason in through_glass["lt"])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--integrators", "bdtp"], "no method 'bdtp'"),
        (["--integrators", "pt:exakt"], "'exact'"),
        (["--batches", "1"], "at least 8"),
        (["--spp", "0"], "at least 1"),
        (["-D", "res"], "name=value"),
        (["-D", "unknown=3"], "unknown"),
    ],
)
def test_arguments_are_checked_before_anything_is_rendered(words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def rendered(*_: Any) -> None:
        raise AssertionError("Mitsuba was started")

    monkeypatch.setattr(mitsuba, "load", rendered)
    with pytest.raises(Failure, match=said):
        cli.main(["compare", str(caustic(tmp_path)), "--output", str(tmp_path), *words])


def test_mitsuba_is_only_imported_where_it_renders() -> None:
    code = f"""
import sys
from validation import cli, references
from tyndall.scene import open_scene
from validation.matrix import RECORDED_EFFORT as effort
references.recorded(open_scene({str(CROSSCHECK / "fog_isotropic.json")!r}), effort)
print([m for m in ("mitsuba", "drjit") if m in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.strip() == "[]", done.stderr
