# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/package.sh made: --zip, --windows-zip, --macos-zip FILE, --wheels FOLDER, or all of dist."""

import os
import subprocess
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()


def pytest_addoption(parser):
    platforms = {"--zip": "linux-x64", "--windows-zip": "windows-x64", "--macos-zip": "macos-arm64"}
    for option, platform in platforms.items():
        parser.addoption(option, type=Path, default=ROOT / "dist" / f"realmodel-{VERSION}-{platform}.zip")
    parser.addoption("--wheels", type=Path, default=ROOT / "dist")


def made(request, option):
    path = request.config.getoption(option)
    if not path.is_file():
        pytest.skip(f"{path} is not there: scripts/package.sh makes it")
    return path.resolve()


@pytest.fixture(scope="session")
def package(request):
    return made(request, "--zip")


@pytest.fixture(scope="session")
def windows_package(request):
    return made(request, "--windows-zip")


@pytest.fixture(scope="session")
def macos_package(request):
    return made(request, "--macos-zip")


def unpack(package, tmp_path_factory):
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(package) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture(scope="session")
def unpacked(package, tmp_path_factory):
    """The zip unpacked as Blender does it."""
    return unpack(package, tmp_path_factory)


@pytest.fixture(scope="session")
def windows_addon(windows_package, tmp_path_factory):
    return unpack(windows_package, tmp_path_factory) / "realmodel"


@pytest.fixture(scope="session")
def macos_addon(macos_package, tmp_path_factory):
    return unpack(macos_package, tmp_path_factory) / "realmodel"


@pytest.fixture(scope="session")
def modules(unpacked):
    found = sorted((unpacked / "realmodel").glob("_native.*"))
    assert found
    return found


@pytest.fixture(scope="session")
def wheels(request):
    """The wheels of this version, by their names' ends: {"cp311-cp311-manylinux_2_34_x86_64": path}."""
    folder = request.config.getoption("--wheels").resolve()
    found = {path.stem.split("-", 2)[2]: path for path in sorted(folder.glob(f"realmodel-{VERSION}-*.whl"))}
    if not found:
        pytest.skip(f"{folder} has no wheels: scripts/package.sh makes them")
    return found


class Environment:
    """An empty virtual environment; what runs in it knows nothing of this clone."""

    def __init__(self, python, folder):
        subprocess.run([python, "-m", "venv", folder / "venv"], check=True)
        self.folder = folder
        self.programs = folder / "venv" / "bin"
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        self.variables = kept | {"PATH": f"{self.programs}:/usr/bin:/bin"}

    def run(self, program, *arguments, **options):
        """Runs one of its programs, away from the clone."""
        return subprocess.run(
            [self.programs / program, *map(str, arguments)],
            env=self.variables | options.pop("variables", {}),
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
            **options,
        )

    def install(self, *requirements, **options):
        # compiled is what is imported: half of the time that Dask takes
        done = self.run("python", "-m", "pip", "install", "--no-compile", *requirements, **options)
        assert done.returncode == 0, done.stdout + done.stderr
