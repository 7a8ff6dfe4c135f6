"""What checks Tyndall against Mitsuba 3 and against closed forms: run it as `python3 -m validation` from the repository root. It
imports the package `tyndall` of this clone (src/python), installed or not."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "src" / "python"))
