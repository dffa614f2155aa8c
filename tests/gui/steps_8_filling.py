# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata: the dialog with the beds on the mesh, Esc, OK, one step of undo, and the tab with its steps."""

import bpy
import numpy as np
from realmodel.bl.host import thumbnails
from realmodel.bl.objects import meshes
from realmodel.bl.shading import strata_modifier, strata_presets
from realmodel.ui import start, strata
from steps_1_panel import found_tab, idle
from steps_3_import import invoked


def boulder(n=48):
    """A bumpy ball, the active object."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(2 * n), indexing="ij"))
    u, v = np.pi * j / n, np.pi * (i + 0.5) / n
    rings = np.column_stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)])
    places = np.concatenate([rings, [(0, 0, 1), (0, 0, -1)]])
    x, y, z = places.T
    places *= (2.0 + 0.3 * np.sin(3 * x + 2 * z) * np.cos(4 * y))[:, None]
    ring = np.arange(2 * n)
    onward = np.roll(ring, -1)
    begin = (np.arange(n - 1) * 2 * n)[:, None]
    a, b = (begin + ring).ravel(), (begin + onward).ravel()
    c, d = a + 2 * n, b + 2 * n
    last = (n - 1) * 2 * n
    caps = [np.stack([np.full(2 * n, len(rings)), ring, onward], 1)]
    caps.append(np.stack([np.full(2 * n, len(rings) + 1), last + onward, last + ring], 1))
    triangles = np.concatenate([np.stack([a, c, d], 1), np.stack([a, d, b], 1), *caps])
    item = bpy.data.objects.new("Boulder", meshes.triangle_mesh("Boulder", places, triangles))
    bpy.context.scene.collection.objects.link(item)
    for other in bpy.context.view_layer.objects:
        other.select_set(other == item)
        other.hide_set(other != item)
    bpy.context.view_layer.objects.active = item
    bpy.ops.ed.undo_push(message="boulder")
    return item


def preview_and_cancel(walk):
    """The dialog shows the strata on the mesh; Esc leaves the scene as it was."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    item = boulder()
    known = len(bpy.data.objects)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.fill_with_strata)
    yield walk.redrawn(4)
    assert strata_modifier.beds_of(item) is not None
    icons = {thumbnails.icon("filling.jpg", number) for number in range(7)}
    assert len(icons) == 7 and 0 not in icons
    walk.shot("fill_preview")
    walk.key("ESC")
    yield lambda: not bpy.data.objects["Boulder"].modifiers
    item = bpy.data.objects["Boulder"]
    assert not item.hide_get() and item.select_get()
    assert known == len(bpy.data.objects)


def fill_and_undo(walk):
    """The dialog begins with the preset of the mesh's material, an asset. Enter makes the beds, light and
    camera; Ctrl-Z once takes them all away."""
    bpy.data.objects["Boulder"].data.materials.append(strata_presets.material("FAULTED"))
    bpy.ops.ed.undo_push(message="material")
    scene = bpy.context.scene
    startup = scene.camera.name, scene.world.name, scene.render.engine
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.fill_with_strata)
    yield walk.redrawn(4)
    region = walk.region("WINDOW")
    walk.move(
        region.x + region.width - 60, region.y + 30
    )  # over no field of the dialog, which Enter would open
    yield walk.redrawn(2)
    walk.key("RET")
    yield lambda: "Boulder Strata" in bpy.data.collections and idle()
    yield walk.redrawn(2)
    walk.shot("filled")
    beds = bpy.data.collections["Boulder Strata"].objects
    assert len(beds) == 14
    assert bpy.data.objects["Boulder"].hide_get()
    assert bpy.context.scene.camera.name == "RealModel Camera"
    walk.key("Z", ctrl=True)
    yield lambda: "Boulder Strata" not in bpy.data.collections
    assert not bpy.data.objects["Boulder"].hide_get() and not bpy.data.objects["Boulder"].modifiers
    assert not any(item.name.startswith(("Boulder Bed", "RealModel")) for item in bpy.data.objects)
    scene = bpy.context.scene
    assert startup == (scene.camera.name, scene.world.name, scene.render.engine)
    yield walk.redrawn(2)


def steps_of_the_tab(walk):
    """A rock of the Add menu, other beds, erosion and solids, in the tab Strata."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.strata_rock_add, kind="ARCH", size=4.0, faces=40_000)
    yield lambda: "Strata Arch" in bpy.data.objects
    item = bpy.data.objects["Strata Arch"]
    assert strata_modifier.shows_erosion(item)
    yield from found_tab(walk, strata.REALMODEL_PT_strata_shape, "draw_step")
    invoked(walk, bpy.ops.view3d.view_selected)
    yield walk.redrawn(4)
    walk.shot("strata_tab")
    yield from found_tab(walk, start.REALMODEL_PT_start, "draw_in")
    item.realmodel_strata.beds = 6
    yield walk.redrawn(2)
    item = bpy.data.objects["Strata Arch"]
    assert not strata_modifier.shows_erosion(item), "other beds erode otherwise"
    invoked(walk, bpy.ops.realmodel.strata_erode)
    yield idle
    yield walk.redrawn(2)
    assert strata_modifier.shows_erosion(bpy.data.objects["Strata Arch"])
    invoked(walk, bpy.ops.realmodel.fill_with_strata, use_dialog=False)
    yield lambda: "Strata Arch Strata" in bpy.data.collections and idle()
    yield walk.redrawn(3)
    walk.shot("strata_solid")
    assert bpy.data.objects["Strata Arch"].hide_get()
    bpy.ops.realmodel.strata_edit()
    assert not bpy.data.objects["Strata Arch"].hide_get()


STEPS = (preview_and_cancel, fill_and_undo, steps_of_the_tab)
