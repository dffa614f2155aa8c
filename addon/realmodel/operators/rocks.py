# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of rock masses."""

import bpy

from ..bl import built_scene, live, settings
from .reporting import Reporting, a_rock


class REALMODEL_OT_rock_add(Reporting, bpy.types.Operator):
    """Add a rock mass: a region in plan with surfaces of its own"""

    bl_idname = "realmodel.rock_add"
    bl_label = "Add Rock Mass"

    def act(self, context):
        add_rock(context.scene)
        live.touch(context.scene)


def add_rock(scene):
    """A new, empty rock mass, which becomes the active one."""
    group = scene.realmodel
    with settings.filling():
        if not group.exists:
            settings.begin(group)
            group.name = group.name or "Model"
        row = group.rocks.add()
        row.name = settings.free_name(group.rocks, "rock mass", own=row)
        group.active_rock = len(group.rocks) - 1
    return row


class REALMODEL_OT_rock_remove(Reporting, bpy.types.Operator):
    """Remove the active rock mass with its surfaces and blocks; meshes that you brought stay in the scene"""

    bl_idname = "realmodel.rock_remove"
    bl_label = "Remove Rock Mass"
    needs = (a_rock,)

    def act(self, context):
        scene, group = context.scene, context.scene.realmodel
        row = settings.active_rock(scene)
        built_scene.remove_rock(scene, row)
        with settings.filling():
            group.rocks.remove(list(group.rocks).index(row))
            group.active_rock = max(0, min(group.active_rock, len(group.rocks) - 1))
            group.stage = settings.last_stage(scene)
        live.touch(scene)


class REALMODEL_OT_rock_copy(Reporting, bpy.types.Operator):
    """Add a copy of the active rock mass: the same region and settings, its surfaces from the same sources"""

    bl_idname = "realmodel.rock_copy"
    bl_label = "Copy Rock Mass"
    needs = (a_rock,)

    def act(self, context):
        group = context.scene.realmodel
        number = list(group.rocks).index(settings.active_rock(context.scene))
        row = group.rocks.add()
        source = group.rocks[number]
        settings.copy_row(source, row)
        with settings.filling():
            row.name = settings.free_name(group.rocks, source.name, own=row)
            row.collection = row.interfaces = row.blocks = None
            for surface in row.surfaces:
                surface.interface, surface.interface_digest, surface.figures = None, "", ""
                if surface.source in ("POINTS_FILE", "MESH_FILE"):
                    surface.object = None
            group.active_rock = len(group.rocks) - 1
        live.touch(context.scene)


CLASSES = (REALMODEL_OT_rock_add, REALMODEL_OT_rock_remove, REALMODEL_OT_rock_copy)
