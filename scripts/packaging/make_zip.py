# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the add-on into one zip that Blender installs.

    build/packaging/bin/python make_zip.py PLATFORM FOLDER MODULE...
    build/packaging/bin/python make_zip.py PLATFORM FOLDER WHEEL...

PLATFORM: as Blender calls it, e.g. windows-x64. FOLDER: where realmodel-VERSION-PLATFORM.zip goes. MODULE:
the native modules, one for each Python. WHEEL: those of make_wheels.py instead, for
realmodel-VERSION-PLATFORM-extension.zip: Blender's extension platform takes compiled code only in wheels of
PyPI (docs/dev/releasing.md), and Blender 4.2 and newer install them.
The zip is written whole or not at all, and the same files give the same bytes. Documents become web pages,
for which markdown-it-py is needed.
"""

import os
import re
import sys
import zipfile
from pathlib import Path

from web_pages import web_pages

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon" / "realmodel"
TOP = "realmodel"  # Blender 3.4 would spill a zip without one top folder over the add-ons
LARGEST = 19e6  # bytes
INSTALLERS_NOTES = {"made_from", "RECORD", "INSTALLER", "REQUESTED"}  # of this machine, not of the package
# In the zip with wheels: the add-on finds its native module in the package that Blender installed from them.
# As an add-on, not an extension, it has the name of that package itself.
NATIVE_OF_WHEEL = b"""\
if __name__ == "realmodel._native":
    raise ImportError("this zip is for the extensions of Blender 4.2 and newer alone")
from realmodel._native import *
"""
EARLIEST = (1980, 1, 1, 0, 0, 0)  # the time of every file in the zip: the zero of the format


def files_below(folder):
    """All files of a folder, without what Python, builds and editors leave there."""
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        left_behind = any(part == "__pycache__" or part.startswith((".", "vendor.")) for part in parts)
        if path.is_file() and not left_behind and path.name not in INSTALLERS_NOTES:
            yield path


def manifest(platform, wheels):
    """The manifest of the add-on, as that of a zip for one platform."""
    text = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8")
    lines = f'platforms = ["{platform}"]'
    if wheels:
        lines += "\nwheels = [{}]".format(", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels))
    changed, count = re.subn(r"^platforms = .*$", lines, text, flags=re.MULTILINE)
    if count != 1:
        sys.exit("make_zip.py: blender_manifest.toml has no line for its platforms")
    return changed.encode()


def contents(platform, modules, wheels):
    """{name in the zip: its bytes}."""
    files = {
        f"{TOP}/{path.relative_to(ADDON).as_posix()}": path.read_bytes()
        for path in files_below(ADDON)
        if not path.name.startswith(("_native.", "_native_cuda."))
    }
    for path in files_below(ROOT / "blend_samples"):
        if path.suffix == ".blend":  # of up to 3 MB, while the zip has a limit
            continue
        files[f"{TOP}/{path.relative_to(ROOT).as_posix()}"] = path.read_bytes()
    files[f"{TOP}/blender_manifest.toml"] = manifest(platform, wheels)
    files[f"{TOP}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    for module in modules:
        files[f"{TOP}/{module.name}"] = module.read_bytes()
    for wheel in wheels:
        files[f"{TOP}/wheels/{wheel.name}"] = wheel.read_bytes()
        files[f"{TOP}/_native.py"] = NATIVE_OF_WHEEL
    files |= {f"{TOP}/{name}": content for name, content in web_pages().items()}
    return files


def write_zip(path, files):
    """Write the zip, through a file beside it that is renamed at the end."""
    unfinished = path.with_name(path.name + ".part")
    try:
        with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
            for name in sorted(files):
                entry = zipfile.ZipInfo(name, EARLIEST)
                entry.create_system = 3  # Unix, whichever system makes it
                entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
                # the only method that Explorer, macOS and unzip open
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, files[name], compresslevel=9)
        size = unfinished.stat().st_size
        if size > LARGEST:
            sys.exit(
                f"make_zip.py: the zip has {size / 1e6:.1f} MB; more than {LARGEST / 1e6:.0f} MB is a mistake"
            )
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def main(platform, folder, *compiled):
    version = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
    wheels = [Path(path) for path in compiled if path.endswith(".whl")]
    modules = [Path(path) for path in compiled if not path.endswith(".whl")]
    path = Path(folder) / f"{TOP}-{version}-{platform}{'-extension' if wheels else ''}.zip"
    path.parent.mkdir(parents=True, exist_ok=True)
    files = contents(platform, modules, wheels)
    write_zip(path, files)
    size = path.stat().st_size
    print(f"Made {path}: {len(files)} files, {size / 1e6:.1f} MB, for {len(compiled)} versions of Python")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
