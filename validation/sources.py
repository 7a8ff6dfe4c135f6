"""What recorded numbers depend on: the code that makes samples. Its digest says whether a report is of today's."""

import hashlib
import re
from functools import cache
from pathlib import Path

from validation.places import ROOT

PARTS = ("transport", "learning", "medium", "scene/lights", "bsdf")
"""Folders of `src`."""
NO_CODE = re.compile(r"^#\[cfg\(test\)\]\nmod tests \{.*|//[^\n]*|\s+", re.DOTALL | re.MULTILINE)
"""Tests in a file, which end it, comments, and white space."""


@cache
def digest() -> str:
    """Changes whenever that code does, by more than comments."""
    paths = (path for part in PARTS for path in sorted((ROOT / "src" / part).rglob("*.rs")))
    code = hashlib.sha256()
    for path in paths:
        name = path.relative_to(ROOT / "src")
        if "tests" not in name.parts and name.name != "tests.rs":
            code.update(f"{name}: {bare(path.read_text())}\n".encode())
    return code.hexdigest()[:12]


def bare(source: str) -> str:
    """Without what no program is made of."""
    return NO_CODE.sub("", source)

