# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user reads where the compiled part is missing: it depends on whose copy it is."""

import subprocess
import sys

import pytest
from realmodel.core import missing_native

HERE = f"cpython-3{sys.version_info.minor}"
VERSION = f"3.{sys.version_info.minor}"


@pytest.fixture
def copy(tmp_path):
    """A copy of the add-on with modules of these tags, as one sentence about it."""

    def explained(*tags, checkout=False):
        package = tmp_path / "addon" / "realmodel"
        package.mkdir(parents=True)
        for tag in tags:
            (package / f"_native.{tag}-x86_64-linux-gnu.so").touch()
        if checkout:
            (tmp_path / "scripts").mkdir()
            (tmp_path / "scripts" / "build.sh").touch()
        return missing_native.explanation(ImportError("GLIBC_9.9 not found"), package)

    return explained


def test_a_developer_is_told_to_build(copy):
    text = copy(checkout=True)
    assert f"scripts/build.sh {sys.executable}" in text
    assert f"Python {VERSION} is missing" in text
    assert "GLIBC" not in text, "what Python says of a file that is not there helps nobody"


linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the modules are Linux's")


@linux
def test_an_empty_copy_is_to_be_replaced(copy):
    assert "install the zip" in copy()


@linux
def test_a_copy_for_other_pythons_names_them(copy):
    text = copy("cpython-39", "cpython-399")
    assert "Python 3.9, 3.99" in text


@linux
def test_a_module_that_cannot_be_loaded_says_why(copy):
    text = copy(HERE, "cpython-399")
    assert "GLIBC_9.9 not found" in text
    assert "glibc 2.35" in text


def test_another_system_is_told_so(copy, monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    assert "Linux on x86-64 only" in copy(HERE)


def test_core_can_be_imported_without_it(tmp_path):
    """Nothing but the work itself needs it: the panel has to be able to say so."""
    program = (
        "import sys\n"
        "sys.modules['realmodel._native'] = None\n"  # importing it now raises ImportError
        "from realmodel.core import BuildFailed\n"
        "from realmodel.core.work import native_module\n"
        "try:\n"
        "    native_module()\n"
        "except BuildFailed as failure:\n"
        "    sys.exit('Python' not in str(failure))\n"
        "sys.exit('it was there')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONPATH": str(missing_native.PACKAGE.parent)}, check=False
    )
    assert done.returncode == 0
