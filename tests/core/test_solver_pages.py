# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/simulation.md: the chapter of each solver leads from a project file to the picture that it shows."""

import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from solvers import ogs_program, run_mf6

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "simulation.md").read_text(encoding="utf-8")
PIECE = re.compile(
    r"(?P<commands>(?:^ {4}[^\n]*\n)+)"  # what is indented
    r"|^```text\n(?P<printed>.*?)^```$"
    r"|`(?P<name>[\w./]+)`:\n\n```\w*\n(?P<file>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
CHAPTERS = {
    "OpenFOAM": lambda: shutil.which("laplacianFoam"),
    "OpenGeoSys": ogs_program,
    "CalculiX": lambda: shutil.which("ccx") and importlib.util.find_spec("meshio"),
    "MODFLOW": lambda: importlib.util.find_spec("flopy"),
    "OPM Flow": lambda: shutil.which("flow"),
}


def chapter(name):
    return re.search(rf"^## {name}\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)[1]


def as_script(text):
    """The commands and files of a chapter in their order as a script, and what it says that they print."""
    lines, printed = ["set -eu", f'python3() {{ {shlex.quote(sys.executable)} "$@"; }}'], []
    for piece in PIECE.finditer(text):
        if piece["commands"]:
            lines += [line[4:] for line in piece["commands"].splitlines()]
        elif piece["printed"]:
            printed.append(piece["printed"])
        else:
            lines.append(f"mkdir -p {shlex.quote(os.path.dirname(piece['name']) or '.')}")
            lines.append(f"cat >{shlex.quote(piece['name'])} <<'END_OF_FILE'\n{piece['file']}END_OF_FILE")
    return "\n".join(lines), printed


@pytest.mark.parametrize("name", CHAPTERS)
def test_the_chapter_leads_to_its_picture(name, tmp_path):
    pytest.importorskip("pyvista", reason="PyVista is absent: scripts/test.sh installs it")
    if not CHAPTERS[name]():
        pytest.skip(f"{name} is absent: scripts/install_dependencies.sh solvers, scripts/test.sh")
    image = pytest.importorskip("PIL.Image", reason="Pillow is absent: scripts/test.sh installs it")
    for part in ("blend_samples", "build_model.py"):
        (tmp_path / part).symlink_to(ROOT / part)
    script, printed = as_script(chapter(name))
    assert script.count("END_OF_FILE") == 2 * chapter(name).count("```") / 2 - 2 * len(printed)
    # PyVista asks for a display where there is none, and OpenFOAM's programs come before OpenGeoSys'
    environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "PYTHONPATH")}
    environment["PATH"] = f"{environment['PATH']}:{Path(sys.executable).parent}"
    run = subprocess.run(
        ["bash", "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
    )
    assert run.returncode == 0, run.stdout[-2000:] + run.stderr[-2000:]
    assert len(printed) == 1
    for text in printed:
        assert text in run.stdout
    if name == "OpenFOAM":
        assert "Mesh OK." in run.stdout
    if name == "MODFLOW":
        check_flow(tmp_path)
        if shutil.which("mf6"):
            run_mf6(tmp_path)
    shown = re.findall(r"!\[[^]]*\]\(images/simulation/([\w.]+)\)", chapter(name))
    assert len(shown) == 1
    made = np.asarray(image.open(tmp_path / shown[0]).convert("RGB"), float)
    kept = np.asarray(image.open(ROOT / "docs" / "images" / "simulation" / shown[0]).convert("RGB"), float)
    assert made.shape == kept.shape
    # what draws differs a little from machine to machine; another result or an empty picture differs more
    assert np.abs(made - kept).mean() < 4.0 < np.abs(255 - kept).mean()


def check_flow(folder):
    """FloPy reads back what it wrote, finds no fault, and the packages say what the page says."""
    import flopy

    simulation = flopy.mf6.MFSimulation.load(sim_ws=folder, verbosity_level=0)
    flow = simulation.get_model("flow")
    assert {package.package_type for package in flow.packagelist} == {"disv", "npf", "chd", "ic", "oc"}
    with warnings.catch_warnings():  # its checks will change in the next version
        warnings.simplefilter("ignore", DeprecationWarning)
        found = flow.check(verbose=False, level=0).summary_array
    assert not (found["type"] == "Error").any(), found
    grid, domain = flow.modelgrid, flow.disv.idomain.array
    thickness = -np.diff(np.concatenate([grid.top[None], grid.botm]), axis=0)
    assert (thickness[domain == 1] > 0).all()
    assert (thickness[domain == -1] == 0).all()
    assert (domain != 0).all()  # below the ground what is no cell lets flow through
    conductivity = flow.npf.k.array
    assert set(conductivity[domain == 1]) == {1e-8, 1e-4}
    assert set(conductivity[domain == -1]) <= {1.0}
    heads = flow.chd.stress_period_data.get_data(0)
    assert len(heads) == grid.ncpl
    for (layer, column), head, *_ in heads:
        assert domain[layer, column] == 1
        assert (domain[:layer, column] == -1).all()
        assert head == pytest.approx(grid.top[column])
