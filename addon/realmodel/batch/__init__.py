# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of build_model.py.

options        arguments, checked
run            build, write, print
cuts           sections, fences, boreholes and cuts
probabilities  the same of ensembles
interruption   Ctrl-C while Blender renders or saves
table          the table of volumes
terminal       the progress bar

`options` and this module import nothing of NumPy: build_model.py says itself what is missing.
"""

import sys

IN_BLENDER = "bpy" in sys.modules
DONE, REFUSED, USAGE, TERMINATED, INTERRUPTED = 0, 1, 2, 143, 130  # exit status


def say(line: str, status: int) -> int:
    """Prints a line to standard error; returns the status."""
    print(f"build_model.py: {line}", file=sys.stderr, flush=True)
    return status
