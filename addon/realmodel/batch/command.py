# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `realmodel`, which is build_model.py: arguments in, exit status out."""

import contextlib
import os
import signal
import sys
import traceback
from importlib import import_module
from typing import NoReturn

from . import DONE, IN_BLENDER, INTERRUPTED, REFUSED, USAGE, say
from .options import parse
from .terminal import terminate

# By their first argument: the modules with `parse` and `run`; without one of these a project is built.
COMMANDS = {"new": ".new", "check-data": ".check_data"}


def command() -> NoReturn:
    """Runs the command line of this process and ends it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        exit_status = main(_arguments())
    except KeyboardInterrupt:
        exit_status = say("interrupted: nothing was written", INTERRUPTED)
    except Exception:  # a defect: print it in full; Blender hands on this exit status, too
        traceback.print_exc()
        exit_status = REFUSED
    with contextlib.suppress(BrokenPipeError):
        sys.stdout.flush()
    sys.exit(exit_status)


def main(arguments: list[str]) -> int:
    """Runs the command line and returns the exit status."""
    signal.signal(signal.SIGTERM, terminate)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal that lacks a letter of a name stops no build
    if hasattr(signal, "SIGXFSZ"):
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # exceeding the size limit of files becomes an OSError
    name = next((name for name in COMMANDS if arguments[:1] == [name]), None)
    try:
        named = None if name is None else import_module(COMMANDS[name], __package__)
        options = parse(arguments) if named is None else named.parse(arguments[1:])
        from ..core import RealModelError, UsageError
        from .run import run as build
    except SystemExit as leaving:
        return leaving.code or DONE
    except ImportError as error:
        return say(_not_importable(error), REFUSED)
    try:
        return (build if named is None else named.run)(options) or DONE
    except UsageError as error:
        return say(str(error), USAGE)
    except RealModelError as error:
        return say(str(error), REFUSED)
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - nobody listens any more
        return say("standard output was closed; no file was written; use --quiet", REFUSED)
    except MemoryError:
        return say("not enough memory for this model; use fewer triangles or a longer edge length", REFUSED)


def _not_importable(error: ImportError) -> str:
    version = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    if IN_BLENDER:
        return (
            f"Blender's {version} cannot run this: {error}; it uses the modules under {sys.prefix}, of "
            "the first python3 on PATH: install NumPy there, or start Blender with another PATH"
        )
    return f"{version} cannot run this: {error}; it needs Python 3.11 or newer with NumPy"


def _arguments() -> list[str]:
    if IN_BLENDER:
        return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    return sys.argv[2:] if sys.argv[1:2] == ["--"] else sys.argv[1:]
