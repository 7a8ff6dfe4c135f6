"""Tyndall from Python (`validation.tyndall`), and what checks it against Mitsuba 3 and against closed forms: run that as
`python3 -m validation` from the repository root."""
