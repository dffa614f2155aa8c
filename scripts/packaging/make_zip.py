# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the add-on into one zip that Blender installs.

    build/tools/bin/python make_zip.py PLATFORM FOLDER MODULE...

PLATFORM: as Blender calls it, e.g. windows-x64. FOLDER: where realmodel-VERSION-PLATFORM.zip goes. MODULE:
the native modules, one for each Python.
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
LARGEST = 16e6  # bytes
INSTALLERS_NOTES = {"made_from", "RECORD", "INSTALLER", "REQUESTED"}  # of this machine, not of the package
EARLIEST = (1980, 1, 1, 0, 0, 0)  # the time of every file in the zip: the zero of the format


def files_below(folder):
    """All files of a folder, without what Python, builds and editors leave there."""
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        left_behind = any(part == "__pycache__" or part.startswith((".", "vendor.")) for part in parts)
        if path.is_file() and not left_behind and path.name not in INSTALLERS_NOTES:
            yield path


def manifest(platform):
    """The manifest of the add-on, as that of a zip for one platform."""
    text = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8")
    changed, count = re.subn(r"^platforms = .*$", f'platforms = ["{platform}"]', text, flags=re.MULTILINE)
    if count != 1:
        sys.exit("make_zip.py: blender_manifest.toml has no line for its platforms")
    return changed.encode()


def contents(platform, modules):
    """{name in the zip: its bytes}."""
    files = {
        f"{TOP}/{path.relative_to(ADDON).as_posix()}": path.read_bytes()
        for path in files_below(ADDON)
        if not path.name.startswith("_native.")
    }
    for path in files_below(ROOT / "blend_samples"):
        files[f"{TOP}/{path.relative_to(ROOT).as_posix()}"] = path.read_bytes()
    files[f"{TOP}/blender_manifest.toml"] = manifest(platform)
    files[f"{TOP}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    for module in modules:
        files[f"{TOP}/{module.name}"] = module.read_bytes()
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


def main(platform, folder, *modules):
    version = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
    path = Path(folder) / f"{TOP}-{version}-{platform}.zip"
    path.parent.mkdir(parents=True, exist_ok=True)
    files = contents(platform, [Path(module) for module in modules])
    write_zip(path, files)
    print(
        f"Made {path}: {len(files)} files, {path.stat().st_size / 1e6:.1f} MB, {len(modules)} native modules"
    )


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
