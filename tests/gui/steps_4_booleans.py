# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of two objects: Esc, the result, and one step of undo."""

import bpy
import numpy as np
from realmodel.bl.objects import meshes
from steps_1_panel import idle
from steps_3_import import invoked


def _rings(n):
    """Two rings of 2 n^2 triangles that cross, the first of them active."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / n
    along = 1.0 + 0.4 * np.cos(v)
    coordinates = np.stack([along * np.cos(u), along * np.sin(u), 0.4 * np.sin(v)], axis=1)
    a, b, c, d = i * n + j, (i + 1) % n * n + j, (i + 1) % n * n + (j + 1) % n, i * n + (j + 1) % n
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    items = []
    for number, place in enumerate(((0.0, 0.0, 0.0), (0.7, 0.3, 0.2))):
        name = f"Ring {number + 1}"
        item = bpy.data.objects.new(name, meshes.triangle_mesh(name, coordinates, triangles))
        item.location = place
        bpy.context.scene.collection.objects.link(item)
        items.append(item)
    for item in bpy.context.view_layer.objects:
        item.select_set(item in items)
    bpy.context.view_layer.objects.active = items[0]
    bpy.ops.ed.undo_push(message="rings")
    return items


def _faces(name):
    return len(bpy.data.objects[name].data.polygons)


def cancel_a_boolean(walk):
    """Esc stops it while progress is shown; both objects are as they were."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    for item in _rings(500):
        item.display_type = "BOUNDS"  # or drawing them would take longer than the work
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.boolean, operation="UNION")
    yield lambda: bpy.context.window_manager.realmodel.progress > 0.5 or idle()
    yield walk.redrawn()
    assert not idle(), "it was over before it could be cancelled"
    walk.key("ESC")
    yield idle
    assert _faces("Ring 1") == _faces("Ring 2") == 2 * 500 * 500
    assert not bpy.data.objects["Ring 2"].hide_get()


def boolean_and_undo(walk):
    """The result, and Ctrl-Z once."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    _rings(48)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.boolean, operation="DIFFERENCE")
    yield lambda: bpy.data.objects["Ring 2"].hide_get() and idle()
    yield walk.redrawn(2)
    walk.shot("boolean")
    assert _faces("Ring 1") != 2 * 48 * 48
    with bpy.context.temp_override(window=walk.window, area=walk.area, region=walk.region("WINDOW")):
        assert bpy.ops.realmodel.boolean.poll(), "its panel (F9) would change nothing"
    walk.key("Z", ctrl=True)
    yield lambda: not bpy.data.objects["Ring 2"].hide_get()
    assert _faces("Ring 1") == _faces("Ring 2") == 2 * 48 * 48
    yield walk.redrawn(2)


STEPS = (cancel_a_boolean, boolean_and_undo)
