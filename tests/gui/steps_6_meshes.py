# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh for simulation: Esc, then from the file browser to the file. A surface that is sculpted."""

import bpy
from steps_1_panel import idle, model, volumes
from steps_3_import import invoked


def cancel_a_mesh(walk):
    """Esc stops it while progress is shown; no file is left."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.open_sample, sample="two_layers")
    yield lambda: len(model().results) > 0 and idle()
    path = walk.folder / "cancelled.vtu"
    fine = {"edge_length": 0.2, "minimum_thickness": 0.05, "layer_thickness": 0.1}
    invoked(walk, bpy.ops.realmodel.export_mesh, filepath=str(path), is_chosen=True, **fine)
    yield lambda: bpy.context.window_manager.realmodel.progress > 0.5 or idle()
    yield walk.redrawn()
    assert not idle(), "it was over before it could be cancelled"
    walk.shot("mesh_in_work")
    walk.key("ESC")
    yield idle
    assert not path.exists()


def mesh_from_the_browser(walk):
    """The browser shows the options; its button writes the file, and the panel shows the work."""
    path = walk.folder / "mesh.inp"
    view = bpy.context.preferences.view
    before, view.filebrowser_display_type = view.filebrowser_display_type, "SCREEN"
    options = {"edge_length": 4.0, "minimum_thickness": 0.7, "layer_thickness": 2.0, "format": "INP"}
    invoked(walk, bpy.ops.realmodel.export_mesh, filepath=str(path), **options)
    yield lambda: any(area.type == "FILE_BROWSER" for area in walk.window.screen.areas)
    area = next(area for area in walk.window.screen.areas if area.type == "FILE_BROWSER")
    area.tag_redraw()
    yield lambda: area.spaces.active.params is not None
    walk.shot("mesh_browser")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=walk.window, area=area, region=region):
        bpy.ops.file.execute("INVOKE_DEFAULT")
    yield lambda: path.exists() and idle()
    yield lambda: any(area.type == "VIEW_3D" for area in walk.window.screen.areas)
    yield walk.redrawn(2)
    assert path.read_text().startswith("*HEADING\nRealModel\n*NODE")
    walk.shot("mesh_written")
    path.unlink()
    view.filebrowser_display_type = before


def sculpt_a_surface(walk):
    """With Auto on, the blocks follow each stroke in Sculpt Mode, where Blender evaluates no mesh."""
    ground = model().rocks[0].surfaces[-1].interface
    for item in bpy.context.selected_objects:
        item.select_set(False)
    ground.hide_set(False)
    bpy.context.view_layer.objects.active = ground
    ground.select_set(True)
    model().live = True
    bpy.ops.object.mode_set(mode="SCULPT")
    brush = bpy.context.tool_settings.sculpt.brush
    brush.direction, brush.strength, brush.sculpt_plane = "SUBTRACT", 0.5, "Z"
    yield walk.redrawn(2)
    yield idle
    before = volumes()
    corners = [ground.matrix_world @ vertex.co for vertex in ground.data.vertices]
    middle = sum(corners[1:], corners[0]) / len(corners)
    x, y = walk.pixel_of(min(corners, key=lambda corner: (corner - middle).length))
    walk.move(x, y)
    yield walk.redrawn()
    walk.window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
    for step in range(1, 6):
        walk.move(x + 6 * step, y)
        yield walk.redrawn()
    walk.window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=x + 30, y=y)
    yield lambda: volumes() != before and idle()
    assert ground.mode == "SCULPT"
    walk.shot("sculpted")
    bpy.ops.object.mode_set(mode="OBJECT")
    model().live = False
    yield walk.redrawn()


STEPS = (cancel_a_mesh, mesh_from_the_browser, sculpt_a_surface)
