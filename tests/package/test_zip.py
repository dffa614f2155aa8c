# SPDX-License-Identifier: GPL-3.0-or-later
"""What is in the zip, what its native modules need, and that making it again gives the same bytes."""

import ast
import importlib.util
import re
import subprocess
import sys
import tomllib
import zipfile
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urldefrag, urlsplit

import pytest

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text(encoding="utf-8").strip()

# What a module may need of the system it runs on, and how old that may be (Ubuntu 22.04's).
# The first is the C library's own part that loads all others.
SYSTEM = {"ld-linux-x86-64.so.2", "libc.so.6", "libm.so.6", "libgcc_s.so.1", "libstdc++.so.6", "libgomp.so.1"}
NEWEST = {"GLIBC": (2, 35), "GLIBCXX": (3, 4, 30), "GCC": (12,), "CXXABI": (1, 3, 13)}


def readelf(*arguments):
    command = ["readelf", "--wide", *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_one_folder_on_top(package):
    with zipfile.ZipFile(package) as archive:
        tops = {name.split("/")[0] for name in archive.namelist()}
    assert tops == {"realmodel"}


def test_small(package):
    assert package.stat().st_size < 18e6


def test_every_program_that_opens_zips_opens_it(package):
    """Explorer, macOS and unzip know no other method."""
    with zipfile.ZipFile(package) as archive:
        assert {entry.compress_type for entry in archive.infolist()} == {zipfile.ZIP_DEFLATED}


def test_both_ways_to_be_found_by_blender(unpacked):
    folder = unpacked / "realmodel"
    with (folder / "blender_manifest.toml").open("rb") as file:
        manifest = tomllib.load(file)
    tree = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
    bl_info = next(
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    )
    assert manifest["platforms"] == ["linux-x64"]
    assert manifest["version"] == ".".join(map(str, bl_info["version"])) == VERSION


def test_all_that_a_user_needs_is_there(unpacked):
    folder = unpacked / "realmodel"
    for name in (
        "LICENSE",
        "NOTICE.md",
        "core/model/build.py",
        "bl/host/versions.py",
        "core/exporters/page/three.min.js",
        "vendor/shapefile.py",
    ):
        assert (folder / name).is_file(), name
    samples = folder / "blend_samples"
    assert {path.parent.name for path in samples.glob("*/project.toml")} >= {
        "two_layers",
        "castle_hill",
        "haut_barr",
    }


class Links(HTMLParser):
    """The addresses and the anchors of a page."""

    def __init__(self, page):
        super().__init__()
        self.addresses, self.anchors = [], set()
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, _tag, attributes):
        for name, value in attributes:
            if name in ("href", "src"):
                self.addresses.append(value)
            elif name == "id":
                self.anchors.add(value)


def test_the_guide_is_there_and_its_links_lead_somewhere(unpacked):
    pages = {path.resolve(): Links(path) for path in (unpacked / "realmodel" / "docs").rglob("*.html")}
    guide = unpacked / "realmodel" / "docs" / "guide"
    assert {"index.html", "install.html", "tour.html", "troubleshooting.html"} <= {
        p.name for p in guide.iterdir()
    }
    followed = 0
    for page, links in pages.items():
        for address in links.addresses:
            path, anchor = urldefrag(address)
            if urlsplit(path).scheme:
                continue
            target = (page.parent / path).resolve() if path else page
            assert target.is_file(), f"{page.name}: {address}"
            assert not anchor or anchor in pages[target].anchors, f"{page.name}: {address}"
            followed += 1
    assert followed > 50


def test_nothing_else_is_there(package):
    with zipfile.ZipFile(package) as archive:
        names = archive.namelist()
    unwanted = re.compile(r"__pycache__|\.pyc$|\.blend1$|/\.|~$")
    assert [name for name in names if unwanted.search(name)] == []


def test_a_module_needs_the_system_only(modules):
    for module in modules:
        needed = set(re.findall(r"\(NEEDED\).*\[(.+)\]", readelf("--dynamic", module)))
        assert needed <= SYSTEM, module.name
        assert "RPATH" not in readelf("--dynamic", module)
        assert "RUNPATH" not in readelf("--dynamic", module)


def test_a_module_runs_on_systems_of_2022(modules):
    for module in modules:
        for library, version in re.findall(
            r"Name: (GLIBC|GLIBCXX|GCC|CXXABI)_([0-9.]+)", readelf("--version-info", module)
        ):
            assert tuple(map(int, version.split("."))) <= NEWEST[library], (module.name, library, version)


def test_a_module_is_stripped_and_shows_its_entry_only(modules):
    for module in modules:
        assert ".symtab" not in readelf("--sections", module)
        assert ".debug_info" not in readelf("--sections", module)
        assert "TEXTREL" not in readelf("--dynamic", module)
        table = readelf("--dyn-syms", module)
        shown = re.findall(r"(?:GLOBAL|WEAK|UNIQUE) +DEFAULT +\d+ (\S+)", table)
        assert shown == ["PyInit__native"], module.name


def test_a_module_says_which_python_it_is_for(modules):
    names = [module.name for module in modules]
    assert all(re.fullmatch(r"_native\.cpython-3\d+-x86_64-linux-gnu\.so", name) for name in names)


def test_it_works_from_the_zip(unpacked, modules):
    """In a Python that the zip has a module for, away from the sources."""
    tag = f"cpython-3{sys.version_info.minor}-"
    if not any(tag in module.name for module in modules):
        pytest.skip(f"the zip has no module for Python 3.{sys.version_info.minor}")
    sample = unpacked / "realmodel" / "blend_samples" / "two_layers" / "project.toml"
    program = (
        "from realmodel.core import build, load_project\n"
        f"assert build(load_project({str(sample)!r})).validate().passed\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONPATH": str(unpacked)},
        cwd=unpacked,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_same_files_same_bytes(package, modules, tmp_path, monkeypatch):
    """Made again from the same sources, later and in another folder."""
    monkeypatch.syspath_prepend(ROOT / "scripts" / "packaging")
    path = ROOT / "scripts" / "packaging" / "make_zip.py"
    specification = importlib.util.spec_from_file_location("make_zip", path)
    make_zip = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(make_zip)
    make_zip.main("linux-x64", tmp_path, *map(str, modules))
    assert Path(tmp_path, package.name).read_bytes() == package.read_bytes()
