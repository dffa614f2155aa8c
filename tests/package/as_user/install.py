# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences > Add-ons > Install... of a Blender older than 4.2, then the tick, then Save Preferences.

    HOME=FOLDER blender -b --python-exit-code 1 -P install.py -- ZIP

Newer versions install it from the command line: blender --command extension install-file.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import installed

(path,) = installed.arguments()
bpy.ops.preferences.addon_install(filepath=path)
bpy.ops.preferences.addon_enable(module=installed.name())
installed.package()
bpy.ops.wm.save_userpref()
installed.leave()
