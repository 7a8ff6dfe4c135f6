"""Truths that take long to make, kept under target/."""

import hashlib
from collections.abc import Callable
from functools import cache

import numpy as np

from tyndall import program
from validation.places import CACHE


def kept(name: str, told: object, make: Callable[[], np.ndarray]) -> np.ndarray:
    """What `make` makes, made again when what is `told` of it changes."""
    path = CACHE / f"{name}-{hashlib.sha256(repr(told).encode()).hexdigest()[:20]}.npy"
    if not path.is_file():
        path.parent.mkdir(parents=True, exist_ok=True)
        np.save(path, make())
    return np.load(path)


@cache
def binary() -> str:
    """Changes whenever the program does."""
    return hashlib.sha256(program.binary().read_bytes()).hexdigest()
