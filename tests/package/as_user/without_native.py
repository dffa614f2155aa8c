# SPDX-License-Identifier: GPL-3.0-or-later
"""The installed add-on with its native modules taken away: it says so, and nothing else breaks.

HOME=FOLDER blender -b --python-exit-code 1 -P without_native.py
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import installed
from installed import check


class Layout:
    """Takes a panel's drawing calls and keeps the texts of its labels."""

    def __init__(self, texts):
        self.texts = texts

    def __getattr__(self, name):
        def call(*_arguments, text="", **_options):
            if name == "label":
                self.texts.append(text)
            return Layout(self.texts)

        return call


def panel_texts():
    """All labels of the tab's first panel, as one string."""
    texts = []
    panel = installed.part("ui.start").REALMODEL_PT_start
    panel.draw_in(None, Layout(texts), bpy.context, bpy.context.scene.realmodel)
    return " ".join(texts)


def refused(operator, **options):
    """What the operator says when it refuses."""
    try:
        operator(**options)
    except RuntimeError as error:
        return str(error)
    raise AssertionError(f"{operator.idname_py()} did what needs the native module")


def state():
    """What a refusal may not change: the rock masses and the objects."""
    return [rock.name for rock in bpy.context.scene.realmodel.rocks], sorted(bpy.data.objects.keys())


def main():
    module = installed.package()
    check(not list(Path(module.__file__).parent.glob("_native*")), "the native modules are still there")
    bpy.ops.wm.read_homefile(use_empty=True)
    text = panel_texts()
    for needed in ("cannot build here", "native module", "install the zip"):
        check(needed in text, f"the panel does not say '{needed}' but: {text}")

    # What needs no arithmetic works, the rest says why it does not, and the scene stays as it was.
    ops = bpy.ops.realmodel
    ops.new()
    ops.rock_add()
    for height in (0.0, 1.0):
        bpy.ops.mesh.primitive_plane_add(location=(0.0, 0.0, height))
    bpy.ops.object.select_all(action="SELECT")
    ops.from_selected()
    before = state()
    check(before[0] == ["rock mass"], f"from_selected() made the rock masses {before[0]}")
    check("native module" in refused(ops.open_sample, sample="two_layers"), "opening says something else")
    check("native module" in refused(ops.build), "build() says something else")
    check(state() == before, f"the scene was {before} and is {state()}")

    installed.disabled()
    bpy.ops.preferences.addon_enable(module=installed.name())
    check("native module" in panel_texts(), "enabled again, the panel is silent")
    installed.disabled()
    print("without the native module: as it should be")


main()
installed.leave()
