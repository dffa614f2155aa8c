# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages of others that travel in the add-on, in the folder vendor (scripts/requirements/vendor.txt). Where
pip installed RealModel, they are its dependencies."""

from __future__ import annotations

import importlib
from types import ModuleType

from .errors import BuildFailed

# The add-on is "realmodel", or has the name of the extension in Blender.
FOLDER = f"{__package__.removesuffix('.core.base')}.vendor"


def vendored(module: str, package: str, purpose: str) -> ModuleType:
    """A module of the folder vendor, or else the one that this Python has. Only what needs it imports it.

    Raises BuildFailed where there is neither.
    """
    for name in (f"{FOLDER}.{module}", module):
        try:
            return importlib.import_module(name)
        except ModuleNotFoundError as error:
            if error.name not in (name, FOLDER):
                raise BuildFailed(f"{package} cannot be loaded ({error})") from error
    raise BuildFailed(
        f"{purpose} needs the package {package}, which is missing: install it with pip, or run "
        "scripts/build.sh in a clone of the repository"
    )
