"""The command that is running, in words."""

import shlex
import sys


def made_by_command() -> str:
    """The command that makes it again."""
    return shlex.join(["python3", "-m", "validation", *sys.argv[1:]])
