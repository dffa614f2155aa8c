# SPDX-License-Identifier: GPL-3.0-or-later
"""The planar mesh of a region: refinement, constraints."""

import bpy
from bpy.props import IntProperty
from bpy_extras.io_utils import ImportHelper

from ..bl.project import plan_mesh, settings
from ..bl.scene import live
from ..core.project.plan_input import read_constraints
from ..core.readers.formats import SHAPES, endings
from .reporting import (
    Reporting,
    a_rock,
    an_outline_object,
    chosen_path,
    file_filter,
    remove_row,
    require_file,
    row_number,
)


class REALMODEL_OT_size_add(Reporting, bpy.types.Operator):
    """Add smaller triangles: along the outline, or at the active curve or mesh object"""

    bl_label = "Add Smaller Triangles"
    needs = (a_rock,)

    def act(self, context):
        rock, obj = settings.active_rock(context.scene), context.active_object
        with settings.filling():
            row = rock.sizes.add()
            if not an_outline_object(context) and obj != rock.region:
                row.at, row.object = "OBJECT", obj
            row.length = rock.edge_length / 4.0 or 1.0
        live.touch(context.scene)


class REALMODEL_OT_size_remove(Reporting, bpy.types.Operator):
    """Remove the smaller triangles there"""

    bl_label = "Remove Smaller Triangles"
    needs = (a_rock,)

    index: row_number()

    def act(self, context):
        remove_row(settings.active_rock(context.scene).sizes, self.index, "entry")
        live.touch(context.scene)


class REALMODEL_OT_constraint_add(Reporting, bpy.types.Operator):
    """Add the edges of the active curve or mesh object to the mesh, such as a river or a fault trace"""

    bl_label = "Add Constraint"
    needs = (a_rock, an_outline_object)

    def act(self, context):
        rock = settings.active_rock(context.scene)
        with settings.filling():
            rock.constraints.add().object = context.active_object
        live.touch(context.scene)


class REALMODEL_OT_constraint_remove(Reporting, bpy.types.Operator):
    """Remove a constraint from the mesh; its object stays in the scene"""

    bl_label = "Remove Constraint"
    needs = (a_rock,)

    index: IntProperty(
        name="Number", description="Which of them, counted from 0; -1: all that were read from files", min=-1
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        if self.index < 0:
            rock.constraints_stored = {}
        else:
            remove_row(rock.constraints, self.index, "constraint")
        live.touch(context.scene)


class REALMODEL_OT_constraint_read(Reporting, bpy.types.Operator, ImportHelper):
    """Read lines and points that the mesh must contain from a file (GeoJSON, WKT, shapefile, GeoPackage)"""

    bl_label = "Read Constraints"
    needs = (a_rock,)

    filename_ext = ""
    filter_glob: file_filter(*endings(SHAPES), ".txt")

    def act(self, context):
        rock = settings.active_rock(context.scene)
        path = chosen_path(self, "the constraints")
        require_file(path)
        constraints = read_constraints([path], context.scene.realmodel.units)
        plan_mesh.add_constraints(rock, constraints)
        live.touch(context.scene)
        self.report({"INFO"}, f"Lines and points read: {len(constraints)}")

    def check(self, _context):
        return False  # a file of any ending
