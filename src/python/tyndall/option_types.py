"""The options of `tyndall render` with their types, for editors, which complete them, and for type checkers. What they mean is
said by `print(tyndall.options())`; a test holds the names to the program's."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal, TypedDict

Number = int | float


class RenderOptions(TypedDict, total=False):
    """What `tyndall.render` takes beside a scene; None is as good as nothing."""

    spp: int | None
    size: tuple[int, int] | str | None
    time_limit: Number | str | None
    error: Number | None
    confidence: Number | None
    seed: int | None
    threads: int | None
    integrator: Literal["bdpt", "pt", "lt", "fog", "gather", "first-pass", "path", "volpath", "volpathmis", "ptracer"] | None
    strategies: str | Sequence[str] | None
    max_depth: int | None
    min_depth: int | None
    sampler: Literal["sobol", "independent"] | None
    film_samples: Literal["shared", "own", "apart"] | None
    guide: Literal["auto", "always", "never"] | bool | None
    heuristic: str | None
    connections: Literal["cached", "all"] | None
    starts: Literal["emitted", "aimed", "learnt"] | None
    sky: Literal["next-event", "hit"] | None
    basis: Literal["quadtree", "bins", "haar", "links"] | None
    first_pass: Literal["walks", "particles", "links"] | None
    flat: bool | None
    profile: str | None
    tracker: Literal["auto", "closed_form", "exact", "march", "null_collision", "residual_ratio"] | None
    step: Number | None
    march_error: Number | None
    scattering: Literal["multiple", "single", "none"] | None
    soften: Number | None
    forced_interaction: bool | None
    no_forced_interaction: bool | None
    hide_emitters: bool | None
    no_hide_emitters: bool | None
    crop: str | None
    frames: int | str | None
    fps: Number | None
    groups: bool | None
    components: bool | None
    batches: int | None
    view: Literal["standard", "agx", "aces", "linear"] | None
    exposure: Number | Literal["auto"] | None
    progressive: str | None
    fraction: Number | None
    fog_color: str | Sequence[Number] | None
    ambient: str | Sequence[Number] | None
    threshold: Number | None
    preview: bool | None
    tev: str | bool | None
    resume: bool | None
    sums: str | Path | None
    checkpoint: str | Path | None
    sums_every: Number | str | None
    samples: str | None
    sensor: str | int | None
    strict: bool | None
