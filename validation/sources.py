"""What recorded numbers depend on: the code that makes samples. Its digest says whether a report is of today's."""

import hashlib
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from validation.places import ROOT

PARTS = ("transport", "learning", "guide", "first_pass", "medium", "scene/lights", "bsdf")
"""Folders of `src`."""
NO_CODE = re.compile(r"^#\[cfg\(test\)\]\nmod tests \{.*|//[^\n]*|\s+", re.DOTALL | re.MULTILINE)
"""Tests in a file, which end it, comments, and white space."""


def paths() -> Iterator[Path]:
    """Its files, without tests."""
    files = (path for part in PARTS for path in sorted((ROOT / "src" / part).rglob("*.rs")))
    return (path for path in files if "tests" not in path.parts and path.name != "tests.rs")


@cache
def digest() -> str:
    """Changes whenever that code does, by more than comments."""
    code = hashlib.sha256()
    for path in paths():
        code.update(f"{path.relative_to(ROOT / 'src')}: {bare(path.read_text())}\n".encode())
    return code.hexdigest()[:12]


def bare(source: str) -> str:
    """Without what no program is made of."""
    return NO_CODE.sub("", source)

