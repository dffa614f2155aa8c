# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of build_model.py, which is the command `realmodel` where pip installed the package.

command        from arguments to the exit status
options        arguments, checked
new            a project from data alone
run            build, write, print
cuts           sections, fences, boreholes and cuts
probabilities  the same of ensembles
interruption   Ctrl-C while Blender renders or saves
table          the table of volumes
check_data     the problems in the data of a project
terminal       the progress bar

`command`, `options` and this module import nothing of NumPy: `command` reports what is missing.
"""

import sys
from pathlib import Path

IN_BLENDER = "bpy" in sys.modules
PROGRAM = "realmodel" if Path(sys.argv[0]).stem == "realmodel" else "build_model.py"
DONE, REFUSED, USAGE, TERMINATED, INTERRUPTED = 0, 1, 2, 143, 130  # exit status


def say(line: str, status: int) -> int:
    """Prints a line to standard error; returns the status."""
    print(f"{PROGRAM}: {line}", file=sys.stderr, flush=True)
    return status
