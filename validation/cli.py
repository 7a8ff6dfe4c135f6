"""The commands of `python3 -m validation`."""

import argparse
from collections.abc import Callable
from pathlib import Path

from tyndall.failure import Failure
from tyndall.scene import open_scene
from tyndall import judging
from validation import assets, bias, cells, compare, comparison_page, coverage, efficiency, first_passes, full, gallery, growth, instructions, intervals, lottery
from validation import matrix, package_tests, page, progressive, rays, reach, record, references, selftest, thresholds, truths, viewing, wheels
from validation.cluster import cli as cluster
from validation.compare import Effort
from validation.files import made_by_command
from validation.places import OUTPUT

Commands = argparse._SubParsersAction  # argparse gives it no public name
MEASURES = {
    "efficiency": (efficiency, "Time to equal error against Mitsuba and others of our own, as one number a scene."),
    "gallery": (gallery, "Renders the scenes of scenes/gallery, and Mitsuba for the same seconds, for the table of scenes/GALLERY.md."),
    "growth": (growth, "How the cost of a sample grows with depth, triangles, voxels, lights, pixels and threads."),
    "bias": (bias, "Bias of ray marching against its step, in a cosine cloud and a noise cloud."),
    "progressive": (progressive, "Progressive pictures against as many pixels on a regular grid, on four scenes."),
    "first_passes": (first_passes, "First passes, and what is made of them, beside other guides and none: relMSE after the same seconds."),
    "thresholds": (thresholds, "P03T's tests A-F at its own thresholds: time with a guide and without, learning included."),
    "record": (record, "Renews the reports that are out of date, and the tables that pages take from them."),
    "intervals": (intervals, "Whether printed intervals hold the truth as often as they say, and whether printed noise is the image's."),
    "lottery": (lottery, "The default choice of strategies against others, in scenes that nobody made."),
    "wheels": (wheels, wheels.TEXT),
}
"""Commands whose modules know their options."""


def main(arguments: list[str]) -> int:
    """Runs one command; 0 if what it checks holds."""
    options = parser().parse_args(arguments)
    return 0 if options.command(options) else 1


def parser() -> argparse.ArgumentParser:
    """All commands and their options."""
    top = argparse.ArgumentParser(prog="python3 -m validation", description="Checks Tyndall against what is known.")
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    add_compare(commands)
    add_matrix(commands)
    add_closed_forms(commands)
    for name, (module, text) in MEASURES.items():
        module.add_options(add(commands, name, module.run, text))
    add_recorded(commands)
    add_page(commands)
    add_view(commands)
    add_stability(commands)
    add_cluster(commands)
    add_selftest(commands)
    add(commands, "rays", lambda _: rays.run(), "Nanoseconds per ray against Embree, on two meshes.")
    add(commands, "full", lambda _: full.run(), full.TEXT)
    add(commands, "test", lambda _: package_tests.run(), "The tests of this package itself.")
    return top


def add(commands: Commands, name: str, run: Callable[[argparse.Namespace], bool], text: str) -> argparse.ArgumentParser:
    """A command without options."""
    command = commands.add_parser(name, help=text, description=text)
    command.set_defaults(command=run)
    return command


def add_effort(command: argparse.ArgumentParser, default: Effort) -> None:
    """How much to render."""
    command.add_argument("--batches", type=int, default=default.batches, help="independent images (default %(default)s)")
    command.add_argument("--spp", type=int, default=default.spp, help="samples a pixel in each (default %(default)s)")
    command.add_argument("--seed", type=int, default=default.seed, help="first seed (default %(default)s)")


def effort_of(options: argparse.Namespace) -> Effort:
    """What was asked for."""
    if options.batches < 2:
        raise Failure("--batches is below 2: no variance can be known", "give at least 8")
    if options.spp < 1:
        raise Failure(f"--spp is {options.spp}", "give at least 1")
    return Effort(options.batches, options.spp, options.seed)


def add_parameters(command: argparse.ArgumentParser) -> None:
    """XML's $parameters."""
    command.add_argument("-D", metavar="NAME=VALUE", action="append", default=[], help="a parameter of an XML scene")


def parameters_of(options: argparse.Namespace) -> dict[str, str]:
    """What -D gave."""
    wrong = next((pair for pair in options.D if "=" not in pair), None)
    if wrong:
        raise Failure(f"-D {wrong}: no value", "write -D name=value")
    return dict(pair.split("=", 1) for pair in options.D)


def size(text: str) -> tuple[int, int]:
    """WxH."""
    width, height = text.split("x")
    return int(width), int(height)


def add_compare(commands: Commands) -> None:
    command = add(commands, "compare", run_compare, "One scene through Mitsuba and Tyndall, pixel by pixel.")
    command.add_argument("scene")
    command.add_argument(
        "--integrators", default="pt,lt,bdpt", help="any of pt, lt, bdpt, with a tracker as in pt:march if need be, mitsuba (itself with other seeds)"
    )
    command.add_argument("--size", type=size, help="WxH instead of the scene's own")
    command.add_argument("--output", type=Path, default=OUTPUT, help="folder for the pictures")
    add_parameters(command)
    add_effort(command, Effort())


def run_compare(options: argparse.Namespace) -> bool:
    methods, effort, size = reach.methods(options.integrators), effort_of(options), options.size
    scene = open_scene(options.scene, parameters_of(options))
    expected = reach.differences(scene, methods)
    reference = references.cached(scene, options.size)
    print(judging.HEADER, flush=True)
    candidates = {method: compare.candidate_renderer(scene, method, size) for method in methods}
    found = {method: compare.tested(scene, method, effort, reference, candidates[method], options.output, expected[method]) for method in methods}
    page = options.output / f"{scene.name}.html"
    comparison_page.write(comparison_page.page(scene, effort, found), page)
    print(f"pictures (Mitsuba, Tyndall, z from blue -4 to red +4) are in {options.output}, and all there is to see in {page}")
    print(f"made by: {made_by_command()}")
    return all(map(compare.agree, found.values()))


def add_matrix(commands: Commands) -> None:
    command = add(commands, "matrix", run_matrix, "Every cross-check scene through all integrators that can render it.")
    depth = command.add_mutually_exclusive_group()
    depth.add_argument("--quick", dest="depth", action="store_const", const="quick", default="quick", help="against Mitsuba's images in the repository; minutes (default)")
    depth.add_argument("--full", dest="depth", action="store_const", const="full", help="all generated scenes, and Mitsuba renders everything now; hours")
    depth.add_argument("--record", dest="depth", action="store_const", const="record", help="render Mitsuba's images in the repository again")
    command.add_argument("--only", default="", help="only scenes whose name contains this")
    command.add_argument("--guide", action="store_true", help="quick: let all walks follow a guide")
    command.add_argument("--matrix-seed", type=int, default=cells.SEED, metavar="N", help="quick: another sample of the generated scenes, which Mitsuba renders (default %(default)s)")
    add(commands, "coverage", lambda _: coverage.run(), "Which shared plugins no cross-check scene has.")
    add(commands, "assets", lambda _: assets.run(), "Makes the cross-check scenes' images and meshes anew.")


def run_matrix(options: argparse.Namespace) -> bool:
    if options.depth == "quick":
        return matrix.quick(options.only, options.matrix_seed, guide=options.guide)
    return matrix.live(options.only) if options.depth == "full" else matrix.record(options.only)


def add_selftest(commands: Commands) -> None:
    command = add(commands, "selftest", lambda options: selftest.run(effort_of(options)), "The test of the test: Mitsuba against itself, and against 5 %% off.")
    add_effort(command, Effort())


def add_closed_forms(commands: Commands) -> None:
    command = add(commands, "closed-forms", run_closed_forms, "Furnaces, slabs and single scattering against theory.")
    command.add_argument("--integrators", default="", help="instead of all that apply: any of pt, lt, bdpt, mitsuba")
    command.add_argument("--only", default="", help="only cases whose name contains this")
    command.add_argument("--quick", action="store_true", help="without what costs most for what other cases show too")
    add_effort(command, Effort(batches=16, spp=256))


def run_closed_forms(options: argparse.Namespace) -> bool:
    methods = tuple(filter(None, options.integrators.split(",")))
    return truths.run(effort_of(options), methods, options.only, options.quick)


def add_recorded(commands: Commands) -> None:
    command = add(commands, "instructions", run_instructions, "Instructions per sample of three scenes, by valgrind, against those recorded.")
    command.add_argument("--record", action="store_true", help="record them anew")
    command.add_argument("--table", action="store_true", help="instead, what profiles save in scenes that need little: instructions.md")
    command.add_argument("--output", type=Path, help="folder for instructions.md (default: validation/reports)")


def run_instructions(options: argparse.Namespace) -> bool:
    return instructions.table(options.output) if options.table else instructions.run(options.record)


def add_page(commands: Commands) -> None:
    command = add(commands, "page", lambda options: page.run(options.file, options.output, options.if_possible), "A study's page in a headless Chromium: it loads without errors or requests, and its controls work.")
    command.add_argument("file", type=Path, help="study.html")
    command.add_argument("--output", type=Path, default=OUTPUT / "page", help="folder for pictures of it")
    command.add_argument("--if-possible", action="store_true", help="no failure where no Chromium is found")


def add_view(commands: Commands) -> None:
    command = add(commands, "view", lambda options: viewing.run(options.output, options.if_possible), "The page of `tyndall view` in a headless Chromium: it shows a scene that is moved by hand.")
    command.add_argument("--output", type=Path, default=OUTPUT / "view", help="folder for pictures of it")
    command.add_argument("--if-possible", action="store_true", help="no failure where no Chromium is found")


def add_stability(commands: Commands) -> None:
    command = add(commands, "stability", run_stability, "Extremes of every number that a scene gives, each against truth.")
    command.add_argument("--only", default="", help="only lines whose row or case contains this, or A|B")
    command.add_argument("--quick", action="store_true", help="a tenth of the time: many lines are then not decided")
    command.add_argument("--seed", type=int, default=1, help="first seed (default %(default)s)")
    command.add_argument("--workers", type=int, help="lines that are rendered at once, a thread each (default: one for each processor)")
    command.add_argument("--anew", action="store_true", help="render lines again that this very program has rendered before")
    command.add_argument(
        "--perturb", type=float, default=0, metavar="PART", help="make all that is found greater by this part: holds if every line that can see so much refuses it"
    )
    command.add_argument("--output", type=Path, default=OUTPUT / "stability", help="folder for the tables (default %(default)s)")


def run_stability(options: argparse.Namespace) -> bool:
    from validation.stability import run as stability  # it makes scenes' volumes, which no other command needs

    part = 0.1 if options.quick else 1
    effort = stability.Effort(part * stability.BUDGET, part * stability.CAP, options.seed, options.perturb)
    return stability.run(effort, options.output, options.only, options.quick, options.workers, options.anew)


def add_cluster(commands: Commands) -> None:
    text = "Renders and studies by many processes or machines, over Dask distributed; `python3 -m validation.cluster` too."
    command = add(commands, "cluster", lambda options: cluster.main(options.arguments or ["--help"]) == 0, text)
    command.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="render, commands or study, and their options; --help explains them")
