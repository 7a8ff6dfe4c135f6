"""Entry of `python3 -m validation`."""

from validation import entry

entry.run("validation", "interrupted")
