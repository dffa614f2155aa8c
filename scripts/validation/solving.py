# SPDX-License-Identifier: GPL-3.0-or-later
"""Solvers on our meshes beside closed forms, and beside one another."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import solvers
import test_solvers
from realmodel.core import build, load_project
from realmodel.core.exporters import save_mesh

ROOT = Path(__file__).resolve().parents[2]
CONDUCTIVITY = {"clay": 0.1, "sand": 1.0}


def solver_results() -> dict:
    """Rows {work, solver, elements, found, expected, of}: of is the closed form or the other solver."""
    absent = [name for name in ("ccx", "laplacianFoam") if shutil.which(name) is None]
    if absent:
        raise SystemExit(f"{', '.join(absent)} absent: scripts/install_dependencies.sh solvers")
    began = time.process_time()
    rows = [*_settlement(), *_flat_heat(), *_hill_heat()]
    for row in rows:
        print(row, flush=True)
    return {"rows": rows, "versions": _versions(), "seconds": round(time.process_time() - began, 1)}


def _row(work, solver, elements, result, expected, of) -> dict:
    return {
        "work": work,
        "solver": solver,
        "elements": elements,
        "found": float(result),
        "expected": float(expected),
        "of": of,
    }


def _settlement():
    """Two layers under their own weight: the top of the mesh, the node that is most off."""
    layers = test_solvers.COLUMN
    expected = test_solvers.settlement(layers)
    for elements in ("prisms", "tetrahedra"):
        with tempfile.TemporaryDirectory() as folder:
            mesh = test_solvers.column(layers).simulation_mesh(
                1.0, 0.1, layer_thickness=1.0, elements=elements
            )
            save_mesh(mesh, Path(folder) / "mesh.inp")
            materials = {name: layer[1:] for name, layer in layers.items()}
            moved = solvers.run_calculix(Path(folder), "mesh.inp", materials, test_solvers.GRAVITY)
        top = mesh.points[:, 2] == sum(layer[0] for layer in layers.values())
        sunk = -moved[top, 2]
        worst = sunk[np.abs(sunk - expected).argmax()]
        yield _row("settlement of two layers, m", "CalculiX", elements, worst, expected, "closed form")


def _flat_heat():
    """Heat through two flat layers in series: area / (sum of height / conductivity)."""
    layers = test_solvers.COLUMN
    model = test_solvers.column(layers)
    resistance = sum(height / CONDUCTIVITY[name] for name, (height, _, _) in layers.items())
    expected = 3.0 * 2.0 / resistance
    for elements, solve, name in (
        ("prisms", solvers.foam_heat, "OpenFOAM"),
        ("tetrahedra", solvers.ogs_heat, "OpenGeoSys"),
    ):
        mesh = model.simulation_mesh(1.0, 0.1, layer_thickness=1.0, elements=elements)
        media = [CONDUCTIVITY[block] for block in mesh.block_names]
        with tempfile.TemporaryDirectory() as folder:
            flow = solve(mesh, Path(folder), media)
        yield _row("flow through two flat layers", name, elements, flow, expected, "closed form")


def _hill_heat():
    """The example two_layers: two solvers that share nothing, on two meshes."""
    model = build(load_project(ROOT / "blend_samples" / "two_layers" / "project.toml"))
    flows = {}
    for elements, solve in (("prisms", solvers.foam_heat), ("tetrahedra", solvers.ogs_heat)):
        mesh = model.simulation_mesh(3.0, 0.48, layer_thickness=1.2, elements=elements)
        with tempfile.TemporaryDirectory() as folder:
            flows[elements] = solve(mesh, Path(folder), test_solvers.MEDIA)
    yield _row(
        "flow through the hill two_layers",
        "OpenFOAM",
        "prisms",
        flows["prisms"],
        flows["tetrahedra"],
        "OpenGeoSys, tetrahedra",
    )


def _versions() -> dict:
    """Of the programs that Debian installs."""

    def first(command, pattern):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        match = re.search(pattern, done.stdout + done.stderr)
        return match[1] if match else "unknown"

    packages = {"CalculiX": "calculix-ccx", "OpenFOAM": "openfoam"}
    return {
        name: first(["dpkg-query", "-W", "-f=${Version}", package], r"^([\w.]+)")
        for name, package in packages.items()
    }
