# SPDX-License-Identifier: GPL-3.0-or-later
"""The zips that scripts/package.sh made: --zip, --windows-zip and --macos-zip FILE, or those in dist/."""

import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()


def pytest_addoption(parser):
    platforms = {"--zip": "linux-x64", "--windows-zip": "windows-x64", "--macos-zip": "macos-arm64"}
    for option, platform in platforms.items():
        parser.addoption(option, type=Path, default=ROOT / "dist" / f"realmodel-{VERSION}-{platform}.zip")


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
