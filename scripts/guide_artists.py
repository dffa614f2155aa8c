# SPDX-License-Identifier: GPL-3.0-or-later
"""The chapters of docs/guide/artists.md: from an empty file to a cliff, and an export that is opened again.
Needs Blender."""

import math

import sculptures
from guide_window import fill_view, keep, open_tab, viewed, viewport

_BEDS = (
    60.0,
    173.0,
)  # of the header of the panel Beds, from the upper left of the sidebar, at scale 1


def artists(walk):
    """The menu Add, a cliff after erosion, beds on a sculpted mesh."""
    import bpy
    from driver import read_screen, save_picture

    bpy.context.preferences.view.show_tooltips = False
    with viewport(walk):
        bpy.ops.realmodel.strata_rock_add(kind="CLIFF", strength=1.3, faces=600_000)
    item = bpy.context.active_object
    yield from open_tab(walk, "strata_shape")
    region, scale = walk.region("UI"), bpy.context.preferences.view.ui_scale
    walk.click(region.x + _BEDS[0] * scale, region.y + region.height - _BEDS[1] * scale)
    fill_view(walk, [item], 0.96, math.radians(14.0), azimuth=math.radians(163.0))
    item.select_set(False)  # without the outlines of its stones
    yield from keep(walk, "artists_eroded")
    region = walk.region("WINDOW")
    walk.move(region.x + 0.12 * region.width, region.y + 0.9 * region.height)
    yield walk.redrawn(2)
    walk.key("A", shift=True)
    for key in ("UP_ARROW", "RIGHT_ARROW"):  # to the last entry, and into its menu
        yield walk.redrawn(3)
        walk.key(key)
    yield walk.redrawn(4)
    area = walk.area
    save_picture(read_screen(walk.screen)[:, area.x : area.x + area.width], walk.folder / "artists_add.png")
    for _ in range(2):
        walk.key("ESC")
        yield walk.redrawn(2)
    walk.click(walk.region("UI").x + _BEDS[0] * scale, region.y + region.height - _BEDS[1] * scale)
    bpy.data.objects.remove(item)
    item = sculptures.boulder()
    for polygon in item.data.polygons:
        polygon.use_smooth = True
    with viewport(walk):
        bpy.ops.realmodel.strata_preset(preset="FOLDED")
    item.select_set(False)
    fill_view(walk, [item], 0.94)
    yield from keep(walk, "artists_beds")


def exported(walk):
    """An arch that was exported as glTF, in an empty file, as Material Preview shows it."""
    import bpy
    import numpy as np
    from driver import save_picture

    path = walk.folder / "arch.glb"
    with viewport(walk):
        bpy.ops.realmodel.strata_rock_add(kind="ARCH", strength=0.6, seed=2, faces=40_000)
        bpy.ops.realmodel.fill_with_strata("EXEC_DEFAULT", use_dialog=False)
        if "gltf" not in dir(bpy.ops.export_scene):
            bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
        bpy.ops.realmodel.export_scene(filepath=str(path), picture_size=512)
        for item in list(bpy.data.objects):
            bpy.data.objects.remove(item)
        np.bool = bool  # which the importer of Blender 3.4 asks a newer NumPy for
        bpy.ops.import_scene.gltf(filepath=str(path))
    path.unlink()
    walk.area.spaces.active.shading.type = "MATERIAL"
    for item in bpy.context.selected_objects:
        item.select_set(False)
    fill_view(walk, [o for o in bpy.data.objects if o.type == "MESH"], 0.9, azimuth=math.radians(150.0))
    yield walk.redrawn(20)
    save_picture(viewed(walk), walk.folder / "artists_export.png")
