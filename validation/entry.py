"""Entry of this package's commands: any bare Python 3.11+ makes the environment they need, then runs them in it."""

import importlib
import sys

from validation import environment
from validation.failure import Failure


def run(package: str, interrupted: str) -> None:
    """Runs the commands of `package`, and says `interrupted` where Ctrl-C ends them."""
    try:
        environment.enter(package)
        cli = importlib.import_module(f"{package}.cli")  # only importable inside the environment
        sys.exit(cli.main(sys.argv[1:]))
    except KeyboardInterrupt:
        print(interrupted, file=sys.stderr)
        sys.exit(130)
    except Failure as failure:
        print(failure, file=sys.stderr)
        sys.exit(2)
