"""Entry of `python3 -m validation.cluster`."""

from validation import entry

if __name__ == "__main__":
    entry.run("validation.cluster", "interrupted: the same command goes on")
