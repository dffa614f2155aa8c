# SPDX-License-Identifier: GPL-3.0-or-later
"""The package as a whole: one version everywhere, and nothing of Blender until it is asked for."""

import ast
import runpy
import subprocess
import sys
import tomllib
from collections import namedtuple
from pathlib import Path
from types import SimpleNamespace

import pytest
import realmodel
from realmodel import _native

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon" / "realmodel"


def test_one_version_everywhere():
    version = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
    assert version == _native.VERSION
    assert version == ".".join(map(str, realmodel.bl_info["version"]))
    assert version == manifest()["version"]


def manifest():
    with (ADDON / "blender_manifest.toml").open("rb") as file:
        return tomllib.load(file)


def test_the_manifest_says_what_bl_info_says():
    assert manifest()["name"] == realmodel.bl_info["name"]
    assert manifest()["maintainer"] == realmodel.bl_info["author"]
    assert manifest()["id"] == ADDON.name


def test_one_address_everywhere():
    """None, as long as the project has none that is public."""
    about = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert about.get("urls", {}).get("Homepage") == manifest().get("website")


def test_the_package_never_names_itself():
    """As an extension of Blender 4.2 and newer it has another name: bl_ext.user_default.realmodel."""
    for path in ADDON.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module]
            itself = [name for name in names if name.split(".")[0] == "realmodel"]
            assert not itself, f"{path.relative_to(ROOT)}, line {node.lineno}"


def test_bl_info_is_read_without_running_the_add_on():
    """Blender evaluates the literal in the source: names or calls in it would hide the add-on."""
    tree = ast.parse(Path(realmodel.__file__).read_text(encoding="utf-8"))
    (value,) = (
        node.value for node in tree.body if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    )
    assert ast.literal_eval(value) == realmodel.bl_info


def test_import_needs_neither_blender_nor_numpy():
    program = "import sys, realmodel; sys.exit(any(name in sys.modules for name in ('bpy', 'numpy')))"
    addon = str(Path(realmodel.__file__).resolve().parents[1])
    finished = subprocess.run([sys.executable, "-c", program], env={"PYTHONPATH": addon}, check=False)
    assert finished.returncode == 0


def test_an_old_python_is_refused_in_words(monkeypatch):
    """Official builds of Blender 3.4 to 4.0 have Python 3.10: nothing of the add-on can be imported there."""
    old = namedtuple("version_info", "major minor micro")(3, 10, 8)
    monkeypatch.setattr(realmodel, "sys", SimpleNamespace(version_info=old))
    with pytest.raises(RuntimeError, match=r"this Blender has 3\.10: use Blender 4\.1"):
        realmodel.register()


def test_the_stub_of_the_native_module_is_that_of_the_module():
    write_stub = runpy.run_path(str(ROOT / "scripts" / "write_stub.py"))
    assert write_stub["stub"](_native) == write_stub["STUB"].read_text(), "run scripts/write_stub.py"
