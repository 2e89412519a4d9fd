"""The tutorial runs from its first cell to its last, and every cell that shows a picture has one."""

import nbformat
from conftest import ROOT
from nbclient import NotebookClient


def test_the_tutorial_runs(tmp_path):
    notebook = nbformat.read(ROOT / "examples/python/tutorial.ipynb", as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    pictures = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs
                if "image/png" in output.get("data", {})]
    assert len(pictures) == 6
