# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts of docs/examples print what their docstrings say and draw pictures; all are in the gallery."""

import importlib.util
import os
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from solvers import ogs_program

ROOT = Path(__file__).resolve().parents[2]
DRAWER = runpy.run_path(str(ROOT / "scripts" / "draw_examples.py"))
NAMES = DRAWER["NAMES"]
NEEDED = {"ensemble": ["matplotlib"], "section": [], "tiles": ["pyvista", "distributed"]}
LONGEST = 45  # lines of code, without comments and blank lines


def skip_without_libraries(name):
    for module in ["pandas", "PIL", *NEEDED.get(name, ["pyvista"])]:
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed: scripts/requirements/test.txt")
    if name == "solver" and ogs_program() is None:
        pytest.skip("OpenGeoSys is not installed: scripts/requirements/test.txt")


@pytest.mark.parametrize("name", NAMES)
def test_an_example_prints_what_its_docstring_says_and_draws_a_picture(name, tmp_path):
    skip_without_libraries(name)
    from PIL import Image

    picture = tmp_path / DRAWER["picture_of"](name).name
    run = subprocess.run(
        [sys.executable, DRAWER["script_of"](name), picture],
        env={**os.environ, "PYTHONPATH": str(ROOT / "addon")},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout == DRAWER["printed"](name)
    with Image.open(picture) as drawn, Image.open(DRAWER["picture_of"](name)) as shown:
        # Renderers differ in the last pixels of lines: the picture is the same from far away.
        small = [np.asarray(image.convert("RGB").resize((60, 40)), float) for image in (drawn, shown)]
    assert small[0].std() > 10, "it drew nothing"
    assert abs(small[0] - small[1]).mean() < 6, "the picture in docs/examples/images is of another script"


def test_all_examples_are_in_the_gallery():
    scripts = {path.stem for path in DRAWER["FOLDER"].glob("*.py")}
    assert scripts == {*NAMES, "picture"}
    pictures = {path.name for path in (DRAWER["FOLDER"] / "images").iterdir()}
    assert pictures == {DRAWER["picture_of"](name).name for name in NAMES}
    assert DRAWER["gallery"]() in DRAWER["PAGE"].read_text(encoding="utf-8"), "run scripts/draw_examples.py"


@pytest.mark.parametrize("name", NAMES)
def test_an_example_is_short(name):
    text = DRAWER["script_of"](name).read_text(encoding="utf-8")
    code = text.split('"""', 2)[2].splitlines()
    assert sum(1 for line in code if line.strip() and not line.lstrip().startswith("#")) <= LONGEST
