# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what docs/validation.md shows, one part after another, and writes the page. See
scripts/validate.sh."""

from __future__ import annotations

import argparse
import functools
import importlib.metadata
import json
import platform
import shutil
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "tests/core", "scripts")]

from realmodel import _native  # noqa: E402, F401  (before SciPy, which may take the room of its libraries)

from . import calibration, exact, fields, holes, page, solving  # noqa: E402

RESULTS = ROOT / "build" / "validation"
PARTS = {
    **{kind: functools.partial(fields.random_histories, kind) for kind in fields.KINDS},
    "folds": fields.folds,
    "moureze": fields.moureze,
    "claudius": fields.claudius,
    "methods": holes.methods,
    "wells": holes.wells,
    "exact": exact.exact,
    "solvers": solving.solver_results,
    "calibration": calibration.calibration,
}
PACKAGES = {
    "GemPy": "gempy",
    "LoopStructural": "LoopStructural",
    "SciPy": "scipy",
    "Manifold": "manifold3d",
    "OpenGeoSys": "ogs",
    "NumPy": "numpy",
}


def measured(name: str) -> None:
    """Measures a part and keeps its result in build/validation."""
    print(f"{name} ...", flush=True)
    began = time.perf_counter()
    result = PARTS[name]()
    result["minutes"] = round((time.perf_counter() - began) / 60, 1)
    (RESULTS / f"{name}.json").write_text(json.dumps(result), encoding="utf-8")
    print(f"{name}: {result['minutes']} minutes", flush=True)


def versions(solvers: dict) -> dict:
    """{program: its version} of all that was measured."""
    programs = {"RealModel": (ROOT / "VERSION").read_text(encoding="utf-8").strip()}
    programs |= {name: importlib.metadata.version(package) for name, package in PACKAGES.items()}
    return {**programs, **solvers, "Python": platform.python_version()}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("part", nargs="*", help=f"measure these again: {', '.join(PARTS)}")
    parser.add_argument("--again", action="store_true", help="measure all parts again")
    options = parser.parse_args()
    if unknown := set(options.part) - PARTS.keys():
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    if options.again:
        shutil.rmtree(RESULTS, ignore_errors=True)
    RESULTS.mkdir(parents=True, exist_ok=True)
    for name in PARTS:
        if name in options.part or (not options.part and not (RESULTS / f"{name}.json").exists()):
            measured(name)
    missing = [name for name in PARTS if not (RESULTS / f"{name}.json").exists()]
    if missing:
        print(f"the page is not written before these parts are measured: {', '.join(missing)}")
        return
    parts = {name: json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8")) for name in PARTS}
    page.write({"versions": versions(parts["solvers"]["versions"]), "parts": parts})


if __name__ == "__main__":
    main()
