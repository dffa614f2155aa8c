# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the repository, the outside checker and the real data lie; imports what is outside the repository."""

import importlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CORPUS = ROOT / "tests" / "data" / "stacks"
SHARED = ROOT.parent / "shared"
CHECK = SHARED / "check"
REAL_DATA = SHARED / "data"

CHECK_ABSENT = f"the outside checker is not at {CHECK}"
DATA_ABSENT = f"the real data are not at {REAL_DATA}"


def checker():
    """The outside checker's module cell_complex, or None where it is absent."""
    return _outside("cell_complex")


def closed_form():
    """The outside checker's module closed_form, or None where it is absent."""
    return _outside("closed_form")


def _outside(name):
    if not (CHECK / f"{name}.py").is_file():
        return None
    if str(CHECK) not in sys.path:
        sys.path.append(str(CHECK))
    return importlib.import_module(name)


def native():
    """The compiled module, found without anything having been installed."""
    if str(ROOT / "addon") not in sys.path:
        sys.path.insert(0, str(ROOT / "addon"))
    return importlib.import_module("realmodel._native")
