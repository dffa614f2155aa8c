#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the notebooks of docs/notebooks and keeps what they print and draw in them.

    build/venv/bin/python scripts/run_notebooks.py [--check] [NOTEBOOK ...]

--check changes nothing: it says where a notebook prints something else than is in it, and ends with status 1.
"""

import argparse
import difflib
import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

ROOT = Path(__file__).resolve().parents[1]
SECONDS = 300  # of a cell, at most


def run(path: Path) -> nbformat.NotebookNode:
    """The notebook as it is when it was run."""
    found = nbformat.read(path, as_version=4)
    NotebookClient(
        found,
        timeout=SECONDS,
        record_timing=False,  # or each run would change the file
        resources={"metadata": {"path": str(path.parent)}},
    ).execute()
    found.metadata.language_info = {"name": "python"}  # its version would change the file, too
    for cell in found.cells:
        if cell.cell_type == "code":
            cell.outputs = [_kept(output) for output in cell.outputs if output.get("name") != "stderr"]
    return found


def _kept(output: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """An output without what is there twice, or says how the machine was."""
    if "data" in output:
        output.metadata.clear()
        output.data.pop("image/jpeg", None)
    return output


def printed(notebook: nbformat.NotebookNode) -> list[str]:
    """The lines that its cells print, and the texts of what they show; of pictures there is none."""
    lines = []
    for number, cell in enumerate(notebook.cells):
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            shown = "" if "image/png" in data else data.get("text/plain", "")
            lines += [f"{number}: {line}" for line in (output.get("text", "") + shown).splitlines()]
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true")
    parser.add_argument("notebooks", nargs="*", type=Path)
    options = parser.parse_args()
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT / "addon"), os.environ.get("PYTHONPATH", "")])
    differ = False
    for path in options.notebooks or sorted(ROOT.glob("docs/notebooks/*.ipynb")):
        found = run(path)
        if options.check:
            lines = printed(nbformat.read(path, as_version=4)), printed(found)
            for line in difflib.unified_diff(*lines, f"in {path}", "now", lineterm=""):
                differ = True
                print(line)
        else:
            nbformat.write(found, path)
            print(path)
    return int(differ)


if __name__ == "__main__":
    sys.exit(main())
