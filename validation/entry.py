"""Entry of this package's commands: any bare Python 3.11+ makes the environment they need, then runs them in it."""

import importlib
import sys
from typing import NoReturn

from validation import environment


def run(package: str, interrupted: str) -> None:
    """Runs the commands of `package`, and says `interrupted` where Ctrl-C ends them."""
    try:
        environment.enter(package)
    except KeyboardInterrupt:
        stopped(interrupted)
    from tyndall.failure import Failure  # like all that follows, only importable inside the environment

    try:
        cli = importlib.import_module(f"{package}.cli")
        sys.exit(cli.main(sys.argv[1:]))
    except KeyboardInterrupt:
        stopped(interrupted)
    except Failure as failure:
        print(failure, file=sys.stderr)
        sys.exit(2)


def stopped(said: str) -> NoReturn:
    """Ends the program as Ctrl-C does."""
    print(said, file=sys.stderr)
    sys.exit(130)
