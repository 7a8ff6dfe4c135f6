"""Checks that printed intervals hold the truth as often as they say, by many small studies of scenes whose image is known; and that
printed noise is that of the image, by many renders of other scenes that differ by their seeds alone."""

import argparse
import json
import shlex
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from tyndall import exr, program
from tyndall.scene import Scene, scene_file
from validation import volumes
from validation.closed_forms import glowing, point_light
from validation.closed_forms.case import BLACK, SIZE
from validation.files import write_report
from validation.places import CROSSCHECK, EFFICIENCY, REPORTS, SCENES
from validation.stability import lamps
from validation.stability.case import lamp
from validation.studies import ALONE

LEVEL = 0.95
"""Of the intervals, and of what is known of their coverage."""
LEAST = 0.9
"""A coverage that is surely below fails: few skewed numbers cost some percent, see src/analysis/interval.rs."""
FAIR = (0.8, 1.25)
"""Printed noise over the spread of the error."""
PATHS = {"pt": "--integrator pt", "bdpt": "--integrator bdpt"}
BY_LUCK = {"hit": "--integrator pt --strategies hit", "bdpt": PATHS["bdpt"]}
"""Light that only walks find which run into a small lamp: most pixels see none."""


@dataclass(frozen=True)
class Known:
    """A scene whose image is known, and who renders it; the second is compared with the first."""

    about: str
    scene: Scene
    truth: np.ndarray | float
    contenders: dict[str, str]


@dataclass(frozen=True)
class Coverage:
    """How many intervals hold the truth."""

    scene: str
    contender: str
    what: str
    truth: float
    hits: int
    count: int

    @property
    def interval(self) -> tuple[float, float]:
        """Of the probability to hold it (Clopper and Pearson)."""
        found = stats.binomtest(self.hits, self.count).proportion_ci(LEVEL)
        return float(found.low), float(found.high)

    @property
    def verdict(self) -> str:
        low, high = self.interval
        return "holds" if low <= LEVEL <= high else "FAILS" if high < LEAST else "short" if high < LEVEL else "long"


@dataclass(frozen=True)
class Noise:
    """Of renders by as many seeds, the noise printed and how far they are spread, both relative and by luminance."""

    scene: str
    spp: int
    seeds: int
    printed: float
    """Root of its mean square."""
    spread: float
    typical: float
    """The median of the noise printed."""
    trimmed: float
    """The spread without the worst 0.1 % of pixels, one at least."""
    doubted: int
    """Renders that say that few bright samples carry their noise."""

    @property
    def ratio(self) -> float:
        return self.printed / self.spread

    @property
    def holds(self) -> bool:
        return FAIR[0] <= self.ratio <= FAIR[1]


@dataclass(frozen=True)
class Effort:
    """How much is rendered."""

    studies: int = 200
    seeds: int = 8
    """Of each study: as many as `tyndall study` has by default."""
    renders: int = 24
    scenes: int = 12


NOISY = (
    (SCENES / "lampbox_up.xml", 32), (SCENES / "foggy_room.json", 32), (SCENES / "church.json", 16), (SCENES / "fireplace.json", 32),
    (CROSSCHECK / "sun_through_smoke.json", 32), (CROSSCHECK / "glass_ball_of_fog.json", 64), (CROSSCHECK / "five_lights.json", 32),
    (CROSSCHECK / "bsdf_glass.json", 64), (EFFICIENCY / "cloud.xml", 16), (EFFICIENCY / "pool.xml", 64), (EFFICIENCY / "keyhole.xml", 64),
    (EFFICIENCY / "candles.xml", 32),
)  # fmt: skip
"""Scenes, and samples per pixel of their renders."""
SIDE = 40
LONG = 32
"""Times the samples of a render that its reference has: squares of single renders would be too great below their variance."""
TRIMMED = 0.001
HARDLY_KNOWN = 0.25
"""The uncertainty of the noise above which the program says that few bright samples carry it (src/cli/progress.rs)."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("--quick", action="store_true", help="a twentieth of it")
    command.add_argument("--workers", type=int, default=2, help="studies and renders at once (default %(default)s)")
    command.add_argument("--output", type=Path, default=REPORTS, help="folder for intervals.md and .json (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Measures, writes, and judges."""
    volumes.write()
    effort = Effort(studies=10, renders=8, scenes=3) if options.quick else Effort()
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder, ThreadPoolExecutor(options.workers) as workers:
        coverages = [found for known in scenes() for found in covered(known, effort, Path(folder), workers)]
        noises = [noise(path, spp, effort.renders, Path(folder), workers) for path, spp in NOISY[: effort.scenes]]
    found = {
        "coverage": [{**asdict(one), "interval": one.interval, "verdict": one.verdict} for one in coverages],
        "noise": [{**asdict(one), "ratio": one.ratio} for one in noises],
    }
    write_report("intervals", "Are printed intervals and noise honest?", page(coverages, noises, effort), found, options.output)
    return all(one.verdict != "FAILS" for one in coverages) and all(one.holds for one in noises)


def scenes() -> list[Known]:
    """Little noise, some, and much that few samples carry."""
    even = glowing.equilibria()[0]
    plugin, phase = point_light.PHASES["hg 0.7"]
    bulb = {"type": "sphere", "center": lamps.PLACE.tolist(), "radius": BULB, "bsdf": BLACK, "emitter": lamp(1 / (np.pi * BULB**2))}
    floor = lamps.lit_floor("a small lamp", bulb, lamps.FLOOR_VIEW)
    return [
        Known("a glowing ball in equilibrium with the sky", even.scene, even.truth, PATHS),
        Known("fog lit by a point, scattered once", point_light.lit("hg 0.7", plugin), point_light.image(phase), PATHS),
        Known("a floor that a small lamp lights", floor, lamps.lit_image("sphere"), BY_LUCK),
    ]


SPP = 4
BULB = 0.05
"""Radius of the small lamp: spheres light a floor as points do, as long as all of them is above it."""


def covered(known: Known, effort: Effort, folder: Path, workers: ThreadPoolExecutor) -> Iterator[Coverage]:
    """Coverage of all that a study says of a scene."""
    folder = folder / known.scene.name.replace(" ", "_")
    folder.mkdir()
    exr.write_image(folder / "truth.exr", np.broadcast_to(known.truth, (SIZE, SIZE, 3)))
    path = scene_file(known.scene, folder)
    for words, of in ((own(known), OF_RENDERS), (paid(known, folder), OF_RATIOS)):
        study = partial(studied, path, [*words, "--spp", str(SPP), "--seeds", str(effort.seeds)], effort.seeds, folder)
        studies = list(workers.map(study, range(effort.studies)))
        for index, name in enumerate(known.contenders):
            for what, (interval, truth) in of.items():
                told = [interval(study[index]) for study in studies]
                if None not in told:
                    yield coverage(known.about, name, what, told, truth([study[index] for study in studies], [study[0] for study in studies]))


def coverage(scene: str, contender: str, what: str, told: Sequence[dict[str, float]], truth: float) -> Coverage:
    """Of intervals as they are told."""
    hits = sum(one["low"] <= truth <= one["high"] for one in told)
    return Coverage(scene, contender, what, truth, hits, len(told))


def own(known: Known) -> list[str]:
    """Contenders as users name them."""
    return [word for name, options in known.contenders.items() for word in ("--contender", f"{name}: {options}")]


def paid(known: Known, folder: Path) -> list[str]:
    """The same as programs that report their samples as their seconds: what is made of both then depends on no clock."""
    script = folder / "render.sh"
    script.write_text(SCRIPT)
    line = shlex.join(["sh", str(script), "{scene}", "{seed}", "{spp}", "{out}", str(program.binary())])
    return [*ALONE, *(word for name, options in known.contenders.items() for word in ("--external", f"{name}: {line} {options}"))]


SCRIPT = """scene=$1 seed=$2 spp=$3 out=$4 program=$5
shift 5
"$program" render "$scene" --seed "$seed" --spp "$spp" -o "$out" --threads 1 --quiet "$@" && echo "{\\"spp\\": $spp, \\"seconds\\": $spp}"
"""


def studied(path: Path, words: list[str], seeds: int, folder: Path, number: int) -> list[dict[str, Any]]:
    """What a small study says of each contender; no two share a seed."""
    with tempfile.TemporaryDirectory(dir=folder) as output:
        more: dict[str, program.Option] = {"seed": number * seeds, "doublings": 1, "threads": 1, "reference": folder / "truth.exr", "reference_error": 0}
        program.call([str(program.binary()), "--quiet", "study", str(path), *words, *program.flags({**more, "confidence": LEVEL, "output": output})])
        [scene] = json.loads(Path(output, "study.json").read_text())["scenes"]
    return [{**one, **one["points"][-1]} for one in scene["contenders"]]


def pooled(studies: Sequence[dict[str, Any]], what: str) -> float:
    """The mean of all studies."""
    return float(np.mean([study[what]["mean"] for study in studies]))


Truth = Callable[[Sequence[dict[str, Any]], Sequence[dict[str, Any]]], float]
"""From what studies say of a contender, and of the first one."""
OF_RENDERS: dict[str, tuple[Callable[[dict[str, Any]], Any], Truth]] = {
    "difference": (lambda one: one["difference"], lambda those, first: 0.0),
    "relMSE": (lambda one: one["relmse"], lambda those, first: pooled(those, "relmse")),
}
OF_RATIOS: dict[str, tuple[Callable[[dict[str, Any]], Any], Truth]] = {
    "ratio": (lambda one: one.get("ratio"), lambda those, first: pooled(first, "relmse") / pooled(those, "relmse")),
}
"""What is told, and its truth, which is that of all studies together where no theory knows it."""


def noise(path: Path, spp: int, renders: int, folder: Path, workers: ThreadPoolExecutor) -> Noise:
    """Printed noise of one scene, and the truth."""
    shot = partial(rendered, path, folder)
    long = workers.submit(shot, LONG * spp, renders)
    images, said = zip(*workers.map(partial(shot, spp), range(renders)))
    errors = np.array([one["relative_error"] for one in said])
    terms = np.sort(relative_variance(np.array(images), long.result()[0]).ravel())
    kept = len(terms) - max(1, round(TRIMMED * len(terms)))
    doubted = sum(one["relative_error_uncertainty"] >= HARDLY_KNOWN * one["relative_error"] for one in said)
    spread, trimmed = (float(np.sqrt(part.mean())) for part in (terms, terms[:kept]))
    return Noise(path.stem, spp, renders, float(np.sqrt(np.mean(errors**2))), spread, float(np.median(errors)), trimmed, doubted)


def relative_variance(images: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Variance of each pixel of luminance images over its square and a hundredth of that of the mean, as in `tyndall render`."""
    return images.var(axis=0, ddof=1) / (reference**2 + 0.01 * reference.mean() ** 2)


def rendered(path: Path, folder: Path, spp: int, seed: int) -> tuple[np.ndarray, dict[str, Any]]:
    """The luminance of an image, and what is said of it."""
    with tempfile.TemporaryDirectory(dir=folder) as output:
        image = Path(output, "image.exr")
        options: dict[str, program.Option] = {"spp": spp, "seed": seed, "size": f"{SIDE}x{SIDE}", "threads": 1, "json": True, "output": image}
        told = json.loads(program.call([str(program.binary()), "render", str(path), *program.flags(options)]).stdout)
        return exr.read_image(image) @ exr.XYZ_OF_RGB[1], told


def page(coverages: list[Coverage], noises: list[Noise], effort: Effort) -> str:
    """The report."""
    verdicts = Counter(one.verdict for one in coverages)
    fair = sum(one.holds for one in noises)
    return "\n".join([
        f"## Intervals of studies\n\n{effort.studies} studies of each scene, {effort.seeds} seeds and {SPP} samples per pixel each, {SIZE} x {SIZE} pixels, no seed twice. How many "
        f"{100 * LEVEL:g} % intervals hold the truth, which is known (`difference`: 0) or that of all studies together. `ratio` is relMSE x samples of the "
        f"scene's first over that of the second, by `--external`. In brackets: what the share may be, with {100 * LEVEL:g} % confidence (Clopper and Pearson). It holds where "
        f"{LEVEL:g} lies in it, and fails where all of it is below {LEAST:g}.\n",
        "| scene | contender | interval of | truth | held | share | |", f"|{'---|' * 7}",
        *(f"| {one.scene} | {one.contender} | {one.what} | {one.truth:.4g} | {one.hits} of {one.count} | {share(one)} | {one.verdict} |" for one in coverages),
        f"\n{', '.join(f'{count} {verdict}' for verdict, count in sorted(verdicts.items()))}.\n",
        f"## Noise of renders\n\n{effort.renders} renders of each scene, {SIDE} x {SIDE} pixels: the noise that `tyndall render` prints (`relative_error`, the root of its mean square) "
        f"over the spread of the images over seeds. Wanted: {FAIR[0]:g} to {FAIR[1]:g}. Beside it, the median of the noise over the spread without the worst 0.1 % of pixels, where "
        "fireflies are; and how many renders say that few bright samples carry their noise.\n",
        "| scene | samples | spread | printed | ratio | typical | said so | |", f"|{'---|' * 8}",
        *(f"| {one.scene} | {one.spp} | {100 * one.spread:.3g} % | {100 * one.printed:.3g} % | {one.ratio:.2f} | {one.typical / one.trimmed:.2f} | "
          f"{one.doubted} of {one.seeds} | {'holds' if one.holds else 'FAILS'} |" for one in noises),
        f"\n{fair} of {len(noises)} hold.\n",
    ])  # fmt: skip


def share(one: Coverage) -> str:
    """The share of intervals that hold the truth, with its own."""
    low, high = one.interval
    return f"{one.hits / one.count:.3f} [{low:.3f}, {high:.3f}]"
