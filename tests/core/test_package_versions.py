# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages of extras that are too old or too new for us are named with their version."""

import importlib.metadata
import re
import sys
import tomllib
from pathlib import Path

import pytest
from realmodel.core import UsageError
from realmodel.core.base import packages

PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"


def test_the_bounds_are_those_of_the_package():
    extras = tomllib.loads(PYPROJECT.read_text())["project"]["optional-dependencies"]
    bounds = {}
    for asked in (asked for extra in extras.values() for asked in extra):
        name, first, beyond = re.fullmatch(r"([\w-]+)(?:>=([\d.]+))?(?:,<([\d.]+))?", asked).groups()
        if first is not None:
            bounds[name] = first, beyond
    assert bounds == packages.VERSIONS


@pytest.mark.parametrize(
    ("package", "version", "wanted"),
    [
        ("pandas", "1.5.3", "pandas>=2, and there is 1.5.3"),
        ("geoh5py", "0.9.2", "geoh5py>=0.12.2, and there is 0.9.2"),
        ("omf", "2.0.0a1", "omf>=1.0.1,<2, and there is 2.0.0a1"),
        ("omf", "0.9.3", "omf>=1.0.1,<2, and there is 0.9.3"),
        ("ifcopenshell", "0.8.4.post1", "ifcopenshell>=0.9.0, and there is 0.8.4.post1"),
    ],
)
def test_another_version_is_named(monkeypatch, package, version, wanted):
    monkeypatch.setattr(importlib.metadata, "version", lambda name: version)
    with pytest.raises(UsageError, match=re.escape(f"reading it needs {wanted}; install it: pip install")):
        packages.extra(package, "reading it", "x")
    monkeypatch.setitem(sys.modules, "bpy", object())
    with pytest.raises(UsageError, match=r'install it for Blender\'s Python: .* -m pip install "' + package):
        packages.extra(package, "reading it", "x")


@pytest.mark.parametrize("version", ["2", "2.0.1", "3.1.1", "10.0"])
def test_newer_ones_are_taken(monkeypatch, version):
    monkeypatch.setattr(importlib.metadata, "version", lambda name: version)
    monkeypatch.setitem(sys.modules, "pandas", sys)
    assert packages.extra("pandas", "a table") is sys
