"""The notebooks: their physics is asserted in their cells, so each is run, and what is stored in them is checked.

`python tests/test_notebooks.py [NAME]...` runs them and stores their outputs again.
"""

from __future__ import annotations

import base64
import io
import sys
import time
from pathlib import Path
from typing import Any

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

DIRECTORY = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(DIRECTORY.glob("*.ipynb"))
SECONDS_A_CELL = 60
MAX_BYTES = 400_000
HEADINGS = ["**What you need.**", "**Units and frames.**", "## What to change next"]


def read(path: Path) -> Any:
    return nbformat.read(path, as_version=4)


def code_cells(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def errors(notebook: Any) -> list[str]:
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    return [output.evalue for output in outputs if output.output_type == "error"]


def pictures(notebook: Any) -> int:
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    return sum("image/png" in output.get("data", {}) for output in outputs)


def run(notebook: Any, directory: Path, seconds: int | None = SECONDS_A_CELL) -> None:
    """Runs all cells in a kernel of this Python. The first error is raised."""
    resources = {"metadata": {"path": str(directory)}}
    client = nbclient.NotebookClient(
        notebook, timeout=seconds, kernel_name="python3", record_timing=False, resources=resources
    )
    client.execute()


def test_all_notebooks_are_there() -> None:
    readme = (DIRECTORY / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in NOTEBOOKS] == ["dice.ipynb", "quadcopter.ipynb", "tennis-racket.ipynb"]
    assert all(f"({path.name})" in readme for path in NOTEBOOKS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_stored_outputs_are_those_of_a_whole_run(path: Path) -> None:
    notebook = read(path)
    nbformat.validate(notebook)
    cells = code_cells(notebook)
    assert path.stat().st_size < MAX_BYTES
    assert errors(notebook) == []
    # Each cell was run, once and in order.
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert pictures(notebook) == sum("plt.show()" in cell.source for cell in cells) > 0
    assert all(cell.outputs for cell in cells if "print(" in cell.source and "def " not in cell.source)
    assert any("assert " in cell.source for cell in cells)
    text = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    assert [heading for heading in HEADINGS if heading not in text] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs_and_its_physics_holds(path: Path, tmp_path: Path) -> None:
    notebook = read(path)
    stored = pictures(notebook)
    for cell in code_cells(notebook):
        cell.outputs, cell.execution_count = [], None
    run(notebook, tmp_path)
    assert errors(notebook) == []
    assert pictures(notebook) == stored


def smaller(png: str) -> str:
    """A picture of 256 colours: less than half of the bytes."""
    from PIL import Image

    picture = Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB")
    few, out = picture.quantize(256, dither=Image.Dither.NONE), io.BytesIO()
    few.save(out, "PNG", optimize=True)
    return base64.b64encode(out.getvalue()).decode()


def store(path: Path) -> None:
    """Runs a notebook and writes it with its outputs. Nothing is written if a cell fails."""
    notebook = read(path)
    begun = time.perf_counter()
    run(notebook, path.parent, seconds=None)
    for cell in code_cells(notebook):
        cell.metadata.clear()
        for output in cell.outputs:
            if "image/png" in output.get("data", {}):
                output.data["image/png"] = smaller(output.data["image/png"])
                output.metadata.clear()
    notebook.metadata["language_info"] = {"name": "python"}
    nbformat.write(notebook, path)
    print(f"{path.name}: {time.perf_counter() - begun:.1f} s, {path.stat().st_size} bytes")


if __name__ == "__main__":
    for notebook_path in NOTEBOOKS:
        if len(sys.argv) == 1 or notebook_path.stem in sys.argv[1:]:
            store(notebook_path)
