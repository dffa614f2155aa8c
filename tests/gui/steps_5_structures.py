# SPDX-License-Identifier: GPL-3.0-or-later
"""A fault and a body from selected meshes, and the compartments moved apart, as seen in the window."""

import bpy
import numpy as np
from realmodel.bl.display import bodies, shades
from realmodel.bl.objects import meshes
from realmodel.bl.project import compartments
from steps_1_panel import idle, open_the_tab, tab_panels
from steps_2_view import in_the_viewport
from steps_3_import import invoked

_WALL = ([(50, -20, -60), (50, 120, -60), (50, 120, 60), (50, -20, 60)], [[0, 1, 2], [0, 2, 3]])


def _sheet(height):
    parts = [(0, 50, height), (50, 100, height - 12)]
    corners = [
        (x, y, z) for west, east, z in parts for x, y in ((west, 0), (east, 0), (east, 100), (west, 100))
    ]
    return corners, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]


def _object(name, vertices, triangles):
    item = bpy.data.objects.new(name, meshes.triangle_mesh(name, np.array(vertices, np.float32), triangles))
    bpy.context.scene.collection.objects.link(item)
    return item


def _select(items):
    bpy.context.view_layer.update()
    for item in bpy.context.view_layer.objects:
        item.select_set(item in items)
    bpy.context.view_layer.objects.active = items[-1]


def compartments_apart(walk):
    """Both colors of the compartments are seen, with the background between them."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    with in_the_viewport(walk):
        _select([_object(f"S{n}", *_sheet(30.0 * n)) for n in range(2)])
        bpy.ops.realmodel.from_selected()
        _select([_object("Fault", *_WALL)])
        bpy.ops.realmodel.fault_body_from_selected()
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(bpy.context.scene.realmodel.results) > 0
    group = bpy.context.scene.realmodel
    assert len(compartments.names(bpy.context.scene)) == 2
    group.color_by = "COMPARTMENT"
    group.explode_direction, group.explode = "COMPARTMENT", 1.0
    with in_the_viewport(walk):
        bpy.ops.realmodel.view_all()
    yield walk.redrawn(3)
    assert bodies.of_kind(bpy.context.scene, bodies.CELLS)
    shown = walk.shot("compartments")
    for number in range(2):
        red, green, blue = shades.compartment_color(number)
        ratio = shown[..., :3] / np.maximum(shown[..., :3].max(axis=2, keepdims=True), 1e-3)
        wanted = np.array([red, green, blue]) / max(red, green, blue)
        assert (np.abs(ratio - wanted).max(axis=2) < 0.06).sum() > 500, number


def _show_alone(wanted):
    """Registers these panels of the tab alone, unfolded; returns all that there were."""
    found = tab_panels()
    for cls in reversed(found):
        bpy.utils.unregister_class(cls)
    for cls in found:
        if cls.__name__ in wanted:
            cls.bl_options = set(getattr(cls, "bl_options", ())) - {"DEFAULT_CLOSED"}
            bpy.utils.register_class(cls)
    return found


def lists_of_faults_and_bodies(walk):
    """The lists of the example with faults: the copy of a row, and a new name that others follow."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    panels = _show_alone({"REALMODEL_PT_start", "REALMODEL_PT_structures"})
    try:
        yield from open_the_tab(walk)
        with in_the_viewport(walk):
            bpy.ops.realmodel.open_sample(sample="fault_blocks")
        yield lambda: idle() and len(bpy.context.scene.realmodel.results) > 0
        group = bpy.context.scene.realmodel
        group.structure_kind, group.active_fault = "FAULT", 1
        yield walk.redrawn(3)
        walk.shot("faults")
        group.faults[0].name = "East fault"
        assert group.faults[1].ends_at[0].name == "East fault"
        with in_the_viewport(walk):
            bpy.ops.realmodel.fault_body_copy()
        yield walk.redrawn(3)
        walk.shot("faults_copied")
        group.structure_kind = "BODY"
        yield walk.redrawn(3)
        walk.shot("bodies")
    finally:
        for cls in panels:
            if not cls.is_registered:
                bpy.utils.register_class(cls)


def a_line_with_a_dip(walk):
    """A curve on the ground becomes a fault; with its dip the compartments are others."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    panels = _show_alone({"REALMODEL_PT_start", "REALMODEL_PT_structures"})
    try:
        yield from open_the_tab(walk)
        with in_the_viewport(walk):
            _select([_object(f"S{n}", *_sheet(30.0 * n)) for n in range(2)])
            bpy.ops.realmodel.from_selected()
            curve = bpy.data.curves.new("Scarp", "CURVE")
            curve.dimensions = "3D"
            line = curve.splines.new("POLY")
            line.points.add(1)
            line.points.foreach_set("co", (50, 10, 30, 1, 50, 90, 30, 1))
            item = bpy.data.objects.new("Scarp", curve)
            bpy.context.scene.collection.objects.link(item)
            _select([item])
            bpy.ops.realmodel.fault_body_from_selected()
        group = bpy.context.scene.realmodel
        group.faults[0].dip, group.faults[0].dip_direction = 60.0, "E"
        walk.over_viewport()
        invoked(walk, bpy.ops.realmodel.build)
        yield lambda: idle() and len(group.results) > 0
        volumes = compartments.read(bpy.context.scene)["volumes"]["S1 block"]
        assert max(volumes) > 1.1 * min(volumes), volumes
        yield walk.redrawn(3)
        walk.shot("trace")
    finally:
        for cls in panels:
            if not cls.is_registered:
                bpy.utils.register_class(cls)


STEPS = (compartments_apart, lists_of_faults_and_bodies, a_line_with_a_dip)
