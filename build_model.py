#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a model from a project file, without a window.

    blender -b --factory-startup --python-exit-code 1 -P build_model.py -- PROJECT [options]
    python3 build_model.py PROJECT [options]            (then without --blend and --render)

Exit status: 0 done, 1 the input was refused or the build failed (one line on standard error),
2 wrong usage, 130 interrupted. Files appear whole or not at all.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "addon"))

from realmodel.batch.command import command

if __name__ == "__main__":
    command()
