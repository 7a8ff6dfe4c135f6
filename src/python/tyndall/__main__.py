"""`python3 -m tyndall denoise IMAGE OUT.exr OUT.png`: what the program leaves to Python."""

import argparse
import sys

from tyndall import denoising, picture
from tyndall.failure import Failure


def main(words: list[str]) -> int:
    """Runs the command; the exit code."""
    parser = argparse.ArgumentParser(prog="python3 -m tyndall")
    command = parser.add_subparsers(required=True).add_parser("denoise", help="denoise an OpenEXR image")
    command.add_argument("--check", action="store_true", help="only see whether it can be done")
    command.add_argument("image", nargs="?")
    command.add_argument("outputs", nargs="*", help="OpenEXR and PNG files to write")
    command.add_argument("--view")
    command.add_argument("--exposure", type=float)
    given = parser.parse_args(words)
    try:
        denoising.library()
        if not given.check:
            found = denoising.denoised(picture.read(given.image)).shown(given.view, given.exposure)
            for output in given.outputs:
                found.save(output)
    except Failure as failure:
        print(failure.problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
