"""The gallery: what is in the repository holds, what does not hold is said, and its pictures and figures come about."""

import json
import shutil
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tyndall import display
from tyndall.failure import Failure
from validation import animation, cli, gallery, mitsuba
from validation.places import CROSSCHECK, ROOT, SCENES

SCENE = CROSSCHECK / "cube_in_room.json"
COMMAND = f"tyndall render {SCENE.relative_to(ROOT)} --size 8x6 --spp 4"


def entry(**fields: Any) -> dict[str, Any]:
    """A cube, in words."""
    return {"title": "A cube", "shows": "a cube", "after": "LW96", "command": COMMAND, "mitsuba": False, "why_not": "it must not", **fields}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A gallery of its own, in a folder like that of the scenes."""
    scenes = tmp_path / "scenes"
    (scenes / "gallery").mkdir(parents=True)
    for name, path in {"SCENES": scenes, "FOLDER": scenes / "gallery", "OUTPUT": tmp_path / "out", "PAGE": scenes / "GALLERY.md"}.items():
        monkeypatch.setattr(gallery, name, path)
    monkeypatch.setattr(gallery, "ENTRIES", scenes / "gallery" / "gallery.json")
    monkeypatch.setattr(gallery, "MEASURED", scenes / "gallery" / "measured.json")
    (scenes / "GALLERY.md").write_text("before\n<!-- gallery -->\nold\n<!-- end -->\nafter\n")
    return scenes / "gallery"


def hang(folder: Path, **entries: dict[str, Any]) -> None:
    """Writes gallery.json."""
    (folder / "gallery.json").write_text(json.dumps(entries))


def test_the_gallery_of_the_repository_holds() -> None:
    assert cli.main(["gallery", "--check"]) == 0


def test_an_entry_is_rendered_measured_and_shown(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mitsuba, "libllvm", lambda: None)
    hang(folder, cube=entry(mitsuba=True, command=f"{COMMAND} --exposure -1 --view=agx"), other=entry())
    assert cli.main(["gallery", "cube", "--threads", "1"]) == 0
    found = json.loads((folder / "measured.json").read_text())["cube"]
    assert 0 < found["relmse"] < 1 and 0 < found["mitsuba_relmse"] and found["mitsuba_by"] == "volpath"
    text = (folder.parent / "GALLERY.md").read_text()
    assert text.startswith("before\n") and text.endswith("after\n") and "old" not in text
    assert '<img src="gallery/cube.png"' in text and '<img src="gallery/cube.mitsuba.png"' in text and "**A cube** (LW96): a cube" in text
    assert cli.main(["gallery", "--check"]) == 1, "the other has no picture"
    shutil.copy(folder / "cube.png", folder / "other.png")
    assert cli.main(["gallery", "--check"]) == 0


def test_a_denoised_picture_has_a_small_one_and_is_measured_as_it_was_before(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mitsuba, "libllvm", lambda: None)
    monkeypatch.setattr(gallery, "SMALL", 4)
    hang(folder, cube=entry(mitsuba=True, command=f"{COMMAND} --denoise"), plain=entry())
    assert cli.main(["gallery", "--threads", "1"]) == 0
    for name, size in (("cube", (8, 6)), ("cube.small", (4, 3)), ("cube.mitsuba", (8, 6)), ("cube.mitsuba.small", (4, 3))):
        with Image.open(folder / f"{name}.jpg") as image:
            assert image.size == size
    found = json.loads((folder / "measured.json").read_text())
    assert found["cube"]["relmse"] == found["plain"]["relmse"]
    assert '[<img src="gallery/cube.small.jpg" width="240">](gallery/cube.jpg)' in (folder.parent / "GALLERY.md").read_text()
    (folder / "cube.small.jpg").unlink()
    assert cli.main(["gallery", "--check"]) == 1


def test_a_command_that_shows_frames_makes_a_moving_picture(folder: Path) -> None:
    hang(folder, cube=entry(command=f"{COMMAND} --frames 0..2 --fps 8"))
    assert cli.main(["gallery", "--threads", "1"]) == 0
    kinds = [kind for kind, _ in animation.chunks((folder / "cube.png").read_bytes())]
    assert kinds == [b"IHDR", b"acTL", b"fcTL", b"IDAT", b"fcTL", b"fdAT", b"fcTL", b"fdAT", b"IEND"]


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "no such option": ({"command": f"{COMMAND} --brighter 2"}, "tyndall render has no option --brighter"),
    "no scene": ({"command": "tyndall render scenes/nothing.json"}, "nothing.json is not there"),
    "no parameter": ({"command": f"{COMMAND} -D fog=2"}, "fog"),
    "no picture of Mitsuba's": ({"mitsuba": True}, "cube.mitsuba.png is not there"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_said(what: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hang(folder, cube=entry())
    (folder / "cube.png").write_bytes(b"")
    assert cli.main(["gallery", "--table"]) == 0
    assert cli.main(["gallery", "--check"]) == 0
    fields, said = WRONG[what]
    hang(folder, cube=entry(**fields))
    assert cli.main(["gallery", "--table"]) == 0
    assert cli.main(["gallery", "--check"]) == 1
    assert said in capsys.readouterr().out


def test_a_table_that_is_not_current_is_said(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hang(folder)
    assert cli.main(["gallery", "--check"]) == 1
    assert "python3 -m validation gallery --table" in capsys.readouterr().out


def test_names_and_commands_that_are_none_are_refused(folder: Path) -> None:
    hang(folder, cube=entry(command="rm scenes"))
    with pytest.raises(Failure, match="ball: not in"):
        cli.main(["gallery", "ball"])
    with pytest.raises(Failure, match="the command is rm scenes"):
        cli.main(["gallery", "cube"])


def test_chromatic_media_are_known(folder: Path) -> None:
    hang(folder, grey=entry(), coloured=entry(command=f"tyndall render {(CROSSCHECK / 'sphere_chromatic.json').relative_to(ROOT)}"))
    assert [gallery.is_chromatic(one) for one in gallery.entries()] == [False, True]


def test_frames_follow_one_another() -> None:
    frames = [display.png(np.full((2, 3, 3), value, np.uint8)) for value in (0, 100, 200)]
    moving = list(animation.chunks(animation.animation(frames, 4)))
    sequence = [struct.unpack(">I", data[:4])[0] for kind, data in moving if kind in (b"fcTL", b"fdAT")]
    assert sequence == [0, 1, 2, 3, 4]
    assert dict(moving)[b"acTL"] == struct.pack(">II", 3, 0)
    delay = struct.unpack(">HH", dict(moving)[b"fcTL"][20:24])
    assert delay[0] / delay[1] == 0.25
    pixels = [data for kind, data in animation.chunks(frames[2]) if kind == b"IDAT"]
    assert [data[4:] for kind, data in moving if kind == b"fdAT"][-1:] == pixels
