"""Who is timed in a study. Each loads and compiles when it first renders, and tells how long that took."""

import time
from abc import ABC, abstractmethod
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from validation import mitsuba, tyndall
from validation.contenders import WAVEFRONT
from validation.failure import Failure
from validation.scene import Scene
from validation.study import tree

Timed = tuple[np.ndarray, float]
"""An image and the seconds that rendering it took."""
Size = tuple[int, int] | None

OURS = ("bdpt", "pt", "lt")
KINDS = ("volpath", "volpathmis")
VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
SEEDS_OF_PASSES = 100_000
"""So many passes of a long render have seeds of their own."""


class Rival(ABC):
    """One way of rendering one scene."""

    name: str
    """As shown."""
    load_seconds: float | None = None
    """Known after the first render."""

    @property
    def slug(self) -> str:
        """As in file names."""
        return self.name.replace(" ", "-").replace(":", "-")

    @abstractmethod
    def render(self, spp: int, seed: int) -> Timed:
        """An image that no other seed gives. What is not finite in it is kept: it is told, and ends no study."""


class TyndallRival(Rival):
    """One of Tyndall's integrators, after a colon perhaps a tracker that all media shall use."""

    def __init__(self, scene: Scene, method: str, size: Size, threads: int):
        self.name, self.scene, self.size, self.threads = f"tyndall {method}", scene, size, threads
        self.integrator, _, self.tracker = method.partition(":")

    def render(self, spp: int, seed: int) -> Timed:
        options: dict[str, Any] = {"integrator": self.integrator, "tracker": self.tracker or None, "must_be_finite": False}
        done = tyndall.run(self.scene, spp=spp, seed=seed, size=self.size, threads=self.threads, **options)
        if self.load_seconds is None:
            self.load_seconds = done.report.get("load_seconds")
        return done.image, done.render_seconds


class MitsubaRival(Rival):
    """One of Mitsuba's path tracers in one of its variants, with the depths of the scene's own integrator."""

    def __init__(self, scene: Scene, kind: str, variant: str, size: Size):
        self.name, self.scene, self.kind, self.variant, self.size = f"mitsuba {kind} {variant}", scene, kind, variant, size
        self.loaded: Any = None
        self.integrator: Any = None

    def render(self, spp: int, seed: int) -> Timed:
        if self.loaded is None:
            self.load()
        return self.timed(spp, seed)

    def load(self) -> None:
        """Reads the scene and, in compiled variants, compiles both kernels there are: for numbers of samples that are
        powers of two, and for others."""
        start = time.perf_counter()
        self.loaded = mitsuba.load(self.scene, self.variant, self.size)
        self.integrator = mi.load_dict(tree.path_integrator(tree.tree(self.scene), self.kind))
        taken = time.perf_counter() - start
        for spp in (2, 3) if self.variant.startswith("llvm") else ():
            first, second = self.timed(spp, 0)[1], self.timed(spp, 0)[1]
            taken += max(first - second, 0.0)  # the first compiles, if no earlier run has
        self.load_seconds = taken

    def timed(self, spp: int, seed: int) -> Timed:
        """An image; compiled variants hold all samples of a pass at once, so that long ones are rendered in parts."""
        mitsuba.use(self.variant)
        width, height = self.loaded.sensors()[0].film().size()
        most = max(1, WAVEFRONT // (int(width) * int(height))) if self.variant.startswith("llvm") else spp
        start = time.perf_counter()
        total = np.zeros((int(height), int(width), 3))
        for number, done in enumerate(range(0, spp, most)):
            part = min(most, spp - done)
            total += part * mitsuba.image(self.loaded, part, SEEDS_OF_PASSES * seed + number, self.integrator)
        dr.sync_thread()
        return total / spp, time.perf_counter() - start


def known() -> list[str]:
    """All names that `rivals` understands; a tracker may follow the first ones after a colon."""
    return [*OURS, *(f"{kind}:{variant}" for kind in KINDS for variant in VARIANTS)]


def rivals(scene: Scene, names: list[str], size: Size, threads: int) -> list[Rival]:
    """All that were asked for, nothing loaded yet."""
    dr.set_thread_count(threads)
    return [rival(scene, name, size, threads) for name in names]


def rival(scene: Scene, name: str, size: Size, threads: int) -> Rival:
    """One of them."""
    first, _, second = name.partition(":")
    if first in OURS:
        return TyndallRival(scene, name, size, threads)
    if first in KINDS and second in VARIANTS:
        return MitsubaRival(scene, first, second, size)
    raise Failure(f"{name}: no such contender", f"choose among {', '.join(known())}")


def unusual(scene: Scene) -> dict[str, str]:
    """Who is left out unless asked for, and why."""
    lt = {} if tree.light_tracing_applies(tree.tree(scene)) else {"lt": "light walks cannot find all of the light here"}
    llvm = {} if mitsuba.libllvm() else {name: "no LLVM is installed" for name in known() if "llvm" in name}
    return lt | llvm


def usual(scene: Scene) -> list[str]:
    """All that can render the scene: light tracing only where it applies, compiled variants only where LLVM is."""
    return [name for name in known() if name not in unusual(scene)]
