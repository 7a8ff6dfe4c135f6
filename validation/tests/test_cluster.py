"""Pictures of parts: how they are cut, and that they equal a single render whatever befalls those who render them."""

import json
import os
import pickle
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tyndall import exr, program
from tyndall.failure import Failure
from validation import cli as whole_cli
from validation.cluster import cli, farm, locked, parts, render, study, task, tiles
from validation.cluster.job import Job, job
from validation.cluster.sums import Sums, info
from validation.places import CROSSCHECK, ROOT, SCENES

ROOM = CROSSCHECK / "cube_in_room.json"
SLOW = SCENES / "foggy_room.json"


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Three workers of one task each."""
    pytest.importorskip("distributed", reason="`distributed` is not installed: python3 -m validation.cluster render ... installs it")
    with farm.connected(None, workers=3, retries=3) as client:
        yield client


def equal(some: Path, other: Path) -> bool:
    """True if all channels of two images are the same, bit for bit."""
    a, b = exr.read(some), exr.read(other)
    assert a.keys() == b.keys()
    return all(np.array_equal(a[layer][channel], b[layer][channel]) for layer in a for channel in a[layer])


def single(of: Job, folder: Path) -> Path:
    """The same picture by one render."""
    image = folder / "single.exr"
    program.call([*of.render(), "--samples", f"0..{of.spp}", "--sums", str(folder / "single.sums"), "-o", str(image)])
    return image


def rendered(of: Job, first: int, end: int) -> str:
    """One part, by the program alone."""
    of.folder.mkdir(exist_ok=True)
    return task.render_part(of.part((first, end)), str(of.folder), parts.name((first, end)))


def test_what_is_missing_is_cut_into_parts_that_hold_every_sample_once() -> None:
    there = parts.parsed("8..12, 40..50")
    gaps = parts.missing(there, 64)
    assert gaps == [(0, 8), (12, 40), (50, 64)]
    cut = parts.cut(gaps, 6)
    assert max(end - first for first, end in cut) == 6
    samples = [sample for first, end in [*there, *cut] for sample in range(first, end)]
    assert sorted(samples) == list(range(64))
    assert parts.missing([(0, 100)], 64) == [] and parts.missing([], 3) == [(0, 3)]
    assert parts.parsed("0..64") == [(0, 64)] and parts.parsed("none") == []
    assert parts.overlap([(0, 8)], [(7, 9)]) and not parts.overlap([(0, 8)], [(8, 9)])


def test_workers_get_several_parts_unless_the_user_says_how_many() -> None:
    assert parts.part_size(4096, None, None, workers=1) == 4096 // parts.FEWEST
    assert parts.part_size(4096, None, None, workers=16) == 64
    assert parts.part_size(10, 3, None, workers=9) == 4 and parts.part_size(10, None, 7, workers=9) == 7
    assert parts.part_size(3, None, None, workers=9) == 1
    with pytest.raises(Failure, match="--parts is 0"):
        parts.part_size(8, 0, None, 1)


def test_options_that_no_part_can_have_are_refused(tmp_path: Path) -> None:
    for word in ("--samples=0..4", "--resume", "--time-limit", "--crop=2x2+0+0", "--frames"):
        with pytest.raises(Failure, match=word.partition("=")[0]):
            job(str(ROOM), tmp_path / "a.exr", [word], 8, None)
    with pytest.raises(Failure, match="no such scene"):
        job("32x24", tmp_path / "a.exr", [], 8, None)
    assert job(str(SCENES / "lampbox_up.xml"), tmp_path / "a.exr", ["-D", "res=8"], None, None).spp == 32
    assert job(str(ROOM), tmp_path / "a.exr", [], None, None).spp == 64


def test_what_the_driver_does_not_know_is_for_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pictures: list[tuple[Job, int]] = []
    workers = SimpleNamespace(nthreads=lambda: {"one": 1, "other": 1})
    monkeypatch.setattr(farm, "connected", lambda *_: nullcontext(workers))
    monkeypatch.setattr(render, "run", lambda _, picture, size, retries: pictures.append((picture, size)))
    words = f"render {SCENES}/lampbox_up.xml --max-depth -1 -o {tmp_path}/a.exr -D res=8 --workers 1000 --size 8x6 --spp 64 --parts 4"
    assert cli.main(words.split()) == 0
    [(picture, size)] = pictures
    assert picture.options == "-D res=8 --max-depth -1 --size 8x6 --threads 1".split() and (picture.spp, size) == (64, 16)
    program.call([*picture.render(), "--spp", "1", "-o", str(tmp_path / "b.exr")])


def test_command_lines_of_parts_make_the_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = f"cluster commands {ROOM} -o {tmp_path}/a.exr --size 8x6 --spp 10 --parts 3".split()
    assert whole_cli.main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    for line in lines:
        program.call(shlex.split(line))
    picture = job(str(ROOM), tmp_path / "a.exr", ["--size", "8x6"], 10, None)
    sums = Sums(picture.output, picture.folder)
    sums.gather()
    assert sums.there == [(0, 10)] and equal(picture.output, single(picture, tmp_path))


def test_two_workers_at_one_part_are_not_in_each_others_way(tmp_path: Path) -> None:
    picture = job(str(ROOM), tmp_path / "a.exr", ["--size", "96x72", "--threads", "1"], 64, None)
    with ThreadPoolExecutor(2) as workers:
        found = set(workers.map(lambda _: rendered(picture, 0, 64), range(2)))
    sums = Sums(picture.output, picture.folder)
    sums.add(list(found))
    assert len(found) == 1 and equal(picture.output, single(picture, tmp_path)) and not list(picture.folder.iterdir())


def test_a_part_that_comes_twice_counts_once_and_what_is_there_is_a_picture(tmp_path: Path) -> None:
    picture = job(str(ROOM), tmp_path / "a.exr", ["--size", "12x8", "--max-depth", "-1"], 24, None)
    sums = Sums(picture.output, picture.folder)
    first = rendered(picture, 8, 16)
    again = Path(first).read_bytes()
    sums.add([first, first])
    assert sums.there == [(8, 16)] and picture.output.is_file() and not Path(first).exists()
    Path(first).write_bytes(again)
    sums.add([first, rendered(picture, 0, 8)])
    assert sums.there == [(0, 16)] and not Path(first).exists()
    sums.add([rendered(picture, 16, 24)])
    render.finish(picture, sums)
    assert equal(picture.output, single(picture, tmp_path))


def test_a_driver_that_starts_again_takes_what_is_there_and_only_of_its_picture(tmp_path: Path) -> None:
    picture = job(str(ROOM), tmp_path / "a.exr", ["--size", "12x8"], 24, None)
    Sums(picture.output, picture.folder).add([rendered(picture, 0, 8)])
    rendered(picture, 16, 24)
    Path(picture.folder, "samples-0000008-0000016.sums").write_bytes(b"torn")
    sums = Sums(picture.output, picture.folder)
    render.begin(picture, sums)
    assert parts.missing(sums.there, picture.spp) == [(8, 16)]
    other = job(str(ROOM), tmp_path / "a.exr", ["--size", "12x8", "--seed", "5"], 24, None)
    with pytest.raises(Failure, match="seed = 5"):
        render.begin(other, Sums(other.output, other.folder))
    with locked.alone(picture.folder), pytest.raises(Failure, match="another driver"), locked.alone(picture.folder):
        pass


def test_a_part_goes_on_from_what_a_stopped_attempt_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    picture = job(str(ROOM), tmp_path / "a.exr", ["--size", "12x8"], 16, None)
    picture.folder.mkdir()
    run, resumed = task.run, []

    def watched(command: list[str], folder: str) -> None:
        resumed.append("--resume" in command)
        run(command, folder)

    monkeypatch.setattr(task, "run", watched)
    left = picture.folder / f"{parts.name((0, 16))}.0.attempt"
    program.call([*picture.part((0, 4)), "--sums", str(left)])
    part = rendered(picture, 0, 16)
    assert resumed == [True] and not left.exists()
    sums = Sums(picture.output, picture.folder)
    sums.add([part])
    render.finish(picture, sums)
    assert equal(picture.output, single(picture, tmp_path))
    left.with_name(f"{left.name}.previous").write_bytes(b"torn")
    assert rendered(picture, 0, 16) and resumed == [True, True, False]


def test_a_program_ends_with_the_worker_that_runs_it(tmp_path: Path) -> None:
    mark = tmp_path / "ended"
    script = f"trap 'touch {mark}; exit' TERM; touch {mark}.begun; while :; do sleep 0.05; done"
    call = f"from validation.cluster import task; task.run({['sh', '-c', script]!r}, '.')"
    worker = subprocess.Popen([sys.executable, "-c", call], cwd=ROOT)
    assert appears(Path(f"{mark}.begun")) and not mark.exists()
    worker.kill()
    assert worker.wait() == -signal.SIGKILL and appears(mark)


def appears(path: Path) -> bool:
    """True once a file is there."""
    end = time.monotonic() + 20
    while not path.exists() and time.monotonic() < end:
        time.sleep(0.02)
    return path.exists()


def test_a_picture_survives_a_worker_killed_midway_and_a_part_delivered_twice(client: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    picture = job(str(SLOW), tmp_path / "a.exr", ["--size", "96x72", "--threads", "1"], 96, None)
    workers: dict[str, int] = client.run(os.getpid)
    killed: list[int] = []
    take = render.take

    def take_and_kill(job: Job, sums: Sums, paths: list[str]) -> None:
        part = Path(paths[0]).read_bytes()
        take(job, sums, paths)
        Path(paths[0]).write_bytes(part)
        take(job, sums, paths[:1])
        busy = [address for address, tasks in client.processing().items() if tasks]
        if not killed and busy:
            killed.append(workers[busy[0]])
            os.kill(killed[0], signal.SIGKILL)

    monkeypatch.setattr(render, "take", take_and_kill)
    render.run(client, picture, 8, retries=0)
    assert killed and killed[0] not in client.run(os.getpid).values()
    assert equal(picture.output, single(picture, tmp_path)) and not picture.folder.exists()


def test_an_image_is_cut_into_parts_that_hold_every_pixel_once() -> None:
    for width, height, count in [(60, 50, 16), (1, 9, 4), (7, 1, 16), (640, 480, 1), (3, 3, 100)]:
        pixels = [[0] * width for _ in range(height)]
        crops = tiles.cut(width, height, count)
        for w, h, x, y in (map(int, crop.replace("x", "+").split("+")) for crop in crops):
            for row in pixels[y : y + h]:
                row[x : x + w] = [n + 1 for n in row[x : x + w]]
        assert pixels == [[1] * width] * height and min(count, width * height) <= 2 * len(crops) <= 4 * count + 2


def test_a_picture_to_an_error_is_cut_into_parts_of_the_image(client: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # Without a pilot: one for the two samples of the attempt below would choose otherwise.
    words = ["--size", "24x18", "--error", "0.5", "--threads", "1", "--strategies", "hit,next-event,join,lens"]
    picture = job(str(ROOM), tmp_path / "a.exr", words, None, None)
    assert picture.spp == 0 and picture.size() == (24, 18)
    assert whole_cli.main(["cluster", "commands", str(ROOM), "-o", str(tmp_path / "b.exr"), "--parts", "4", *words]) == 0
    for line in capsys.readouterr().out.splitlines():
        program.call(shlex.split(line))
    files = map(str, (tmp_path / "b.exr.parts").glob("*.sums"))
    program.call([str(program.binary()), "merge", *files, "-o", str(tmp_path / "b.exr")])
    part = Path(tmp_path, "b.exr.parts", "crop-12x9+12+9.sums")
    picture.folder.mkdir()
    there = part.replace(picture.folder / part.name)
    program.call([*picture.tile("12x9+0+0"), "--spp", "2", "--sums", str(picture.folder / "crop-12x9+0+0.0.attempt")])
    tiles.run(client, picture, 4, retries=0)
    told = capsys.readouterr().err
    assert "0 of 4 parts" not in told and "1 of 4 parts" in told and "4 of 4 parts" in told and not there.exists() and not picture.folder.exists()
    assert equal(picture.output, tmp_path / "b.exr") and exr.read(picture.output)["samples"]["N"].min() >= 32


def test_parts_may_differ_in_what_a_pilot_chose(tmp_path: Path) -> None:
    picture = job(str(ROOM), tmp_path / "a.exr", ["--size", "24x18", "--error", "0.5"], None, None)
    picture.folder.mkdir()
    program.call([*picture.tile("12x9+12+9"), "--sums", str(tiles.file(picture, "12x9+12+9"))])
    assert tiles.begin(picture, ["12x9+12+9"]) == ["12x9+12+9"]
    chosen = [info(path)["settings"]["chosen_by_pilot"] for path in (tiles.file(picture, "12x9+12+9"), picture.folder / "trial.sums")]
    assert chosen[0] != chosen[1]


def test_parts_of_another_picture_are_refused(tmp_path: Path) -> None:
    words = ["--size", "8x6", "--error", "0.9"]
    picture = job(str(ROOM), tmp_path / "a.exr", words, 4, None)
    picture.folder.mkdir()
    program.call([*job(str(ROOM), tmp_path / "a.exr", [*words, "--seed", "2"], 4, None).tile("8x6+0+0"), "--sums", str(tiles.file(picture, "8x6+0+0"))])
    with pytest.raises(Failure, match="a part of another picture"):
        tiles.run(None, picture, 1, retries=0)
    with pytest.raises(Failure, match="--samples-per-part is given"):
        cli.main(["commands", str(ROOM), "-o", str(tmp_path / "a.exr"), "--samples-per-part", "4", *words])


def test_workers_need_nothing_of_this_package(client: Any, tmp_path: Path) -> None:
    sent = pickle.dumps(farm.Sent(task.study))
    call = f"import pickle, sys; pickle.loads({sent!r})(['touch', 'made'], '.'); assert 'validation' not in sys.modules"
    subprocess.run([sys.executable, "-I", "-c", call], cwd=tmp_path, check=True)
    assert (tmp_path / "made").is_file()


@pytest.mark.parametrize(("name", "option", "complaint"), [("a.exr", "--sead=1", "unexpected argument '--sead'"), ("a.xyz", "--seed=1", "a.xyz")])
def test_a_mistake_is_told_before_anything_is_sent(tmp_path: Path, name: str, option: str, complaint: str) -> None:
    picture = job(str(ROOM), tmp_path / name, [option], 8, None)
    with pytest.raises(Failure, match=complaint):
        render.run(None, picture, 4, retries=1)
    assert not any(tmp_path.iterdir())
    with pytest.raises(Failure, match="no folder that can be written"):
        render.run(None, job(str(ROOM), tmp_path / "a.exr", [], 8, Path("/proc")), 4, retries=1)


def test_what_fails_is_tried_again_and_told(client: Any, tmp_path: Path) -> None:
    script = f"echo x >>{tmp_path}/tried; echo no such luck; exit 3"
    scripts = ["true", script]
    came: list[str] = []
    tasks = [farm.submit(client, task.study, [["sh", "-c", text], str(tmp_path)], f"task-{i}", 2) for i, text in enumerate(scripts)]
    with pytest.raises(Failure, match="1 of 2 tasks failed, 1 succeeded.*\n.*\n.*exit code 3: no such luck"):
        farm.finished(client, tasks, came.extend)
    assert came == [str(tmp_path)] and (tmp_path / "tried").read_text() == "x\n" * 3


def test_studies_of_scenes_become_one(client: Any, tmp_path: Path) -> None:
    scenes = [ROOM, CROSSCHECK / "vacuum_room.json"]
    effort = "--spp 4 --doublings 2 --seeds 2 --reference-spp 32 --size 8x6 --threads 1 --vary integrator=bdpt,pt".split()
    study.run(client, scenes, tmp_path, effort, 0, "the command")
    whole = json.loads((tmp_path / "study.json").read_text())
    assert [scene["name"] for scene in whole["scenes"]] == ["cube_in_room", "vacuum_room"]
    assert (tmp_path / "study.html").is_file() and whole["command"] == "the command"
    named = [scene["reference"]["image"] for scene in whole["scenes"]]
    assert all((tmp_path / image).is_file() for image in named)
    assert (tmp_path / "study.csv").read_text().count("\n") == 1 + 2 * 2 * 2 * 2


def test_options_of_each_scene_are_dealt_to_them() -> None:
    words = ["--reference", "a.exr", "--seeds", "4", "--reference=b.exr", "--reference-error=1", "--reference-error", "2"]
    shared, own = study.dealt(words, 2)
    assert shared == ["--seeds", "4"]
    assert own == [["--reference", "a.exr", "--reference-error=1"], ["--reference=b.exr", "--reference-error", "2"]]
    with pytest.raises(Failure, match="--reference is given 1 times for 2 scenes"):
        study.dealt(["--reference", "a.exr"], 2)
    with pytest.raises(Failure, match="two scenes have this name"):
        study.names([ROOM, ROOM])
