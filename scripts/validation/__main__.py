# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what docs/validation.md shows, one part after another, and writes the page. See
scripts/validate.sh."""

from __future__ import annotations

import argparse
import functools
import importlib.metadata
import json
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("addon", "tests/core", "scripts")]

# ruff: noqa: E402
from realmodel import _native  # noqa: F401  (before SciPy, which may take the room of its libraries)

RESULTS = ROOT / "build" / "validation"


def _parts() -> dict:
    """{name of a part: what measures it}."""
    from . import calibration, exact, fields, holes, solving

    parts = {kind: functools.partial(fields.random_histories, kind) for kind in fields.KINDS}
    return parts | {
        "folds": fields.folds,
        "moureze": fields.moureze,
        "claudius": fields.claudius,
        "methods": holes.methods,
        "wells": holes.wells,
        "exact": exact.exact,
        "solvers": solving.solver_results,
        "calibration": calibration.calibration,
    }


def main():
    parts = _parts()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("part", nargs="*", choices=[*parts, []], help="measure these again; default: what is missing")
    given = parser.parse_args()
    RESULTS.mkdir(parents=True, exist_ok=True)
    for name, measure in parts.items():
        file = RESULTS / f"{name}.json"
        if name not in given.part and (given.part or file.exists()):
            continue
        print(f"{name} ...", flush=True)
        began = time.perf_counter()
        found = measure()
        found["minutes"] = round((time.perf_counter() - began) / 60, 1)
        file.write_text(json.dumps(found), encoding="utf-8")
        print(f"{name}: {found['minutes']} minutes", flush=True)


if __name__ == "__main__":
    main()
