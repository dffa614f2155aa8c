# SPDX-License-Identifier: GPL-3.0-or-later
"""A model of wells in map coordinates, heights exaggerated: the section panel in model coordinates, residuals
that can be told apart, a legend that the panel of the last operator does not cover."""

import tempfile
from pathlib import Path

import bpy
import numpy as np
from realmodel.bl.overlay import viewport
from realmodel.operators import sections
from realmodel.ui import view
from realmodel.ui.panel import TabPanel
from steps_1_panel import idle, model, open_the_tab
from steps_2_view import in_the_viewport

EAST, NORTH, SIZE = 270000.0, 3912000.0, 60000.0


class OnTop(TabPanel, bpy.types.Panel):
    """The panel, open and where it is seen without scrolling."""

    bl_label = "Section"
    bl_idname = "REALMODEL_PT_section_on_top"
    bl_order = -1
    draw_in = view.REALMODEL_PT_view_section.draw_in


def wells(folder):
    """A project without a library: five tops of sixty wells, one of them picked 900 m too high in one."""
    chance = np.random.default_rng(4)
    plan = chance.uniform(0.05, 0.95, (60, 2)) * SIZE
    east, north = EAST + SIZE, NORTH + SIZE
    text = f"""format = 1
name = "wells"
[[rock]]
name = "basin"
region = [[{EAST}, {NORTH}], [{east}, {NORTH}], [{east}, {north}], [{EAST}, {north}]]
edge_length = 3000
base_elevation = -3500
"""
    for number in range(5):
        z = -2500 + 500 * number + 200 * np.sin(plan[:, 0] / 15000 + number) + chance.normal(0, 30, len(plan))
        z[7] += 900.0 * (number == 2)
        rows = "".join(f"{x + EAST:.2f},{y + NORTH:.2f},{h:.2f}\n" for (x, y), h in zip(plan, z, strict=True))
        (folder / f"t{number}.csv").write_text("x,y,z\n" + rows)
        text += f"""
[[rock.surface]]
name = "Top {number}"
points = "t{number}.csv"
method = "kriging"
variogram = {{model = "spherical", range = 30000, sill = 45000, nugget = 5000}}
tie = false
"""
    path = folder / "project.toml"
    path.write_text(text)
    return path


def a_far_model(walk):
    """East and north count from one origin; the layers have colors; the missed pick is named."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    yield from open_the_tab(walk)
    with tempfile.TemporaryDirectory() as folder, in_the_viewport(walk):
        bpy.ops.realmodel.open_project(filepath=str(wells(Path(folder))))
        bpy.ops.realmodel.build()
    yield lambda: len(model().results) == 5 and idle()
    assert all(bpy.context.scene["realmodel_origin"][:2]), list(bpy.context.scene["realmodel_origin"])
    assert "it misses point 7 at (" in model().warnings, model().warnings
    model().view.exaggeration = 6.0
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
        bpy.ops.realmodel.view_all()
    yield walk.redrawn(3)
    shown = walk.shot("wells")
    region = walk.region("WINDOW")
    seen = shown[region.y : region.y + region.height, region.x : region.x + region.width]
    assert (np.ptp(seen, axis=2) > 0.15).mean() > 0.05, "the layers are gray"


def residuals_as_balls(walk):
    """Alone, from the south: as high as wide on the screen."""
    for row in model().results:
        row.object.hide_set(True)
    model().view.show_residuals = True
    yield walk.redrawn(3)
    walk.shot("residuals")
    item = next(o for o in bpy.context.scene.objects if o.get("realmodel_view") == "residuals")
    corners = [item.matrix_world @ vertex.co for vertex in item.data.vertices[:6]]
    pixels = np.array([walk.pixel_of(corner) for corner in corners])
    assert abs(np.ptp(pixels[:, 0]) - np.ptp(pixels[:, 1])) <= 2, np.ptp(pixels, axis=0)
    model().view.show_residuals = False
    for row in model().results:
        row.object.hide_set(False)


def a_section_plane(walk):
    """By F3, so that Blender shows the panel of the last operator; the legend stands above it."""
    bpy.utils.register_class(OnTop)
    yield from walk.command("plane south")
    yield lambda: model().view.plane is not None and bool(model().view.cut)
    yield walk.redrawn(4)
    assert (model().view.plane_x, model().view.plane_y) == ("300000.000", "3942000.000")
    low = viewport._margins(walk.area, 1.0)[2]
    walk.shot("section_plane")
    assert low > 10.0, [(r.type, r.width, r.height) for r in walk.area.regions]
    model().view.plane_y = "3930000"
    yield lambda: "3930000.0" in model().view.cut
    yield walk.redrawn(3)
    walk.shot("section_moved")
    bpy.utils.unregister_class(OnTop)
    drawn, draw = [], sections.REALMODEL_OT_save_section.draw

    def watched(self, context):
        draw(self, context)
        drawn.append(self)

    sections.REALMODEL_OT_save_section.draw = watched
    with in_the_viewport(walk):
        bpy.ops.realmodel.save_section("INVOKE_DEFAULT", along="PLANE")
    yield lambda: drawn
    yield walk.redrawn()
    walk.shot("save_section")
    walk.over_viewport()
    walk.key("ESC")
    yield lambda: walk.region("UI").width > 50
    sections.REALMODEL_OT_save_section.draw = draw


def the_table_with_tabs(walk):
    bpy.ops.realmodel.copy_table()
    lines = bpy.context.window_manager.clipboard.splitlines()
    assert [len(line.split("\t")) for line in lines] == [7] * 6, lines
    yield walk.redrawn()
    bpy.ops.realmodel.surface_remove()
    yield walk.redrawn(3)
    walk.shot("out_of_date")
    assert model().is_outdated
    bpy.ops.realmodel.section_remove()
    model().view.exaggeration = 1.0
    yield walk.redrawn()


STEPS = (a_far_model, residuals_as_balls, a_section_plane, the_table_with_tabs)
