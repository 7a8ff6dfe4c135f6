"""Entry of `python3 -m validation.cluster`."""

import sys

from validation import environment
from validation.failure import Failure

if __name__ == "__main__":
    try:
        environment.enter("validation.cluster")
        from validation.cluster import cli  # only importable inside the environment

        sys.exit(cli.main(sys.argv[1:]))
    except KeyboardInterrupt:
        print("interrupted: the same command goes on", file=sys.stderr)
        sys.exit(130)
    except Failure as failure:
        print(failure, file=sys.stderr)
        sys.exit(2)
