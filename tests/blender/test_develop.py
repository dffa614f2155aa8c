# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/develop.py loads the add-on of the clone again after a change, in a process of its own."""

import subprocess
import unittest
from pathlib import Path

import bpy

DEVELOP = Path(__file__).resolve().parents[2] / "scripts" / "develop.py"
RELOADED = """
import bpy, sys
bpy.ops.realmodel.open_sample(sample="two_layers")
before = {name: sys.modules["realmodel" + name] for name in ("", ".ui.view", ".core", "._native")}
bpy.ops.reload.realmodel()
bpy.ops.realmodel.build()
print([name for name in before if sys.modules["realmodel" + name] is before[name]])
print(len(bpy.context.scene.realmodel.results), "blocks")
"""


@unittest.skipUnless(bpy.app.binary_path, "the module bpy has no window to work in")
class Develop(unittest.TestCase):
    def test_all_but_the_native_module_is_loaded_again_and_the_model_stays(self):
        command = [bpy.app.binary_path, "-b", "--factory-startup", "-P", DEVELOP, "--python-expr", RELOADED]
        run = subprocess.run(command, capture_output=True, text=True, timeout=120)
        self.assertIn("['._native']\n2 blocks\n", run.stdout, run.stderr)
