"""One picture, or one study, by many processes: Dask distributed carries command lines of `tyndall` to workers.

`job.py` is what is asked for, `parts.py` how it is cut, `task.py` what a worker does, `sums.py` what is there already;
`render.py`, `tiles.py` (to an error) and `study.py` are the drivers, and `farm.py` is all that knows of Dask. README.md is for users.
"""
