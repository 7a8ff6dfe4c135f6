"""One picture, or one study, by many processes: Dask distributed carries command lines of `tyndall` to workers.

What a part is stands in `parts.py`, what a worker does in `task.py`, what is done with its results in `sums.py` and
`study.py`; `farm.py` is all that knows of Dask. README.md is for users.
"""
