# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip in this system's Blender, installed as a user installs it, in an empty home.

scripts/test_blender_versions.sh does the same in newer Blenders.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parent / "as_user"

pytestmark = pytest.mark.skipif(shutil.which("blender") is None, reason="there is no Blender here")


@pytest.fixture
def blender(tmp_path):
    """Runs a script in Blender as a user whose home is tmp_path; what it printed."""
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "BLENDER_"))
    }
    environment["HOME"] = str(tmp_path)

    def run(script, *arguments):
        command = ["blender", "-b", "--python-exit-code", "1", "-P", str(SCRIPTS / script), "--", *arguments]
        done = subprocess.run(
            list(map(str, command)),
            env=environment,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


@pytest.fixture
def installed(blender, package, tmp_path):
    """The folder that Blender made of the zip."""
    blender("install.py", package)
    (folder,) = tmp_path.glob(".config/blender/*/scripts/addons/realmodel")
    return folder


def test_first_use(blender, installed, tmp_path):
    assert "walk:" in blender("walk.py", tmp_path)
    assert (tmp_path / "walk.blend").stat().st_size > 0


def test_without_the_native_module(blender, installed):
    for module in installed.glob("_native*"):
        module.unlink()
    assert "as it should be" in blender("without_native.py")
