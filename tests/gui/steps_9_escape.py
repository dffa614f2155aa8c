# SPDX-License-Identifier: GPL-3.0-or-later
"""Every operator of the add-on that opens a dialog or a file browser, takes clicks or works for long: Esc."""

import io
import sys

import bpy
from steps_1_panel import idle, model, volumes
from steps_3_import import invoked


def _waiting():
    """The operators whose `invoke` may wait for a person."""
    found = [cls for cls in bpy.types.Operator.__subclasses__() if cls.__module__.startswith("realmodel.")]
    return sorted((cls for cls in found if hasattr(cls, "invoke")), key=lambda cls: cls.bl_idname)


def _state():
    rows = [(rock.name, [(s.name, s.source, s.method) for s in rock.surfaces]) for rock in model().rocks]
    return rows, volumes(), sorted(item.name for item in bpy.context.scene.objects)


def escape_from_everything(walk):
    """It leaves the scene as it was, and no traceback. Twice: with the mouse, too, some are modal."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.open_sample, sample="two_layers")
    yield lambda: len(model().results) > 0 and idle()
    view = bpy.context.preferences.view
    before, view.filebrowser_display_type = view.filebrowser_display_type, "SCREEN"
    stderr, sys.stderr = sys.stderr, io.StringIO()
    pressed = []
    try:
        for cls in _waiting():
            name = cls.bl_idname.partition(".")[2]
            state = _state()
            walk.over_viewport()
            try:
                result = invoked(walk, getattr(bpy.ops.realmodel, name))
            except RuntimeError as error:
                assert "Traceback" not in str(error), (name, str(error))
                continue
            if "RUNNING_MODAL" not in result:
                continue
            yield walk.redrawn()
            for _ in range(20):
                walk.key("ESC")
                yield lambda: True
                if idle() and all(area.type != "FILE_BROWSER" for area in walk.window.screen.areas):
                    break
            yield idle
            walk.key("ESC")
            yield walk.redrawn()
            said = sys.stderr.getvalue()
            assert "Traceback" not in said, (name, said)
            assert _state() == state, name
            pressed.append(name)
    finally:
        said, sys.stderr = sys.stderr.getvalue(), stderr
        view.filebrowser_display_type = before
    assert "Traceback" not in said, said
    assert {"export", "export_mesh", "ensemble", "build", "boreholes_read"} <= set(pressed), pressed


STEPS = (escape_from_everything,)
