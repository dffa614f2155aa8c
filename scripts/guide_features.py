# SPDX-License-Identifier: GPL-3.0-or-later
"""Chapters of the guide beside those of `guide_chapters.py`: data, uncertainty, drawings on sections, and
what the dialogs ask. Needs Blender."""

import math

import guide_scenes
from guide_window import (
    blocks,
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


def uncertainty(walk):
    """A planned hole, and an ensemble in colors on a section."""
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
    with viewport(walk):
        bpy.ops.realmodel.ensemble("EXEC_DEFAULT", realizations=40, seed=1)
    yield from settled(walk)
    yield from keep(walk, "ensemble_panel", panels=["results", "ensemble"])


def fold(walk):
    """A field on the cut, the panel of its series, and what does not fit."""
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
    group.rocks[0].active_surface = next(
        n for n, row in enumerate(group.rocks[0].surfaces) if row.name == "upper bed"
    )
    yield from keep(walk, "series_panel", "UI", ["surfaces", "series"])
    group.view.show_field_section, group.view.use_section = False, False
    group.view.show_dips = group.view.show_misfits = True
    group.view.dip_tolerance = 0.1
    for item in blocks():
        item.hide_set(True)
    yield from settled(walk)
    frame(walk)
    yield from keep(walk, "misfits", panels=["field", "field_misfits"])


def residuals(walk):
    """Points by how far a surface is from them."""
    import bpy

    yield from example(walk, "castle_hill")
    group = bpy.context.scene.realmodel
    with viewport(walk):
        bpy.ops.realmodel.dismiss()
    for row in group.rocks[0].surfaces:
        row.tie = False
    yield from build(walk)
    group.view.show_residuals = True
    for item in blocks():
        item.hide_set(True)
    yield from settled(walk)
    frame(walk)
    yield from keep(walk, "residuals", panels=["view", "results"])


def faults(walk):
    """The panel of faults and bodies beside its model."""
    import bpy

    yield from example(walk, "fault_blocks")
    bpy.context.scene.realmodel.active_fault = 1
    yield from keep(walk, "faults_panel", panels=["structures"])


def drawing(walk):
    """A horizon is drawn on a placed scan of a section."""
    import bpy
    import numpy as np

    yield from settled(walk)
    y = 350.0
    path = walk.folder / "scan.png"
    (west, east), (base, top) = guide_scenes.scan(path, "fault_blocks", y)
    with viewport(walk):
        bpy.ops.realmodel.new()
        bpy.ops.realmodel.surface_add(name="top of the clay", empty=True)
        bpy.ops.realmodel.image_place(
            filepath=str(path),
            first=f"{west}, {y}",
            second=f"{east}, {y}",
            heights=f"{base}, {top}",
        )
    path.unlink()
    image = bpy.context.active_object
    fill_view(walk, [image], 0.9, math.radians(12.0))
    yield from settled(walk)
    yield from keep(walk, "placed_scan", panels=["view", "surfaces"])
    with viewport(walk):
        bpy.ops.realmodel.draw_contacts("INVOKE_DEFAULT")
    yield walk.redrawn()
    for share in np.linspace(0.06, 0.42, 9):
        walk.click(
            *walk.pixel_of((west + share * (east - west), y, base + (0.45 + 0.05 * share) * (top - base)))
        )
        yield walk.redrawn()
    yield from keep(walk, "drawn_contacts", panels=["surfaces"])
    walk.key("ESC")
    yield walk.redrawn(2)


def tiles(walk):
    """Two tiles of a plain beside the coarse whole."""
    import bpy

    yield from settled(walk)
    path = guide_scenes.in_tiles(walk.folder, "gravel_plain")
    with viewport(walk):
        bpy.ops.realmodel.tiles_read(filepath=str(path), what="TILES", column=0, row=0, columns=2, rows=2)
    yield from settled(walk)
    items = guide_scenes.visible_meshes()
    for item in items:
        item.scale.z = 8.0
    fill_view(walk, items)
    yield from settled(walk)
    from driver import save_picture

    save_picture(viewed(walk), walk.folder / "tiles.png")


def filling(walk):
    """What Fill with Strata asks, with its presets."""
    import bpy
    from driver import save_picture

    walk.area.spaces.active.show_region_ui = False
    item = guide_scenes.boulder()
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


def meshing(walk):
    """The options of a mesh for simulation, in the file browser."""
    import bpy
    from driver import save_picture
    from guide_window import seen

    yield from example(walk, "two_layers")
    view = bpy.context.preferences.view
    view.filebrowser_display_type = "SCREEN"
    options = {"edge_length": 4.0, "minimum_thickness": 0.7, "layer_thickness": 2.0, "format": "INP"}
    with viewport(walk):
        bpy.ops.realmodel.export_mesh("INVOKE_DEFAULT", filepath=str(walk.folder / "mesh.inp"), **options)
    yield lambda: any(area.type == "FILE_BROWSER" for area in walk.window.screen.areas)
    area = next(area for area in walk.window.screen.areas if area.type == "FILE_BROWSER")
    area.tag_redraw()
    yield lambda: area.spaces.active.params is not None
    for _ in range(40):
        area.tag_redraw()
        yield lambda: True
    save_picture(seen(walk, area), walk.folder / "mesh_options.png")
    with bpy.context.temp_override(window=walk.window, area=area):
        bpy.ops.file.cancel()
    yield lambda: any(area.type == "VIEW_3D" for area in walk.window.screen.areas)
