"""What `pip install .` makes, without the minutes that it takes to compile: the package beside the program, away from this
repository. (`pip install .` itself is tried by hand.)"""

import ast
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

from tyndall import program
from validation.places import CROSSCHECK, PYTHON, ROOT

PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())
OF_EXTRAS = {"pyoidn", "matplotlib", "mitsuba", "scipy"}
"""What is imported where it is needed, and said to be missing where it is."""


def imported(file: Path) -> set[str]:
    """The packages that a module imports."""
    nodes = list(ast.walk(ast.parse(file.read_text())))
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    return {name.partition(".")[0] for name in names}


def test_what_is_imported_is_required() -> None:
    found = {name for file in (PYTHON / "tyndall").glob("*.py") for name in imported(file)}
    required = {line.partition(">=")[0] for line in PROJECT["project"]["dependencies"]}
    assert found - set(sys.stdlib_module_names) - {"tyndall"} == required | OF_EXTRAS
    extras = PROJECT["project"]["optional-dependencies"]
    assert "pyoidn" in extras["denoise"][0] and "matplotlib" in extras["figure"][0]


def test_the_wheel_holds_the_package_and_the_program() -> None:
    assert PROJECT["tool"]["maturin"] == {"bindings": "bin", "python-source": os.path.relpath(PYTHON, ROOT)}
    assert PROJECT["project"]["name"] == "tyndall" and (PYTHON / "tyndall" / "py.typed").is_file()


def test_the_package_works_away_from_the_repository(tmp_path: Path) -> None:
    shutil.copytree(PYTHON / "tyndall", tmp_path / "site" / "tyndall")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "tyndall").symlink_to(program.binary().resolve())
    code = f"import tyndall; print(tyndall.program.binary(), tyndall.render({str(CROSSCHECK / 'fog_isotropic.json')!r}, spp=1, size=(4, 4)).shape)"
    kept = {name: value for name, value in os.environ.items() if name not in ("TYNDALL_BINARY", "CARGO_TARGET_DIR")}
    variables = {**kept, "PYTHONPATH": str(tmp_path / "site"), "PATH": f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=variables, capture_output=True, text=True)
    assert done.stdout.strip() == f"{tmp_path / 'bin' / 'tyndall'} (4, 4, 3)", done.stderr
