# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the package, without what needs Blender, into wheels that pip installs: one for each native module.

    build/packaging/bin/python make_wheels.py PLATFORM FOLDER MODULE...

PLATFORM, FOLDER and MODULE are those of make_zip.py. Files and metadata are what pyproject.toml says, as its
build backend makes them; nothing is compiled. For Linux auditwheel adds GCC's libgomp, which not every Linux
has, and proves that nothing else is needed but what the tag promises. The same files give the same bytes.
"""

import os
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from scikit_build_core import build as backend
from wheel.wheelfile import WheelFile

ROOT = Path(__file__).resolve().parents[2]
LARGEST = 6e6  # bytes
EARLIEST = "315532800"  # 1980, the zero of zip's times, as make_zip.py has it
# Of what Debian 12's compiler and C library offer the modules take nothing younger than 2021's (glibc 2.34).
LINUX = "manylinux_2_34_x86_64"
PLATFORMS = {"linux-x64": "linux_x86_64", "windows-x64": "win_amd64", "macos-arm64": "macosx_11_0_arm64"}


def pure_wheel(folder):
    """The wheel without a native module."""
    os.chdir(ROOT)
    return Path(folder, backend.build_wheel(str(folder), {"wheel.cmake": "false"}))


def write_wheel(pure, module, platform, folder):
    """A wheel of the files of the pure one and a native module. Returns its path."""
    python = "cp" + re.match(r"_native\.(?:cpython-|cp)(\d+)", module.name)[1]
    tag = f"{python}-{python}-{PLATFORMS[platform]}"
    with zipfile.ZipFile(pure) as archive:
        files = {entry.filename: archive.read(entry) for entry in archive.infolist() if not entry.is_dir()}
    (about,) = (name for name in files if name.endswith(".dist-info/WHEEL"))
    files[about] = (
        files[about]
        .replace(b"Root-Is-Purelib: true", b"Root-Is-Purelib: false")
        .replace(b"Tag: py3-none-any", f"Tag: {tag}".encode())
    )
    files[f"realmodel/{module.name}"] = module.read_bytes()
    path = folder / pure.name.replace("py3-none-any", tag)
    with WheelFile(path, "w") as wheel:
        for name in sorted(files, key=lambda name: (".dist-info/" in name, name)):
            if not name.endswith(".dist-info/RECORD"):  # which WheelFile writes
                wheel.writestr(name, files[name])
    return path


def self_contained(path, folder):
    """A wheel for Linux with the libraries that the tag does not promise."""
    tools = Path(sys.executable).parent
    command = [tools / "auditwheel", "repair", "--plat", LINUX, "--only-plat", "--wheel-dir", folder, path]
    environment = os.environ | {"PATH": f"{tools}{os.pathsep}{os.environ['PATH']}"}  # of patchelf
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"make_wheels.py: auditwheel refuses {path.name}:\n{done.stdout}{done.stderr}")
    return folder / path.name.replace("linux_x86_64", LINUX)


def main(platform, folder, *modules):
    os.environ["SOURCE_DATE_EPOCH"] = EARLIEST
    folder = Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    modules = [Path(module).resolve() for module in modules]
    with tempfile.TemporaryDirectory(dir=folder) as work:
        pure = pure_wheel(work)
        for module in modules:
            path = write_wheel(pure, module, platform, Path(work))
            if platform == "linux-x64":
                path = self_contained(path, Path(work, "repaired"))
            size = path.stat().st_size
            if size > LARGEST:
                sys.exit(f"make_wheels.py: {path.name} has {size} bytes; at most {LARGEST:.0f} are meant")
            os.replace(path, folder / path.name)
            print(f"Made {folder / path.name}: {size / 1e6:.1f} MB")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
