# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip for Blender's extension platform: its wheels, which Blender 4.5 installs, and a first use."""

import hashlib
import os
import subprocess
import tomllib
import zipfile
from pathlib import Path

import pytest
from conftest import ROOT, VERSION

SCRIPTS = Path(__file__).resolve().parent / "as_user"
BLENDER = ROOT / "build" / "venv-bpy"


@pytest.fixture(scope="module")
def extension(request):
    path = request.config.getoption("--wheels") / f"realmodel-{VERSION}-linux-x64-extension.zip"
    if not path.is_file():
        pytest.skip(f"{path} is not there: scripts/package.sh makes it")
    return path.resolve()


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """Runs a script of Python in Blender 4.5 as a user whose home is empty; that home."""
    if not BLENDER.is_dir():
        pytest.skip(f"{BLENDER} is not there: scripts/test.sh --only bpy makes it")
    home = tmp_path_factory.mktemp("home")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "BLENDER_"))}

    def run(script, *arguments):
        done = subprocess.run(
            [BLENDER / "bin" / "python", script, *map(str, arguments)],
            env=kept | {"HOME": str(home)},
            cwd=home,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run, home


def test_its_wheels_are_those_of_pip(extension, wheels):
    with zipfile.ZipFile(extension) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("realmodel/blender_manifest.toml").decode())
        assert {entry.compress_type for entry in archive.infolist()} == {zipfile.ZIP_DEFLATED}
        assert [name for name in names if name.endswith((".so", ".pyd"))] == []
        listed = [Path(name).name for name in manifest["wheels"]]
        assert sorted(listed) == sorted(Path(name).name for name in names if name.endswith(".whl"))
        for name in listed:
            assert archive.read(f"realmodel/wheels/{name}") == wheels[name[:-4].split("-", 2)[2]].read_bytes()
    assert not any("cp312" in name for name in listed), "no Blender has Python 3.12"
    assert extension.stat().st_size < 19e6


def test_blender_finds_no_fault_in_it(extension, package, blender):
    (program,) = BLENDER.glob(
        "lib/python3*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"
    )
    for path in (extension, package):
        assert "Success" in blender[0](program, "validate", path)


def test_first_use_which_writes_nothing_into_its_folder(extension, blender):
    run, home = blender
    run(SCRIPTS / "install_extension.py", extension)
    (folder,) = home.glob(".config/blender/*/extensions/user_default/realmodel")
    before = digests(folder)
    assert "walk:" in run(SCRIPTS / "walk.py", home)
    assert digests(folder) == before


def digests(folder):
    """{file: digest} without what Python compiles."""
    return {
        path.relative_to(folder): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
