"""Whole studies of renderers that are made of random numbers: laws that are known, interruptions, and the contract."""

import csv
import json
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from validation import cli, exr
from validation.failure import Failure
from validation.places import ROOT
from validation.scene import Scene
from validation.study import command, conduct, intervals, outcome, plan, summary
from validation.study.conduct import Found, Settings
from validation.study.rivals import SEEDS_OF_PASSES, Rival, Timed
from validation.study.scenes import Subject
from validation.study.store import Store
from validation.study.truth import Truth

TRUTH = np.random.default_rng(12).uniform(0.2, 2, (24, 32, 3))
SUBJECT = Subject(Scene({"type": "scene"}, "toy"))


class Noise(Rival):
    """An image of known variance per sample, in a known time; can be told to stop after some renders."""

    left = 1 << 30
    seeds: list[tuple[str, int]] = []

    def __init__(self, name: str, deviation: float, seconds: float, scale: float = 1.0):
        self.name, self.deviation, self.seconds, self.scale = name, deviation, seconds, scale
        self.rendered = 0

    def render(self, spp: int, seed: int) -> Timed:
        if Noise.left == 0:
            raise KeyboardInterrupt
        Noise.left -= 1
        self.rendered += 1
        Noise.seeds.append((self.name, seed))
        self.load_seconds = 0.25
        random = np.random.default_rng([seed, spp, len(self.name)])
        return self.scale * TRUTH + random.normal(0, self.deviation / spp**0.5, TRUTH.shape), self.seconds * spp


def noises() -> list[Noise]:
    """Two renderers: one four times the noise of the other."""
    return [Noise("tyndall bdpt", 0.5, 0.01), Noise("mitsuba volpath x", 2.0, 0.01)]


@pytest.fixture(autouse=True)
def unlimited() -> None:
    """Nobody stops, unless a test says so."""
    Noise.left = 1 << 30
    Noise.seeds = []


def studied(folder: Path, monkeypatch: pytest.MonkeyPatch, seeds: int = 6, points: int = 4, **more: Any) -> tuple[Found, list[Noise]]:
    """A study of both; time on the clock plays no part."""
    made = noises()
    monkeypatch.setattr(conduct, "rivals", lambda *_: made)
    settings = Settings(["toy"], seeds, points, 2, more.get("reference"))
    return conduct.study(SUBJECT, settings, Store(folder / "runs" / "toy"), 60.0), made


def numbers(folder: Path) -> dict[str, Any]:
    """What is kept of a study."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*.*")) if path.is_file()}


def test_known_laws_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, _ = studied(tmp_path, monkeypatch, seeds=8)
    entry = summary.scene_outcome(found, Store(tmp_path / "runs" / "toy"), tmp_path)
    quiet, loud = entry.contenders
    samples = quiet.points[-1].samples
    own = entry.reference.own_relmse
    assert own
    expected = 0.25 / samples * (1 / (TRUTH**2 + 0.01)).mean() + own
    assert quiet.points[-1].relmse.mean == pytest.approx(expected, rel=0.06)
    assert quiet.points[-1].mse.mean == pytest.approx(0.25 / samples, rel=0.2)  # the reference's own comes on top
    assert quiet.slope and quiet.slope.mean == pytest.approx(-1, abs=0.1)
    assert quiet.efficiency.mean == pytest.approx(16 * loud.efficiency.mean * (1 - own / expected), rel=0.15)
    assert [p.samples for p in quiet.points] == [samples >> k for k in (3, 2, 1, 0)]
    variance = exr.read_image(tmp_path / quiet.variance)
    assert variance.mean() == pytest.approx(0.25 / samples, rel=0.15)
    assert exr.read_image(tmp_path / entry.reference.image) == pytest.approx(TRUTH, abs=0.15)


def test_efficiencies_are_held_against_the_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, _ = studied(tmp_path, monkeypatch, seeds=8)
    quiet, loud = summary.scene_outcome(found, Store(tmp_path / "runs" / "toy"), tmp_path).contenders
    assert quiet.ratio is None and loud.ratio
    assert loud.ratio.mean == pytest.approx(loud.efficiency.mean / quiet.efficiency.mean, rel=0.01)
    assert loud.ratio.low < loud.ratio.mean < loud.ratio.high


def test_what_the_reader_should_know_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert conduct.told({}, Truth(TRUTH, "known", 0.1), 6, 6) == []
    told = conduct.told({"lt": "why not"}, Truth(TRUTH, "known", None, "they disagree"), 5, 6)
    assert [note.split(" ")[0] for note in told] == ["lt", "they", "time", "nobody"] and "5 of 6 seeds" in told[2]
    found, _ = studied(tmp_path, monkeypatch)
    near = Found(found.subject, Truth(TRUTH, "known", 0.2), found.rivals, found.samples, {}, found.seeds, told)
    entry = summary.scene_outcome(near, Store(tmp_path / "runs" / "toy"), tmp_path)
    assert entry.notes == told and "the reference's own" in entry.contenders[0].notes[0]


def test_an_interrupted_study_goes_on_to_the_same_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, whole = studied(tmp_path / "whole", monkeypatch)
    total, again = sum(one.rendered for one in whole), 0
    pilots = total - 2 * plan.REFERENCE_BATCHES - 2 * 6 * 4
    for stop in (pilots + 3, 2 * plan.REFERENCE_BATCHES, 7, 20):  # within the reference, and within the rounds
        Noise.left = stop
        with pytest.raises(KeyboardInterrupt):
            studied(tmp_path / "parts", monkeypatch)
        again += stop
    Noise.left = total - again
    studied(tmp_path / "parts", monkeypatch)
    assert Noise.left == 0  # nothing was rendered twice
    assert numbers(tmp_path / "parts") == numbers(tmp_path / "whole")


def test_no_two_renders_share_random_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    studied(tmp_path, monkeypatch)
    kept = [pair for pair in Noise.seeds if pair[1] != plan.PILOT_SEED]  # which a pilot renders at growing numbers
    assert len(set(kept)) == len(kept)
    # Mitsuba's seeds have 32 bits: so many passes as one render can have, at the last seed there may be.
    last = max(plan.FIRST_SEED + (command.MOST_SEEDS - 1) * 64 + command.MOST_POINTS, plan.PILOT_SEED + 1)
    assert (last + 1) * SEEDS_OF_PASSES < 2**32
    assert plan.FIRST_SEED + (command.MOST_SEEDS - 1) * 64 + command.MOST_POINTS < plan.REFERENCE_SEED


def test_a_finished_study_renders_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    studied(tmp_path, monkeypatch)
    Noise.left = 0
    found, _ = studied(tmp_path, monkeypatch)
    assert found.seeds == 6 and found.load_seconds == {"tyndall bdpt": 0.25, "mitsuba volpath x": 0.25}


def test_more_seeds_are_added_to_those_there_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    studied(tmp_path, monkeypatch, seeds=2)
    Noise.left = 2 * 4
    assert studied(tmp_path, monkeypatch, seeds=3)[0].seeds == 3


def test_renders_of_another_study_are_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    studied(tmp_path, monkeypatch)
    with pytest.raises(Failure, match="another study"):
        studied(tmp_path, monkeypatch, points=3)


def test_nothing_of_others_is_deleted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dear = tmp_path / "runs" / "toy" / "turns" / "numbers.json"
    dear.parent.mkdir(parents=True)
    dear.write_text("weeks of work")
    with pytest.raises(Failure, match="toy holds turns, and no plan"):
        studied(tmp_path, monkeypatch)
    assert dear.read_text() == "weeks of work" and not Noise.seeds


@pytest.mark.parametrize("mark", ["runs/plan.json", "study.json"])
def test_a_study_of_the_program_is_left_alone(mark: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "runs").mkdir()
    (tmp_path / mark).write_text("{}")
    monkeypatch.setattr(conduct, "rivals", lambda *_: pytest.fail("something would be rendered"))
    with pytest.raises(Failure, match="made otherwise"):
        cli.main(["convergence", "--output", str(tmp_path)])
    assert [path.name for path in tmp_path.rglob("*.json")] == [Path(mark).name]


class Broken(Noise):
    """Cannot load, or now and then gives what is no number."""

    def __init__(self, name: str, loads: bool):
        super().__init__(name, 1.0, 0.01)
        self.loads = loads

    def render(self, spp: int, seed: int) -> Timed:
        if not self.loads:
            raise Failure("no such plugin", "install it")
        image, seconds = super().render(spp, seed)
        image[3, 4, 1] = np.nan if seed >= plan.FIRST_SEED + 64 else image[3, 4, 1]  # not by the first seed
        return image, seconds


def with_another(folder: Path, monkeypatch: pytest.MonkeyPatch, other: Rival) -> tuple[Found, outcome.SceneOutcome]:
    """A study in which a third one takes part, and what is read back of it."""
    settings = Settings(["toy"], 4, 3, 2, None)
    store = Store(folder / "runs" / "toy")
    monkeypatch.setattr(conduct, "rivals", lambda *_: [noises()[0], other, noises()[1]])
    conduct.study(SUBJECT, settings, store, 60.0)
    found = conduct.study(SUBJECT, settings, store, 60.0)  # again, all of it kept
    entry = summary.scene_outcome(found, store, folder)
    outcome.write(outcome.Outcome("us", "the command", "a machine", intervals.CONFIDENCE, [entry]), folder)
    summary.markdown(outcome.read(folder))
    return found, outcome.read(folder).scenes[0]


def test_who_cannot_load_a_scene_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, entry = with_another(tmp_path, monkeypatch, Broken("mitsuba broken", loads=False))
    assert [c.name for c in entry.contenders] == ["tyndall bdpt", "mitsuba volpath x"]
    assert entry.notes == ["mitsuba broken is left out: no such plugin"] and found.seeds == 4


def test_one_value_that_is_none_ends_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, entry = with_another(tmp_path, monkeypatch, Broken("tyndall broken", loads=True))
    good, broken, _ = entry.contenders
    assert np.isfinite([good.efficiency.mean, good.efficiency.low, good.points[-1].relmse.high]).all()
    assert np.isnan([broken.efficiency.mean, broken.points[-1].relmse.mean]).all() and broken.slope is None
    assert broken.notes[0] == "3 of its 4 images hold NaN or infinite values"


def test_a_study_of_nobody_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conduct, "rivals", lambda *_: [Broken("tyndall broken", loads=False)])
    with pytest.raises(Failure, match="no contender can render the scene: no such plugin"):
        conduct.study(SUBJECT, Settings(["toy"], 2, 2, 2, None), Store(tmp_path / "toy"), 60.0)


def test_half_a_file_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    studied(tmp_path, monkeypatch)
    (tmp_path / "runs" / "toy" / "plan.json").write_text("{")
    with pytest.raises(Failure, match="plan.json"):
        studied(tmp_path, monkeypatch)


def test_a_given_reference_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    exr.write_image(tmp_path / "truth.exr", TRUTH)
    found, made = studied(tmp_path, monkeypatch, reference=tmp_path / "truth.exr")
    assert found.truth.own_relmse is None and (found.truth.image == TRUTH.astype(np.float32)).all()
    assert not list((tmp_path / "runs").rglob("reference*"))


def test_a_reference_of_another_size_is_refused_before_anything_is_rendered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    exr.write_image(tmp_path / "truth.exr", TRUTH)
    monkeypatch.setattr(conduct, "rivals", lambda *_: noises())
    film = {"type": "scene", "sensor": {"type": "perspective", "film": {"type": "hdrfilm", "height": 24}}}
    for subject in (Subject(Scene(film, "toy")), Subject(SUBJECT.scene, (24, 32))):
        with pytest.raises(Failure, match="the reference has 32 x 24 pixels, the scene (768 x 24|24 x 32)"):
            conduct.study(subject, Settings(["toy"], 2, 2, 2, tmp_path / "truth.exr"), Store(tmp_path / "runs"), 60.0)
    assert not Noise.seeds


def test_time_that_is_up_ends_a_study_after_whole_rounds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = noises()
    planned = {"samples": {one.name: [1, 2] for one in made}}
    store, reference = Store(tmp_path), Truth(TRUTH, "known", None)
    done = conduct.take_turns([*made], planned, reference, 9, store, deadline=0.0)
    assert done == conduct.LEAST_SEEDS and made[0].rendered == 2 * done


def written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A study's `study.json`."""
    found, _ = studied(folder, monkeypatch)
    store = Store(folder / "runs" / "toy")
    entry = summary.scene_outcome(found, store, folder)
    whole = outcome.Outcome("us", "the command", "a machine", intervals.CONFIDENCE, [entry])
    summary.write_csv(folder / "study.csv", summary.rows(found, store))
    (folder / "study.md").write_text(summary.markdown(whole))
    return json.loads(outcome.write(whole, folder).read_text())


def test_all_that_is_named_lies_beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    [scene] = written(tmp_path, monkeypatch)["scenes"]
    named = [scene["reference"]["image"]]
    for contender in scene["contenders"]:
        named += [contender["variance"], *(point["image"] for point in contender["points"])]
    assert named[1].startswith("images/toy/tyndall-bdpt/")
    assert all(exr.read_image(tmp_path / name).shape == TRUTH.shape for name in named)
    with (tmp_path / "study.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 2 * 4 * 6
    assert "| tyndall bdpt |" in (tmp_path / "study.md").read_text()


def test_the_columns_are_those_of_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path, monkeypatch)
    rust = (ROOT / "src" / "study" / "convergence" / "table.rs").read_text()
    header = re.search(r'CSV_HEADER: &str =\s*"(.*?)\\n"', rust)
    assert header and (tmp_path / "study.csv").read_bytes().split(b"\n")[0].decode() == header[1]


def test_the_words_are_those_of_the_program() -> None:
    rust = (ROOT / "src" / "study" / "outcome.rs").read_text()
    ours = (outcome.Outcome, outcome.SceneOutcome, outcome.Reference, outcome.Contender, outcome.Point, outcome.Interval)
    names = ("Outcome", "SceneOutcome", "Reference", "ContenderOutcome", "Point", "Interval")
    for name, our in zip(names, ours):
        body = re.search(rf"pub struct {name} \{{(.*?)\n\}}", rust, re.DOTALL)
        assert body and re.findall(r"pub (\w+):", body[1]) == [field.name for field in fields(our)]
