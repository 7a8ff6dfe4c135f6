"""`python3 -m tyndall denoise IMAGE OUT.exr OUT.png` and `python3 -m tyndall figure FIGURE.json OUT...`: what the program leaves
to Python."""

import argparse
import sys
from pathlib import Path

from tyndall import denoising, figure, picture
from tyndall.failure import Failure


def main(words: list[str]) -> int:
    """Runs the command; the exit code."""
    given = parser().parse_args(words)
    try:
        given.run(given)
    except (Failure, OSError) as failure:
        print(failure.problem if isinstance(failure, Failure) else failure, file=sys.stderr)
        return 2
    return 0


def parser() -> argparse.ArgumentParser:
    """The command line."""
    whole = argparse.ArgumentParser(prog="python3 -m tyndall")
    commands = whole.add_subparsers(required=True)
    denoise = commands.add_parser("denoise", help="denoise an OpenEXR image")
    denoise.add_argument("--check", action="store_true", help="only see whether it can be done")
    denoise.add_argument("image", nargs="?")
    denoise.add_argument("outputs", nargs="*", help="OpenEXR and PNG files to write")
    denoise.add_argument("--view")
    denoise.add_argument("--exposure", type=float)
    denoise.set_defaults(run=denoised)
    drawn = commands.add_parser("figure", help="draw what `tyndall report --figure` describes")
    drawn.add_argument("--check", action="store_true", help="only see whether it can be done")
    drawn.add_argument("description", nargs="?", type=Path)
    drawn.add_argument("outputs", nargs="*", type=Path, help="PDF and PNG files to write")
    drawn.set_defaults(run=draw)
    return whole


def denoised(given: argparse.Namespace) -> None:
    """Denoises an image."""
    denoising.library()
    if not given.check:
        found = denoising.denoised(picture.read(given.image)).shown(given.view, given.exposure)
        for output in given.outputs:
            found.save(output)


def draw(given: argparse.Namespace) -> None:
    """Draws a figure."""
    figure.library()
    if not given.check:
        figure.draw(given.description, given.outputs)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
