# SPDX-License-Identifier: GPL-3.0-or-later
"""Chapters of the guide beside those of `guide_chapters.py`: holes, a field on the cut, faults, and the
dialog of filling. Needs Blender."""

import math

import guide_scenes
import sculptures
from guide_window import (
    build,
    example,
    fill_view,
    frame,
    keep,
    settled,
    viewed,
    viewport,
)


def boreholes(walk):
    """Logged holes in the colors of their units, at the cut of the model that follows from them."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.open_sample(sample="uncertain_valley")
    yield from build(walk)
    names = [(row.name, tuple(row.color)) for row in bpy.context.scene.realmodel.library]
    tables = guide_scenes.logs(walk.folder, "uncertain_valley")
    with viewport(walk):
        bpy.ops.realmodel.new()
        files = [{"name": path.name} for path in tables]
        bpy.ops.realmodel.boreholes_read(
            filepath=str(tables[0]), directory=str(walk.folder), files=files, propose=True
        )
    group = bpy.context.scene.realmodel
    colors = dict(names)
    for row in group.library:
        row.color = colors.get(row.name, row.color)
    yield from build(walk)
    group.view.exaggeration = 6.0
    group.view.show_boreholes = group.view.show_hole_names = True
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="X")
    for item in bpy.context.visible_objects:
        if not item.dimensions.z or item == group.view.plane:
            item.hide_set(True)  # outlines far below what the holes are in
    yield from settled(walk)
    frame(walk, 1.25, azimuth=math.radians(122.0))  # to the cut, from the east
    yield from keep(walk, "boreholes", panels=["results", "field"])


def planned_hole(walk):
    """A planned hole beside the cut that it crosses."""
    import bpy

    yield from example(walk, "uncertain_valley")
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 6.0
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    group.view.plane.hide_set(True)
    yield from settled(walk)
    with viewport(walk):
        bpy.ops.realmodel.planned_hole_add()
    hole = group.planned_holes[0]
    hole.azimuth, hole.dip, hole.length = 90.0, 60.0, 140.0
    yield from settled(walk)
    frame(walk)
    yield from keep(walk, "planned_hole", panels=["results", "planned_holes"])


def fold(walk):
    """A field on the cut."""
    import bpy

    yield from example(walk, "recumbent_fold")
    group = bpy.context.scene.realmodel
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    group.view.plane.hide_set(True)
    group.view.show_field_section = True
    yield from settled(walk)
    frame(walk)
    yield from keep(walk, "field_cut", panels=["view", "view_section", "view_fields"])


def faults(walk):
    """The panel of faults and bodies beside its model."""
    import bpy

    yield from example(walk, "fault_blocks")
    bpy.context.scene.realmodel.active_fault = 1
    yield from keep(walk, "faults_panel", panels=["structures"])


def filling(walk):
    """What Fill with Strata asks, with its presets."""
    import bpy
    from driver import save_picture

    walk.area.spaces.active.show_region_ui = False
    item = sculptures.boulder()
    fill_view(walk, [item], 0.5)
    walk.area.spaces.active.region_3d.view_location.x -= 2.0
    region = walk.region("WINDOW")
    walk.move(region.x + 0.75 * region.width, region.y + 0.9 * region.height)
    yield walk.redrawn()
    with viewport(walk):
        bpy.ops.realmodel.fill_with_strata("INVOKE_DEFAULT")
    yield walk.redrawn(8)
    picture = viewed(walk)  # its rows from the bottom up: above the dialog it is empty
    save_picture(picture[: int(0.76 * len(picture))], walk.folder / "filling.png")
    walk.key("ESC")
    yield lambda: "Strata Preview" not in bpy.data.objects
    yield walk.redrawn(3)
