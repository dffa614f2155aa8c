# SPDX-License-Identifier: GPL-3.0-or-later
"""From three tables to a proposed project in four clicks: the button of the panel, all files, the buttons of
the browser and of the dialog. Then undo, and Esc while it works."""

import shutil

import bpy
from steps_1_panel import idle, model, open_the_tab
from steps_5_structures import _show_alone

UNITS = ("Chalk", "Sand", "Clay")  # the oldest first
_BUTTON = (110, 153)  # Import Field Data in the panel: pixels from the left border and from the top


def _write(folder):
    folder.mkdir(exist_ok=True)
    collars, survey, intervals = ["hole,x,y,z"], ["hole,depth,azimuth,dip"], ["hole,from,to,block"]
    for n in range(16):
        collars.append(f"B{n},{100 * (n % 4)},{90 * (n // 4)},{50 + n % 3}")
        survey.append(f"B{n},0,0,-90")
        names = ("Clay", "Chalk", "Sand") if n == 5 else UNITS[::-1]
        depths = (0, 8 + n % 5, 20 + n % 7, 40)
        intervals += [f"B{n},{a},{b},{c}" for a, b, c in zip(depths[:-1], depths[1:], names, strict=True)]
    for name, rows in (("collars", collars), ("survey", survey), ("intervals", intervals)):
        (folder / f"{name}.csv").write_text("\n".join(rows) + "\n")


def _browser(walk):
    return next((area for area in walk.window.screen.areas if area.type == "FILE_BROWSER"), None)


def _to_the_dialog(walk):
    """Three clicks: the button, all files of the folder, Import. Then the dialog stands open."""
    region = walk.region("UI")
    walk.click(region.x + _BUTTON[0], region.y + region.height - _BUTTON[1])
    yield lambda: _browser(walk) is not None and _browser(walk).spaces.active.params is not None
    _browser(walk).spaces.active.params.directory = str(walk.folder / "tables").encode()
    area = _browser(walk)
    bpy.app.timers.register(area.tag_redraw)
    for _ in range(20):
        yield lambda: True
    walk.shot("browser")
    files = next(region for region in area.regions if region.type == "WINDOW")
    walk.move(files.x + files.width // 2, files.y + files.height // 3)
    walk.key("A")
    for _ in range(5):
        yield lambda: True
    walk.key("RET")
    yield lambda: _browser(walk) is None
    yield walk.redrawn(3)
    walk.shot("field_data_dialog")


def four_clicks(walk):
    """The fourth is OK: an empty scene proposes by itself."""
    _write(walk.folder / "tables")
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    yield walk.redrawn()
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    walk.panels = _show_alone({"REALMODEL_PT_start", "REALMODEL_PT_proposal"})
    yield from open_the_tab(walk)
    yield from _to_the_dialog(walk)
    walk.key("RET")
    yield lambda: idle() and len(model().rocks) == 1
    yield walk.redrawn(3)
    walk.shot("proposed")
    assert [row.block for row in model().rocks[0].surfaces] == list(UNITS)
    conflict = model().proposal[0]
    assert (conflict.kind, conflict.hole, conflict.depth) == ("conflict", "B5", "25"), conflict.text


def undone_in_one_step(walk):
    bpy.ops.ed.undo()
    yield walk.redrawn(3)
    walk.shot("undone")
    assert not model().exists and not len(model().proposal)


def escape_while_it_works(walk):
    """Nothing has changed; the same clicks lead there again."""
    yield from _to_the_dialog(walk)
    walk.key("RET")
    walk.key("ESC")
    yield idle
    yield walk.redrawn(3)
    walk.shot("escaped")
    assert not model().exists and not len(model().proposal)
    shutil.rmtree(walk.folder / "tables")
    for cls in walk.panels:
        if not cls.is_registered:
            bpy.utils.register_class(cls)


STEPS = (four_clicks, undone_in_one_step, escape_while_it_works)
