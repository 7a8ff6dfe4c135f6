"""Checks Tyndall against Mitsuba 3 and against closed forms. Run as `python3 -m validation` from the repository root."""
