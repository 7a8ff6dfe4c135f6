"""The example notebooks run, cell by cell, in a kernel of Jupyter, and show pictures."""

import os
from pathlib import Path
from typing import Any

import nbclient
import nbformat
import pytest

from validation.places import PYTHON

NOTEBOOKS = sorted((PYTHON / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run_and_show_pictures(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(PYTHON), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    notebook: Any = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "outputs are not kept in the repository"
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert any("samples/pixel, noise" in output.get("text", "") for output in outputs), "no bar was shown"
    assert not any("Warning" in output.get("text", "") for output in outputs), outputs


def test_there_is_one_for_each_use() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["fog", "mitsuba", "variance"]
