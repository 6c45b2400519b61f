"""The notebook docs/laboratory.ipynb runs and prints the outputs that it contains."""
from pathlib import Path

import pytest

pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
NOTEBOOK = Path(__file__).parents[2] / "docs" / "laboratory.ipynb"


def printed(notebook):
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [output.text for output in outputs if output.output_type == "stream"]


def test_notebook_prints_its_recorded_outputs(monkeypatch):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    import raya

    monkeypatch.setenv("PYTHONPATH", str(Path(raya.__file__).parents[1]))
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    recorded = printed(notebook)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    assert recorded and printed(notebook) == recorded
