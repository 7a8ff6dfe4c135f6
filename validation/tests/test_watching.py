"""Renders while they run: progress, interrupts and warnings."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tyndall
from tyndall import program, watching
from tyndall.failure import Failure
from tyndall.scene import Scene
from validation.places import CROSSCHECK, PYTHON, SCENES

SCENE = CROSSCHECK / "cube_in_room.json"


class Interrupted:
    """Sends this process what Ctrl-C sends, once something has been rendered."""

    def __init__(self) -> None:
        self.is_sent = False

    def update(self, progress: dict[str, Any]) -> None:
        if not self.is_sent and progress["samples_per_pixel"] > 0:
            self.is_sent = True
            os.kill(os.getpid(), signal.SIGINT)

    def close(self) -> None: ...


class Kept:
    """Remembers what was shown."""

    def __init__(self) -> None:
        self.updates: list[dict[str, Any]] = []

    def update(self, progress: dict[str, Any]) -> None:
        self.updates.append(progress)

    def close(self) -> None: ...


def test_progress_is_lines_of_json(tmp_path: Path) -> None:
    command = [str(program.binary()), "--quiet", "render", str(SCENE), "-o", str(tmp_path / "a.exr"), "--spp", "1000", "--progress", "json"]
    kept = Kept()
    outcome = watching.run(command, kept)
    assert outcome.code == 0 and outcome.said == []
    done = [update["done"] for update in kept.updates]
    assert done == sorted(done) and done[-1] == 1 and kept.updates[-1]["samples_per_pixel"] == 1000
    assert 0 < kept.updates[-1]["noise"] < 1 and kept.updates[-1]["seconds"] > 0


def test_an_interrupt_returns_the_image_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watching, "shown", lambda _: Interrupted())
    start = time.monotonic()
    with pytest.warns(tyndall.TyndallWarning, match="interrupted after .* the image so far .* resume=True"):
        image = tyndall.render(SCENE, time_limit=600, size=(32, 32), sums=tmp_path / "image.sums")
    assert time.monotonic() - start < 300 and image.shape == (32, 32, 3) and image.mean() > 0
    assert 0 < image.report["samples_per_pixel"] == image.metadata["samples_per_pixel"]


def test_an_interrupt_before_there_is_an_image_is_one() -> None:
    progress = json.dumps({"done": 0, "samples_per_pixel": 1})
    outcome = watching.run(["sh", "-c", f"echo '{progress}' >&2; exec sleep 600"], Interrupted())
    assert outcome.was_interrupted and outcome.code != 0


def test_a_render_ends_with_whoever_asked_for_it() -> None:
    code = f"import tyndall; tyndall.render({str(SCENE)!r}, time_limit=600, size=(32, 32), progress=True)"
    asking = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, env={**os.environ, "PYTHONPATH": str(PYTHON)})
    assert asking.stderr is not None and asking.stderr.read(1), "it shows no progress"
    renders = found_soon(lambda: Path(f"/proc/{asking.pid}/task/{asking.pid}/children").read_text().split())
    asking.kill()
    asking.wait()
    assert found_soon(lambda: not any(Path("/proc", render).exists() for render in renders))


def found_soon(ask: Callable[[], Any]) -> Any:
    """The first answer that is one, within 20 s."""
    until = time.monotonic() + 20
    while time.monotonic() < until:
        if answer := ask():
            return answer
        time.sleep(0.1)
    raise AssertionError("not within 20 s")


def test_what_takes_too_long_is_ended() -> None:
    start = time.monotonic()
    with pytest.raises(Failure, match="not done after 0.5 s"):
        tyndall.render(SCENE, time_limit=60, patience=0.5)
    assert time.monotonic() - start < 20


def test_warnings_of_the_program_are_pythons() -> None:
    with pytest.warns(tyndall.TyndallWarning, match="tracker has no effect") as found:
        tyndall.render(CROSSCHECK / "fog_isotropic.json", spp=1, size=(4, 4), tracker="exact")
    assert [warning.filename for warning in found] == [__file__]


def test_a_bar_is_shown_where_it_is_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    tyndall.render(SCENE, spp=400, size=(32, 32), progress=True)
    said = capsys.readouterr().err
    assert "samples/pixel, noise" in said
    tyndall.render(SCENE, spp=1, size=(4, 4))
    assert capsys.readouterr().err == ""


def test_studies_return_their_numbers_and_go_on(tmp_path: Path) -> None:
    options: dict[str, Any] = {"vary": {"integrator": ["pt", "bdpt"]}, "seeds": 2, "doublings": 2, "spp": 2, "size": (8, 8), "reference_spp": 16}
    found = tyndall.study(SCENE, tmp_path / "study", **options)
    assert json.loads((tmp_path / "study" / "study.json").read_text()) == found and (tmp_path / "study" / "study.html").is_file()
    scene = tyndall.load(SCENE)
    of_dictionary = tyndall.study(scene, tmp_path / "again", **options)
    assert tyndall.study(scene, tmp_path / "again", **options)["scenes"] == of_dictionary["scenes"]
    with pytest.raises(Failure, match="did you mean doublings"):
        tyndall.study(scene, tmp_path / "other", doubling=2)


def test_scenes_of_a_study_share_their_parameters(tmp_path: Path) -> None:
    boxes = [Scene(SCENES / f"lampbox_{way}.xml", way, {"res": "6"}) for way in ("down", "up")]
    found = tyndall.study(boxes, tmp_path / "study", vary={"integrator": "pt"}, seeds=2, doublings=1, spp=1, reference_spp=2)
    assert [(scene["width"], scene["height"]) for scene in found["scenes"]] == [(6, 6)] * 2
