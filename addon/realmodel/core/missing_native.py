# SPDX-License-Identifier: GPL-3.0-or-later
"""Why the compiled part is not there, and what to do about it, in the words of who is asking."""

import os
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
ZIP = "the zip of RealModel"


def explanation(error: ImportError, package: Path = PACKAGE) -> str:
    """One sentence for the user: what is missing, and what to do.

    error: what importing `_native` raised. package: the folder of the add-on.

    A developer's copy has scripts/build.sh beside it and is told to run it. An installed one is told
    which Pythons it has modules for, or what keeps the one for this Python from being loaded.
    """
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    built_for = _versions(package)
    if version in built_for:
        missing = f"the native module for Python {version} cannot be loaded ({error})"
    else:
        missing = f"the native module for Python {version} is missing"
    if (package.parents[1] / "scripts" / "build.sh").is_file():
        # Inside Blender sys.executable may be another interpreter than the one that runs.
        python = f"python{version}" if "bpy" in sys.modules else sys.executable
        return f"{missing}; build it with scripts/build.sh {python}"
    if not (sys.platform.startswith("linux") and os.uname().machine == "x86_64"):
        return f"{missing}; {ZIP} is for Linux on x86-64 only: build it from source for this system"
    if version in built_for:
        return f"{missing}; it needs glibc 2.35, libstdc++ of GCC 11 and libgomp, or newer: install these"
    if built_for:
        return (
            f"{missing}; this copy is for Python {', '.join(built_for)}: use a Blender with one of these, or "
            "install a newer zip of RealModel"
        )
    return f"{missing}, as are those for others; remove this copy, and install {ZIP} instead"


def _versions(package: Path) -> list[str]:
    """The versions of Python that there are modules for, e.g. ["3.11", "3.13"]."""
    tags = {path.name.split(".")[1].split("-")[1] for path in package.glob("_native.cpython-*")}
    return sorted((f"3.{tag[1:]}" for tag in tags), key=lambda version: int(version[2:]))
