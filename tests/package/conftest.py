# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip that scripts/package.sh made: --zip FILE, or the one in dist/."""

import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()


def pytest_addoption(parser):
    parser.addoption("--zip", type=Path, default=ROOT / "dist" / f"realmodel-{VERSION}-linux-x64.zip")


@pytest.fixture(scope="session")
def package(request):
    path = request.config.getoption("--zip")
    if not path.is_file():
        pytest.skip(f"{path} is not there: scripts/package.sh makes it")
    return path.resolve()


@pytest.fixture(scope="session")
def unpacked(package, tmp_path_factory):
    """The zip unpacked as Blender does it."""
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(package) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture(scope="session")
def modules(unpacked):
    found = sorted((unpacked / "realmodel").glob("_native.*"))
    assert found
    return found
