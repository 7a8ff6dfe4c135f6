"""The notebooks run, cell by cell, in a kernel of Jupyter, and are stored with the pictures that they show. TYNDALL_BLESS=1 stores
them anew."""

import os
from pathlib import Path
from typing import Any

import nbclient
import nbformat
import pytest

from validation.places import PYTHON, ROOT

NOTEBOOKS = sorted((PYTHON / "notebooks").glob("*.ipynb"))
LARGEST = 1_000_000
"""Bytes of a notebook with its pictures."""


def outputs(notebook: Any) -> list[Any]:
    """Of all cells."""
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


def pictures(notebook: Any) -> list[int]:
    """How many each cell shows."""
    return [sum("image/png" in output.get("data", {}) for output in cell.get("outputs", [])) for cell in notebook.cells]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run_and_are_stored_with_what_they_show(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(PYTHON), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    stored: Any = nbformat.read(path, as_version=4)
    notebook: Any = nbformat.read(path, as_version=4)
    folder = {"metadata": {"path": str(path.parent)}}
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources=folder, record_timing=False).execute()
    if "TYNDALL_BLESS" in os.environ:
        blessed: Any = nbformat.from_dict({**notebook, "metadata": stored.metadata})
        for cell in blessed.cells:  # bars of progress have gone when they end
            cell.update({"outputs": [o for o in cell.outputs if o.get("name") != "stderr"]} if "outputs" in cell else {})
        nbformat.write(blessed, path)
        stored = blessed
    assert any(pictures(notebook))
    assert any("samples/pixel, noise" in output.get("text", "") for output in outputs(notebook)), "no bar was shown"
    assert not any("Warning" in output.get("text", "") for output in outputs(notebook)), outputs(notebook)
    assert pictures(stored) == pictures(notebook), "TYNDALL_BLESS=1 stores the pictures anew"
    text = path.read_text()
    assert len(text) < LARGEST and str(ROOT) not in text


def test_there_is_one_for_each_use() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["first", "fog", "mitsuba", "variance"]
