# SPDX-License-Identifier: GPL-3.0-or-later
"""The model to where Blender's numbers are fine."""

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..bl.objects import exaggeration, shapes, viewports
from ..bl.objects.origin import KEY, choose_origin
from ..bl.project import project_settings, settings
from ..bl.scene import built_scene, data_objects
from ..core import InputRefused
from .reporting import Reporting, any_surface, not_building
from .start import invoke


class REALMODEL_OT_move_to_zero(Reporting, bpy.types.Operator):
    """Choose another origin so that a model far from the zero of the scene stands near it. Your objects that
    it is made from move with it; all model coordinates stay. A built model is built again"""

    bl_label = "Move Model to Scene's Zero"
    needs = (any_surface, not_building)

    def act(self, context):
        scene = context.scene
        context.view_layer.update()
        mine = list(dict.fromkeys(project_settings.user_objects(scene)))
        made = [row.object for row in scene.realmodel.results if row.object is not None]
        rows = [row for _, row in settings.interface_rows(scene)]
        interfaces = [row for row in rows if row.interface is not None and row.interface not in mine]
        made += [row.interface for row in interfaces]
        items = [*mine, *made, *data_objects.objects(scene)]
        corners = [obj.matrix_world @ Vector(corner) for obj in items for corner in obj.bound_box]
        old = project_settings.model_origin(scene)
        if not corners:
            raise InputRefused("there is nothing to move yet", advice="import surfaces first")
        moved = old - (new := choose_origin(np.array(corners, float) + old))
        if not moved.any():
            raise InputRefused("the model stands near the zero of the scene")
        scene[KEY] = [float(value) for value in new]
        for obj in {_top(obj) for obj in mine}:
            obj.matrix_basis = Matrix.Translation(moved) @ obj.matrix_basis
        unchanged = [row for row in interfaces if _digest(context, row) == row.interface_digest]
        for mesh in {obj.data for obj in made}:
            mesh.transform(Matrix.Translation(moved))
            mesh.update()
        with settings.filling():
            for row in unchanged:
                row.interface_digest = _digest(context, row)
        built_scene.move_helpers(scene, moved)
        context.view_layer.update()
        viewports.frame_items(items, viewports.spaces(context))
        self.report({"INFO"}, "Moved by " + ", ".join(f"{value:,.0f}" for value in moved))
        if len(scene.realmodel.results):
            invoke(bpy.ops.realmodel.build, self)


def _digest(context, row):
    return shapes.digest(*shapes.triangulation(row.interface, context.evaluated_depsgraph_get()))


def _top(obj):
    """The object that carries another along, or itself."""
    while obj.parent is not None and exaggeration.KEY not in obj.parent:
        obj = obj.parent
    return obj
