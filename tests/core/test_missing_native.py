# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user reads where the compiled part is missing: it depends on whose copy it is."""

import re
import subprocess
import sys

import pytest
from realmodel.core.base import packages

MINOR = sys.version_info.minor
VERSION = f"3.{MINOR}"
MODULES = {
    "linux-x86_64": "_native.cpython-3{}-x86_64-linux-gnu.so",
    "win-amd64": "_native.cp3{}-win_amd64.pyd",
    "macosx-11.0-arm64": "_native.cpython-3{}-darwin.so",
}


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of the add-on with modules of one system for these minor versions of Python, as one sentence
    about it on another."""

    def explained(*minors, of="linux-x86_64", on="linux-x86_64", checkout=False):
        monkeypatch.setattr(packages.sysconfig, "get_platform", lambda: on)
        package = tmp_path / "addon" / "realmodel"
        package.mkdir(parents=True)
        for minor in minors:
            (package / MODULES[of].format(minor)).touch()
        if checkout:
            (tmp_path / "scripts").mkdir()
            (tmp_path / "scripts" / "build.sh").touch()
        return packages.explanation(ImportError("GLIBC_9.9 not found"), package)

    return explained


def test_the_advice_for_a_developer_is_to_build(copy):
    text = copy(checkout=True)
    assert f"scripts/build.sh {sys.executable}" in text
    assert f"Python {VERSION} is missing" in text
    assert "GLIBC" not in text, "what Python says of a file that is not there helps nobody"


@pytest.mark.parametrize("system", MODULES)
def test_an_empty_copy_is_to_be_replaced(copy, system):
    assert "install the zip" in copy(on=system)


@pytest.mark.parametrize("system", MODULES)
def test_a_copy_for_other_pythons_names_them(copy, system):
    assert "for Python 3.9, 3.99:" in copy(99, 9, of=system, on=system)


@pytest.mark.parametrize(
    ("system", "advice"),
    [("linux-x86_64", "glibc 2.34"), ("win-amd64", "security"), ("macosx-11.0-arm64", "never been tried")],
)
def test_a_module_that_cannot_be_loaded_says_why(copy, system, advice):
    text = copy(MINOR, 99, of=system, on=system)
    assert "GLIBC_9.9 not found" in text
    assert advice in text


def test_a_copy_for_another_system_names_the_right_zip(copy):
    text = copy(MINOR, of="linux-x86_64", on="win-amd64")
    assert "this copy is for Linux on x86-64" in text
    assert "ends with windows-x64.zip" in text


def test_any_version_of_macos_is_known(copy):
    text = copy(MINOR, of="linux-x86_64", on="macosx-26.1-arm64")
    assert "ends with macos-arm64.zip" in text


def test_a_system_without_a_zip(copy):
    text = copy(MINOR, on="macosx-11.0-x86_64")
    assert "these only: Linux on x86-64, Windows on x64, macOS on Apple's processors" in text


def test_core_can_be_imported_without_it(tmp_path):
    """Nothing but the work itself needs it: the panel has to be able to say so."""
    program = (
        "import sys\n"
        "sys.modules['realmodel._native'] = None\n"  # importing it now raises ImportError
        "from realmodel.core import BuildFailed\n"
        "from realmodel.core.base.work import native_module\n"
        "try:\n"
        "    native_module()\n"
        "except BuildFailed as failure:\n"
        "    sys.exit('Python' not in str(failure))\n"
        "sys.exit('it was there')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONPATH": str(packages.PACKAGE.parent)}, check=False
    )
    assert done.returncode == 0


def test_the_zip_of_extensions_as_an_add_on_names_the_other_one(tmp_path):
    """Both where Blender enables it and where a script builds."""
    addon, source = tmp_path / "realmodel", packages.PACKAGE
    (addon / "wheels").mkdir(parents=True)
    for name in ("__init__.py", "core"):
        (addon / name).symlink_to(source / name)
    text = (source.parents[1] / "scripts" / "packaging" / "make_zip.py").read_text(encoding="utf-8")
    (addon / "_native.py").write_text(re.search(r'NATIVE_OF_WHEEL = b"""\\\n(.*?)"""', text, re.DOTALL)[1])
    program = (
        "import sys, pathlib, realmodel\n"
        "from realmodel.core.base import packages, work\n"
        "packages.PACKAGE = pathlib.Path(realmodel.__file__).parent\n"  # and not where the link leads
        "packages.explanation.__defaults__ = (packages.PACKAGE,)\n"
        "for use in (work.native_module, realmodel.register):\n"
        "    try:\n"
        "        use()\n"
        "    except (work.BuildFailed, RuntimeError) as failure:\n"
        "        print(failure)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    lines = done.stdout.splitlines()
    assert len(lines) == 2
    assert all("install realmodel-VERSION-" in line and "without -extension" in line for line in lines)
