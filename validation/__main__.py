"""Entry: any bare Python 3.11+ makes the environment it needs, then runs the command in it."""

import sys

from validation import environment
from validation.failure import Failure

try:
    environment.enter()
    from validation import cli  # only importable inside the environment

    sys.exit(cli.main(sys.argv[1:]))
except KeyboardInterrupt:
    print("interrupted", file=sys.stderr)
    sys.exit(130)
except Failure as failure:
    print(failure, file=sys.stderr)
    sys.exit(2)
