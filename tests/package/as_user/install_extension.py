# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences > Get Extensions > Install from Disk of Blender 4.2 and newer, with the wheels in the zip.

HOME=FOLDER python install_extension.py ZIP             (a Python with the module bpy)
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import installed

(path,) = installed.arguments()
bpy.ops.extensions.package_install_files(filepath=path, repo="user_default", enable_on_install=True)
module = installed.package()
installed.check(module.__name__ == "bl_ext.user_default.realmodel", module.__name__)
import realmodel  # noqa: E402 - what Blender made of the wheel

installed.check(".local" in Path(realmodel.__file__).parts, realmodel.__file__)
installed.check(not hasattr(realmodel, "bl"), "the wheel has Blender's parts")
installed.leave()
