# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages of others, which travel in the add-on or are installed beside it, and the message for a missing
native module, with advice for the user's situation."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import re
import sys
import sysconfig
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from .errors import BuildFailed, UsageError

# The add-on is "realmodel", or has the name of the extension in Blender.
FOLDER = f"{__package__.removesuffix('.core.base')}.vendor"


def vendored(module: str, package: str, purpose: str, by_its_name: bool = False) -> ModuleType:
    """A module of the folder vendor, or else the one that this Python has. by_its_name: its modules import
    one another by its name, so it is the one of this Python, or else that of the folder.

    Raises BuildFailed where there is neither.
    """
    names = (module,) if by_its_name else (f"{FOLDER}.{module}", module)
    for name in names:
        try:
            with _vendor_on_path() if by_its_name else nullcontext():
                return importlib.import_module(name)
        except ModuleNotFoundError as error:
            if error.name not in (name, FOLDER):
                raise BuildFailed(f"{package} cannot be loaded ({error})") from error
    raise BuildFailed(
        f"{purpose} needs the package {package}, which is missing: install it with pip, or run "
        "scripts/build.sh in a clone of the repository"
    )


@contextmanager
def _vendor_on_path() -> Iterator[None]:
    """Within it modules are looked for in the folder vendor, too, after all others."""
    folder = str(PACKAGE / "vendor")
    sys.path.append(folder)
    try:
        yield
    finally:
        sys.path.remove(folder)


# The bounds of pyproject.toml for the packages of extras: from this version on, and below that one.
VERSIONS = {
    "geoh5py": ("0.12.2", None),
    "ifcopenshell": ("0.9.0", None),
    "omf": ("1.0.1", "2"),
    "pandas": ("2", None),
    "pyogrio": ("0.10", None),
    "pyvista": ("0.45", None),
    "rasterio": ("1.4", None),
    "resqpy": ("5.2", None),
    "vtk": ("9.4", None),
}


def extra(module: str, purpose: str, name: str = "notebook") -> Any:
    """A module of an optional package. name: the extra that has it.

    Raises UsageError where it cannot be imported, or is of a version that is not used.
    """
    package = module.partition(".")[0]
    _require_version(package, purpose, name)
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise missing(package, purpose, name, f"which cannot be imported ({error})") from error


def _require_version(package: str, purpose: str, name: str) -> None:
    if package not in VERSIONS:
        return
    try:
        version = importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:  # importing it says whether it is there
        return
    first, beyond = VERSIONS[package]
    if _numbers(version) < _numbers(first) or (beyond and _numbers(version) >= _numbers(beyond)):
        wanted = f"{package}>={first}" + (f",<{beyond}" if beyond else "")
        raise missing(wanted, purpose, name, f"and there is {version}")


def _numbers(version: str) -> list[int]:
    """The numbers at the beginning of a version: [0, 9, 0] of 0.9.0.post1."""
    matched = re.match(r"\d+(\.\d+)*", version)
    return [int(part) for part in matched[0].split(".")] if matched else []


def omf_library(purpose: str) -> Any:
    """The package omf. Raises UsageError where it cannot be imported."""
    with quiet():
        return extra("omf", purpose, "omf")


@contextmanager
def quiet() -> Iterator[None]:
    """Silences Python's deprecation warnings about old packages."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def require_extra(module: str, name: str, purpose: str) -> None:
    """Raises UsageError where a module of an optional package is not installed; it is not imported."""
    if importlib.util.find_spec(module) is None:
        raise missing(module, purpose, name)
    _require_version(module, purpose, name)


def missing(package: str, purpose: str, name: str, cause: str = "which cannot be imported") -> UsageError:
    """The error with the extra of a missing package, whose versions may be with it. cause: what is wrong."""
    text = f"{purpose} needs {package}, {cause}"
    if "bpy" in sys.modules:  # the add-on: it was not installed by pip
        asked = package if package.isidentifier() else f'"{package}"'
        return UsageError(
            f'{text}; install it for Blender\'s Python: "{sys.executable}" -m pip install {asked}'
        )
    return UsageError(f'{text}; install it: pip install "realmodel[{name}]"')


PACKAGE = Path(__file__).resolve().parents[2]
ZIP = "the zip of RealModel"


class System(NamedTuple):
    """A system that has a zip: its name, the platform in the name of the zip, the ending of its modules, and
    the advice where one cannot be loaded."""

    name: str
    platform: str
    module: str  # with the minor version of Python
    advice: str


# By sysconfig.get_platform(), for macOS without its version: the system that the interpreter was built for,
# not the machine that it runs on.
SYSTEMS = {
    "linux-x86_64": System(
        "Linux on x86-64",
        "linux-x64",
        r"cpython-3(\d+)-x86_64-linux-gnu\.so",
        "it needs glibc 2.34, libstdc++ of GCC 11 and libgomp, or newer: install these",
    ),
    "win-amd64": System(
        "Windows on x64",
        "windows-x64",
        r"cp3(\d+)-win_amd64\.pyd",
        "it needs nothing but Windows 10 or newer and Python: see that no security software keeps it from "
        f"being loaded, and install {ZIP} again",
    ),
    "macosx-arm64": System(
        "macOS on Apple's processors",
        "macos-arm64",
        r"cpython-3(\d+)-darwin\.so",
        "it needs macOS 11 or newer, and has never been tried on one: please report this",
    ),
}


def explanation(error: ImportError, package: Path = PACKAGE) -> str:
    """One sentence for the user: what is missing, and what to do.

    error: what importing `_native` raised. package: the folder of the add-on.

    For a developer's copy, which has scripts/build.sh beside it, the advice is to run that. For an installed
    add-on the sentence names the system and the Pythons that it has modules for, or the reason why the module
    for this Python cannot be loaded.
    """
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    system = SYSTEMS.get(re.sub(r"^macosx-[\d.]+-", "macosx-", sysconfig.get_platform()))
    built_for = _versions(package, system) if system else []
    if version in built_for:
        missing = f"the native module for Python {version} cannot be loaded ({error})"
    else:
        missing = f"the native module for Python {version} is missing"
    if (package / "wheels").is_dir() and package.name == __name__.partition(".")[0]:  # no extension
        which = f"realmodel-VERSION-{system.platform}.zip" if system else "the other one"
        return (
            "this zip is for the extensions of Blender 4.2 and newer, and was installed as an add-on, where "
            f"its native module is not found: remove it, and install {which}, without -extension in its name"
        )
    if (package.parents[1] / "scripts" / "build.sh").is_file():
        # Inside Blender sys.executable may be another interpreter than the one that runs.
        python = f"python{version}" if "bpy" in sys.modules else sys.executable
        return f"{missing}; build it with scripts/build.sh {python}"
    if system is None:
        names = ", ".join(other.name for other in SYSTEMS.values())
        return (
            f"{missing}; there are zips for these only: {names}. Build RealModel from source for this system"
        )
    if version in built_for:
        return f"{missing}; {system.advice}"
    if built_for:
        return (
            f"{missing}; this copy is for Python {', '.join(built_for)}: use a Blender with one of these, or "
            "install a newer zip of RealModel"
        )
    for other in SYSTEMS.values():
        if _versions(package, other):
            return (
                f"{missing}; this copy is for {other.name}, and this is {system.name}: remove it, and "
                f"install the zip whose name ends with {system.platform}.zip instead"
            )
    return f"{missing}, as are those for others; remove this copy, and install {ZIP} instead"


def _versions(package: Path, system: System) -> list[str]:
    """The versions of Python that have modules for a system, e.g. ["3.11", "3.13"]."""
    named = [re.fullmatch(rf"_native\.{system.module}", path.name) for path in package.glob("_native.*")]
    return [f"3.{minor}" for minor in sorted({int(match[1]) for match in named if match})]
