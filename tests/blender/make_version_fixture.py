# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes tests/data/versions/vN.blend, a file of the present version N of the settings, for all time.

    blender -b --factory-startup -P tests/blender/make_version_fixture.py

Run it once before settings.VERSION goes up. Files of versions that were released are kept, as they must be
migrated. test_panel_versions.py opens them.
"""

import shutil
import sys
import tempfile
from pathlib import Path

import bpy

FOLDER = Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER.parents[1] / "addon"), str(FOLDER)]

import realmodel  # noqa: E402
from realmodel.bl.project import settings  # noqa: E402

VERSIONS = FOLDER.parent / "data" / "versions"
SAMPLE = FOLDER.parents[1] / "blend_samples" / "two_layers"


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    VERSIONS.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        copy = shutil.copytree(SAMPLE, Path(folder) / "two_layers")
        realmodel.register()
        bpy.ops.realmodel.open_project(filepath=str(copy / "project.toml"))
        bpy.ops.realmodel.build()
        target = VERSIONS / f"v{settings.VERSION}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(target), compress=True)


main()
