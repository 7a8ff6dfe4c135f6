"""Where things lie in the repository."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PYTHON = ROOT / "src" / "python"
"""The package `tyndall`."""
SCENES = ROOT / "scenes"
CROSSCHECK = SCENES / "crosscheck"
EFFICIENCY = SCENES / "efficiency"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
ENVIRONMENT = TARGET / "validation-env"
CACHE = TARGET / "validation-cache"
OUTPUT = TARGET / "validation"
REPORTS = ROOT / "validation" / "reports"
RECORDED = ROOT / "validation" / "recorded"
REQUIREMENTS = ROOT / "validation" / "requirements.txt"
REQUIREMENTS_DEV = ROOT / "validation" / "requirements-dev.txt"
"""Those, and what tests the package itself."""
REQUIREMENTS_CLUSTER = ROOT / "validation" / "requirements-cluster.txt"
"""For validation.cluster only: installed on its first use."""
REQUIREMENTS_WHEELS = ROOT / "validation" / "requirements-wheels.txt"
"""For `validation wheels` only."""
