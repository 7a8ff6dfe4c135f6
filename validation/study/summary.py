"""What the renders of a scene amount to: the numbers of `study.json`, the images beside it, and tables."""

import csv
import io
import math
import shutil
from pathlib import Path

import numpy as np

from validation import exr
from validation.files import write_text
from validation.study import intervals
from validation.study.conduct import Found
from validation.study.measures import NAMES
from validation.study.outcome import Contender, Interval, Outcome, Point, Reference, SceneOutcome
from validation.study.rivals import Rival
from validation.study.store import Run, Store


def scene_outcome(found: Found, store: Store, folder: Path) -> SceneOutcome:
    """One scene's entry; its images are written below `folder`."""
    name, (height, width) = found.subject.scene.name, found.truth.image.shape[:2]
    image = f"images/{name}/reference.exr"
    exr.write_image(folder / image, found.truth.image)
    reference = Reference(image, found.truth.how, found.truth.own_relmse)
    contenders = [contender(found, rival, reference, store, folder) for rival in found.rivals]
    return SceneOutcome(name, width, height, reference, contenders, found.notes)


def contender(found: Found, rival: Rival, reference: Reference, store: Store, folder: Path) -> Contender:
    """One contender's entry."""
    place = f"images/{found.subject.scene.name}/{rival.slug}"
    table = runs(found, rival, store)
    relmse, seconds = (np.array([[of(run) for run in row] for row in table]) for of in (error_of, seconds_of))
    last = len(table[0]) - 1
    points = [point(rival, k, [row[k] for row in table], store, folder, place) for k in range(last + 1)]
    is_first = rival is found.rivals[0]
    exr.write_image(folder / place / "variance.exr", variance(rival, last, found.seeds, store))
    return Contender(
        name=rival.name,
        load_seconds=found.load_seconds.get(rival.name),
        points=points,
        slope=intervals.of_slope(relmse, seconds),
        efficiency=intervals.of_efficiency(last_of(found, rival, store)),
        ratio=None if is_first else intervals.of_ratio(last_of(found, found.rivals[0], store), last_of(found, rival, store)),
        variance=f"{place}/variance.exr",
        notes=broken([row[last] for row in table]) + doubts(points[last], reference),
    )


def last_of(found: Found, rival: Rival, store: Store) -> np.ndarray:
    """Errors and seconds at a contender's last budget, (2, seeds)."""
    last = [row[-1] for row in runs(found, rival, store)]
    return np.array([[error_of(run) for run in last], [seconds_of(run) for run in last]])


FAR_ABOVE = 10.0
"""An error this many times that of the reference is nearly all the contender's own."""


def broken(last: list[Run]) -> list[str]:
    """What there is to say of images that are none."""
    count = sum(not math.isfinite(run.measures.mse) for run in last)
    return [f"{count} of its {len(last)} images hold NaN or infinite values"] if count else []


def doubts(last: Point, reference: Reference) -> list[str]:
    """What there is to say of an error that is not much greater than the reference's own."""
    found, own = last.relmse.mean, reference.own_relmse
    if not own or not found < FAR_ABOVE * own:
        return []
    return [f"its relMSE of {found:.3g} is only {found / own:.1f} times the reference's own: part of it is the reference's"]


def error_of(run: Run) -> float:
    return run.measures.relmse


def seconds_of(run: Run) -> float:
    return max(run.seconds, 1e-6)  # a clock may stand still for a render of next to nothing


def runs(found: Found, rival: Rival, store: Store) -> list[list[Run]]:
    """By seed, by budget; only complete rounds."""
    budgets = range(len(found.samples[rival.name]))
    table = [[store.run(rival.slug, budget, seed) for budget in budgets] for seed in range(found.seeds)]
    return [[run for run in row if run] for row in table]


def point(rival: Rival, budget: int, done: list[Run], store: Store, folder: Path, place: str) -> Point:
    """One budget over all seeds; the first seed's image is copied."""
    image = f"{place}/{budget}.exr"
    copied(store.path(rival.slug, budget, 0), folder / image)
    of = {name: interval(name, np.array([getattr(run.measures, name) for run in done])) for name in NAMES}
    return Point(done[0].samples, interval("seconds", np.array([seconds_of(run) for run in done])), **of, image=image)


def interval(name: str, values: np.ndarray) -> Interval:
    """Of a measure: only the difference of means has either sign."""
    return intervals.of_mean(values) if name == "difference" else intervals.of_positive(values)


def copied(source: Path, target: Path) -> None:
    """Copies a file, whole or not at all."""
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_suffix(".partial")
    shutil.copyfile(source, partial)
    partial.replace(target)


def variance(rival: Rival, budget: int, seeds: int, store: Store) -> np.ndarray:
    """Of each value in one render."""
    return np.stack([store.image(rival.slug, budget, seed) for seed in range(seeds)]).var(axis=0, ddof=1)


COLUMNS = ("scene", "contender", "samples", "seed", "seconds", *NAMES)
"""As `src/study/convergence/table.rs` writes them."""


def rows(found: Found, store: Store) -> list[dict[str, object]]:
    """One row a render."""
    return [
        {"scene": found.subject.scene.name, "contender": rival.name, "samples": run.samples, "seed": seed,
         "seconds": run.seconds, **vars(run.measures)}
        for rival in found.rivals
        for seed, row in enumerate(runs(found, rival, store))
        for run in row
    ]  # fmt: skip


def write_csv(path: Path, all_rows: list[dict[str, object]]) -> None:
    """`study.csv`."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: "NaN" if value != value else value for name, value in row.items()} for row in all_rows)
    write_text(path, text.getvalue())


def markdown(outcome: Outcome, figures: str = "") -> str:
    """`study.md`: a table for each scene, after `figures`."""
    head = f"# Error against run time\n\n{figures}{outcome.made_by}; {outcome.machine}; intervals hold {100 * outcome.confidence:.0f} %.\n\n    {outcome.command}\n"
    return head + "".join(map(scene_table, outcome.scenes))


HEADER = (
    "| renderer | samples | seconds | relMSE | worst 0.1 % left out | 1 / (relMSE x s) | times the best of Mitsuba | slope"
    " | mean against reference | load [s] |\n|---|---|---|---|---|---|---|---|---|---|\n"
)


def scene_table(scene: SceneOutcome) -> str:
    """One scene's, at each contender's last budget."""
    own = "unknown" if scene.reference.own_relmse is None else f"{scene.reference.own_relmse:.2g}"
    rivals = [c.efficiency for c in scene.contenders if c.name.startswith("mitsuba")]
    best = max((one for one in rivals if math.isfinite(one.mean)), key=lambda efficiency: efficiency.mean, default=None)
    title = f"\n## {scene.name}, {scene.width} x {scene.height}\n\nReference: {scene.reference.how}; its own relMSE: {own}.\n\n"
    return title + HEADER + "".join(row(c, best) for c in scene.contenders) + notes(scene)


def notes(scene: SceneOutcome) -> str:
    """What the reader should know, as a list."""
    said = [*scene.notes, *(f"{c.name}: {note}" for c in scene.contenders for note in c.notes)]
    return "\n" + "".join(f"- {note}.\n" for note in said) if said else ""


def row(c: Contender, best: Interval | None) -> str:
    """One contender's."""
    p = c.points[-1]
    slope = "" if c.slope is None else spread(c.slope, "{:.2f}")
    load = "" if c.load_seconds is None else f"{c.load_seconds:.2f}"
    times = "" if best is None else spread(ratio(c.efficiency, best), "{:.3g}")
    off = f"{100 * p.difference.mean:+.2f} ± {50 * (p.difference.high - p.difference.low):.2f} %"
    cells = [c.name, p.samples, f"{p.seconds.mean:.2f}", spread(p.relmse), f"{p.trimmed_relmse.mean:.3g}"]
    cells += [spread(c.efficiency), times, slope, off, load]
    return "| " + " | ".join(map(str, cells)) + " |\n"


def spread(interval: Interval, form: str = "{:.3g}") -> str:
    """A mean and its interval."""
    return f"{form} [{form}, {form}]".format(interval.mean, interval.low, interval.high)


def ratio(a: Interval, b: Interval) -> Interval:
    """Of two independent efficiencies: their intervals' half widths in logarithms add as errors do."""
    mean = a.mean / b.mean
    if not all(math.isfinite(end) and end > 0 for i in (a, b) for end in (i.low, i.high)):
        return Interval(mean, math.nan, math.nan)
    half = 0.0 if a is b else math.hypot(*(math.log(i.high / i.low) / 2 for i in (a, b)))
    return Interval(mean, mean * math.exp(-half), mean * math.exp(half))
