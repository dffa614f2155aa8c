# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages of others. Those that travel in the add-on, in the folder vendor
(scripts/requirements/vendor.txt): where pip installed RealModel, they are its dependencies. And those of its
extras (`realmodel[notebook]`)."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from .errors import BuildFailed, UsageError

# The add-on is "realmodel", or has the name of the extension in Blender.
FOLDER = f"{__package__.removesuffix('.core.base')}.vendor"


def vendored(module: str, package: str, purpose: str) -> ModuleType:
    """A module of the folder vendor, or else the one that this Python has.

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


def extra(module: str, purpose: str, name: str = "notebook") -> Any:
    """A module of an optional package. name: the extra that has it.

    Raises UsageError where it cannot be imported.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise missing(module.partition(".")[0], purpose, name, f" ({error})") from error


def omf_library(purpose: str) -> Any:
    """The package omf. Raises UsageError where it cannot be imported."""
    with quiet():
        return extra("omf", purpose, "omf")


@contextmanager
def quiet() -> Iterator[None]:
    """Within it Python says nothing of what it will no longer have, which old packages use."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def require_extra(module: str, name: str, purpose: str) -> None:
    """Raises UsageError where a module of an optional package is not installed; it is not imported."""
    if importlib.util.find_spec(module) is None:
        raise missing(module, purpose, name)


def missing(package: str, purpose: str, name: str, cause: str = "") -> UsageError:
    """The error that says which extra has a package. cause: of what Python says."""
    text = f"{purpose} needs {package}, which cannot be imported{cause}"
    if "bpy" in sys.modules:  # the add-on: it was not installed by pip
        return UsageError(
            f'{text}; install it for Blender\'s Python: "{sys.executable}" -m pip install {package}'
        )
    return UsageError(f'{text}; install it: pip install "realmodel[{name}]"')
