# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip for Windows: what is in it, and what its native modules need. scripts/test_windows.sh runs it."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()

# Of every Windows since 10: no library of a compiler, which no user has.
SYSTEM = {"kernel32.dll", "msvcrt.dll"}


@pytest.fixture(scope="module")
def modules(windows_addon):
    """{name: what objdump says of it}."""
    found = sorted(windows_addon.glob("_native.*"))
    assert found
    return {
        path.name: subprocess.run(["objdump", "-p", path], check=True, capture_output=True, text=True).stdout
        for path in found
    }


def test_small(windows_package):
    assert windows_package.stat().st_size < 18e6


def test_it_says_its_platform(windows_addon):
    manifest = tomllib.loads((windows_addon / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["platforms"] == ["windows-x64"]
    assert manifest["version"] == VERSION


def test_a_module_says_which_python_it_is_for(modules):
    assert all(re.fullmatch(r"_native\.cp3\d+-win_amd64\.pyd", name) for name in modules)


def test_a_module_needs_windows_and_its_python_only(modules):
    for name, output in modules.items():
        needed = {dll.lower() for dll in re.findall(r"DLL Name: (\S+)", output)}
        python = f"python{re.search(r'cp(3[0-9]+)', name)[1]}.dll"
        assert python in needed
        assert needed <= SYSTEM | {python}, name


def test_a_module_shows_its_entry_only(modules):
    for name, output in modules.items():
        names = output.split("[Ordinal/Name Pointer] Table", 1)[1].split("\n\n")[0]
        assert re.findall(r"\[ *\d+\].* (\S+)$", names, re.MULTILINE) == ["PyInit__native"], name
        assert "Time/Date\t\tThu Jan  1 00:00:00 1970" in output, "the time of linking makes other bytes"
