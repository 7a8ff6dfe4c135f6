"""Tests of the package itself, run by `python3 -m validation test`."""
