# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip for macOS: what is in it, and what its native modules need. They are loaded nowhere."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()


@pytest.fixture(scope="module")
def modules(macos_addon):
    found = sorted(macos_addon.glob("_native.*"))
    assert found
    return found


def objdump(module, *what):
    """What LLVM's objdump says of a module."""
    if shutil.which("llvm-objdump") is None:
        pytest.skip("llvm-objdump is not there")
    command = ["llvm-objdump", "--macho", *what, str(module)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_small(macos_package):
    assert macos_package.stat().st_size < 18e6


def test_it_says_its_platform(macos_addon):
    manifest = tomllib.loads((macos_addon / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["platforms"] == ["macos-arm64"]
    assert manifest["version"] == VERSION


def test_a_module_says_which_python_it_is_for(modules):
    assert all(re.fullmatch(r"_native\.cpython-3\d+-darwin\.so", path.name) for path in modules)


def test_a_module_is_for_apples_processors_and_macos_11(modules):
    for module in modules:
        text = objdump(module, "--private-headers")
        assert "ARM64" in text, module.name
        assert re.search(r"platform macos\s+sdk [\d.]+\s+minos 11\.0", text), module.name
        assert "LC_CODE_SIGNATURE" in text, "no such processor runs what is not signed"


def test_a_module_needs_the_system_only(modules):
    for module in modules:
        libraries = objdump(module, "--dylibs-used").splitlines()[2:]  # after its own name, twice
        assert [line.split()[0] for line in libraries] == ["/usr/lib/libSystem.B.dylib"], module.name


def test_a_module_asks_for_nothing_but_python_and_the_system(modules):
    """What it lacks is looked for when it is loaded, so that the linker did not say."""
    for module in modules:
        listed = subprocess.run(["llvm-nm", "-u", module], check=True, capture_output=True, text=True).stdout
        assert {name for name in listed.split() if name.startswith(("__Z", "___gmp", "_omp"))} == set(), (
            module.name
        )


def test_a_module_shows_its_entry(modules):
    """And allocation by the C++ library's own name, as that library wants it."""
    for module in modules:
        shown = re.findall(r"^0x[0-9A-F]+ +(\S+)", objdump(module, "--exports-trie"), re.MULTILINE)
        assert "_PyInit__native" in shown
        assert [n for n in shown if not re.match(r"_PyInit__native|__Zn[aw]|__Zd[al]|___?(dso|mh)_", n)] == []
