"""Mitsuba as a contender of `tyndall study`, by the protocol of its option --external:

    tyndall study scene.xml -o out --external "volpath: python3 -m validation.contender {scene} {definitions}
        --integrator volpath --variant llvm_ad_rgb --seed {seed} --spp {budgets} --folder {folder} --size {size} --threads {threads}"

Writes an image for each number of samples, each going on from the one before, and reports on a line for each the seconds of
rendering, their processor time, and the seconds of starting, loading and compiling. With `--tyndall OPTIONS` it
runs `tyndall render` by these, a process for each image: its pilot and learning are among the seconds."""

import argparse
import json
import os
import shlex
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

STARTED = time.perf_counter()
INTEGRATORS = ("volpath", "volpathmis")
VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
GPU = "cuda_ad_rgb"
WAVEFRONT = {VARIANTS[0]: 4_000_000, GPU: 16_000_000}
"""Compiled variants hold all samples of a pass at once; more of them would only cost memory."""


def main(arguments: list[str]) -> None:
    """Renders one scene with one seed."""
    options = parser().parse_args(arguments)
    if options.tyndall is not None:
        return ours(options)
    import drjit as dr  # only importable inside the environment

    from tyndall.scene import load, open_scene
    from validation import mitsuba

    dr.set_thread_count(options.threads)
    scene = open_scene(options.scene, dict(pair.split("=", 1) for pair in options.D))
    loaded = mitsuba.load(scene, options.variant, options.size)
    import mitsuba as mi

    integrator = mi.load_dict(integrator_like(load(scene), options.integrator))
    if options.variant in WAVEFRONT:
        for spp in (2, 3):  # a kernel for powers of two, and one for other numbers
            mitsuba.image(loaded, spp, 0, integrator)
        dr.sync_thread()
    render(loaded, integrator, options)


def parser() -> argparse.ArgumentParser:
    """The command line."""
    command = argparse.ArgumentParser(prog="python3 -m validation.contender", description="Mitsuba as a contender of tyndall study.")
    command.add_argument("scene", type=Path)
    command.add_argument("--integrator", choices=INTEGRATORS, default=INTEGRATORS[0])
    command.add_argument("--variant", choices=(*VARIANTS, GPU), default=VARIANTS[0])
    command.add_argument("--tyndall", metavar="OPTIONS", help="of `tyndall render`, which renders in Mitsuba's place")
    command.add_argument("--seed", type=int, required=True)
    command.add_argument("--spp", type=lambda text: [int(spp) for spp in text.split(",")], required=True, help="growing numbers, separated by commas")
    command.add_argument("--folder", type=Path, required=True, help="to write SPP.exr to")
    command.add_argument("--size", type=lambda text: tuple(map(int, text.split("x"))), help="WxH instead of the scene's own")
    command.add_argument("--threads", type=int, default=1)
    command.add_argument("-D", metavar="NAME=VALUE", action="append", default=[], help="a parameter of the scene")
    return command


def ours(options: argparse.Namespace) -> None:
    """All numbers of samples by Tyndall."""
    from tyndall import program

    size = options.size and "x".join(map(str, options.size))
    definitions = [word for pair in options.D for word in ("-D", pair)]
    for spp in options.spp:
        image = options.folder / f"{spp}.exr"
        report = image.with_suffix(".json")
        given = program.flags({"output": image, "report": report, "spp": spp, "seed": options.seed, "size": size, "threads": options.threads})
        program.call([str(program.binary()), "--quiet", "render", str(options.scene), *definitions, *given, *shlex.split(options.tyndall)])
        told = json.loads(report.read_text())
        times = {"seconds": told["render_seconds"], "cpu_seconds": told["cpu_seconds"], "load_seconds": told["load_seconds"]}
        print(json.dumps({"spp": spp, **times, "plan": told["plan"]["words"]}), flush=True)


def render(loaded: Any, integrator: Any, options: argparse.Namespace) -> None:
    """All numbers of samples, one after the other."""
    import drjit as dr
    import numpy as np

    from tyndall import exr
    from validation import mitsuba

    load_seconds = time.perf_counter() - STARTED
    width, height = loaded.sensors()[0].film().crop_size()
    wavefront = WAVEFRONT.get(options.variant)
    most = max(1, wavefront // (int(width) * int(height))) if wavefront else max(options.spp)
    total, done, passes, seconds, cpu_seconds = np.zeros((int(height), int(width), 3)), 0, 0, 0.0, 0.0
    for spp in options.spp:
        start, cpu_start = time.perf_counter(), processor_time()
        while done < spp:
            part = min(most, spp - done)
            total += part * mitsuba.image(loaded, part, seed_of(options.seed, passes), integrator)
            done, passes = done + part, passes + 1
        dr.sync_thread()
        seconds += time.perf_counter() - start
        cpu_seconds += processor_time() - cpu_start
        exr.write_image(options.folder / f"{spp}.exr", total / done)
        print(json.dumps({"spp": spp, "seconds": seconds, "cpu_seconds": cpu_seconds, "load_seconds": load_seconds}), flush=True)


def processor_time() -> float:
    """Of all threads of this process and of the children that have ended, user and system (s)."""
    times = os.times()
    return time.process_time() + times.children_user + times.children_system


def seed_of(seed: int, number: int) -> int:
    """Of a pass, in the 32 bits that Mitsuba's seeds have."""
    import numpy as np

    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])


def objects(whole: Any) -> Iterator[dict[str, Any]]:
    """Everything in a scene that has a type, outer things first."""
    if isinstance(whole, dict) and "type" in whole:
        yield whole
    for child in whole.values() if isinstance(whole, dict) else whole if isinstance(whole, list) else ():
        yield from objects(child)


OURS = ("bdpt", "pt", "lt", "fog")
ALL = (*OURS, "path", "volpath", "volpathmis", "ptracer")


def integrator_like(whole: dict[str, Any], kind: str) -> dict[str, Any]:
    """Mitsuba's integrator `kind` with the depths that the scene's own has. Where that is one of Tyndall's, which has no
    Russian roulette, Mitsuba's begins late, which makes it less noisy than by its default."""
    from tyndall.load_dict import translated

    own: dict[str, Any] = next((o for o in objects(whole) if o["type"] in ALL), {"type": "path"})
    theirs = translated({**own, "type": "bdpt"}) if own["type"] in OURS else own
    return {"type": kind, **{key: theirs[key] for key in ("max_depth", "rr_depth", "hide_emitters") if key in theirs}}


if __name__ == "__main__":
    from validation import environment

    environment.enter("validation.contender")
    from tyndall.failure import Failure

    try:
        main(sys.argv[1:])
    except Failure as failure:
        sys.exit(" ".join(failure.problem.split()))
