"""Renderers that are timed against each other: compile and load time left out on all sides."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import numpy as np

from validation import mitsuba, tyndall
from validation.failure import Failure
from validation.scene import Scene

Timed = tuple[np.ndarray, float]
"""An image and the seconds that rendering it took."""

TYNDALL = ("bdpt", "pt", "lt")
MITSUBA = ("llvm_ad_rgb", "scalar_rgb")
WAVEFRONT = 4_000_000
"""Mitsuba's llvm variants hold all samples of a pass at once; more of them would only cost memory."""


@dataclass(frozen=True)
class Contender:
    """A name and a timed renderer of one scene."""

    name: str
    render: Callable[[int, int], Timed]
    """spp, seed -> image, seconds."""

    def spp_for(self, seconds: float, first: int = 4) -> int:
        """Samples a pixel that take about this long, found by rendering ever longer."""
        spp = first
        while True:
            taken = max(self.render(spp, 0)[1], 1e-3)
            if taken >= seconds / 8 or spp >= 1 << 20:
                return max(1, round(spp * seconds / taken))
            spp = max(2 * spp, round(spp * seconds / taken / 4))


def contenders(scene: Scene, names: tuple[str, ...], threads: int) -> list[Contender]:
    """All that were asked for, ready to render."""
    dr.set_thread_count(threads)
    return [contender(scene, name, threads) for name in names]


def contender(scene: Scene, name: str, threads: int) -> Contender:
    """One of Tyndall's integrators or one of Mitsuba's variants."""
    if name in TYNDALL:
        return Contender(f"tyndall {name}", lambda spp, seed: tyndall_timed(scene, name, threads, spp, seed))
    if name in MITSUBA:
        return mitsuba_contender(scene, name)
    raise Failure(f"{name}: no such renderer", f"choose among {', '.join(TYNDALL + MITSUBA)}")


def tyndall_timed(scene: Scene, integrator: str, threads: int, spp: int, seed: int) -> Timed:
    """Tyndall tells its own time without loading."""
    done = tyndall.run(scene, integrator=integrator, spp=spp, seed=seed, threads=threads)
    return done.image, done.render_seconds


def mitsuba_contender(scene: Scene, variant: str) -> Contender:
    """The scene is loaded now; `spp_for` compiles its kernels before anything is measured."""
    loaded = mitsuba.load(scene, variant)
    height, width = reversed(loaded.sensors()[0].film().size())
    most = max(1, WAVEFRONT // (int(width) * int(height))) if variant.startswith("llvm") else 1 << 30

    def render(spp: int, seed: int) -> Timed:
        mitsuba.use(variant)
        start = time.perf_counter()
        passes = [min(most, spp - done) for done in range(0, spp, most)]
        images = (n * mitsuba.image(loaded, n, 100_000 * seed + i) for i, n in enumerate(passes))
        total = sum(images, np.zeros((int(height), int(width), 3)))
        dr.sync_thread()
        return total / spp, time.perf_counter() - start

    if variant.startswith("llvm"):
        render(most, 0)  # compiles
    return Contender(f"mitsuba {variant}", render)
