# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebooks of docs/notebooks run, and print what is in them."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted(ROOT.glob("docs/notebooks/*.ipynb"))
DATA = {"ground_investigation": ROOT / "build" / "kai_tak" / "64475_ASD012162.ags"}
NEEDED = ("nbclient", "ipykernel", "pandas", "pyvista", "xarray", "matplotlib", "scipy")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_is_in_it(notebook):
    for module in NEEDED:
        pytest.importorskip(module, reason=f"{module} is not installed: scripts/requirements/test.txt")
    data = DATA.get(notebook.stem)
    if data is not None and not data.exists():
        pytest.skip(f"{data.name} is not here: python3 blend_samples/kai_tak/fetch.py build/kai_tak")
    command = [sys.executable, ROOT / "scripts" / "run_notebooks.py", "--check", notebook]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr[-2000:]


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 3
