# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of rock masses."""

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, IntProperty
from bpy_extras.io_utils import ImportHelper
from mathutils.geometry import convex_hull_2d

from ..bl.objects import shapes
from ..bl.project import plan_mesh, project_settings, settings
from ..bl.scene import built_scene, data_objects, live
from ..core import InputRefused
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

_ABOVE = 0.1  # of the height of the points: how far over them a region is, as on the walls it would flicker


class REALMODEL_OT_rock_add(Reporting, bpy.types.Operator):
    """Add a rock mass: a region in plan with its own surfaces"""

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
    """Remove the active rock mass with its surfaces and blocks. Your own meshes stay in the scene"""

    bl_label = "Remove Rock Mass"
    needs = (a_rock,)

    def act(self, context):
        scene, group = context.scene, context.scene.realmodel
        row = settings.active_rock(scene)
        built_scene.remove_rock(scene, row)
        with settings.filling():
            group.rocks.remove(list(group.rocks).index(row))
            group.active_rock = max(0, min(group.active_rock, len(group.rocks) - 1))
        data_objects.update(scene)
        live.touch(scene)


class REALMODEL_OT_rock_copy(Reporting, bpy.types.Operator):
    """Add a copy of the active rock mass: the same region and settings, its surfaces from the same sources"""

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


class REALMODEL_OT_region_around(Reporting, bpy.types.Operator):
    """Draw the region of the rock mass around the points of its surfaces, as a curve that you can edit"""

    bl_label = "Region Around Points"
    needs = (a_rock,)

    shape: EnumProperty(
        name="Shape",
        description="Shape of the outline around the points",
        items=(
            (
                "RECTANGLE",
                "Rectangle",
                "From the westernmost to the easternmost point, and likewise north",
            ),
            ("HULL", "Convex Hull", "As near around the points as an outline without dents can be"),
        ),
    )
    margin: FloatProperty(
        name="Margin",
        description="Distance of the region from the points, in percent of their extent; of a map 0 where "
        "it is not given",
        subtype="PERCENTAGE",
        default=5.0,
        min=0.0,
        soft_max=50.0,
    )
    rock: IntProperty(
        name="Rock Mass",
        description="Its number, counted from 0; -1: the active one",
        default=-1,
        min=-1,
        options={"SKIP_SAVE", "HIDDEN"},
    )

    def act(self, context):
        scene, group = context.scene, context.scene.realmodel
        row = settings.active_rock(context.scene)
        if self.rock >= 0:
            if self.rock >= len(group.rocks):
                raise InputRefused(f"there is no rock mass {self.rock}", advice="they are counted from 0")
            row = group.rocks[self.rock]
        points = data_objects.points_of(scene, row, context.evaluated_depsgraph_get())
        data_objects.begin(scene, points)
        places = points - project_settings.model_origin(scene)
        low, high = places.min(axis=0), places.max(axis=0)
        is_at_edge = bool(row.map) and not self.properties.is_property_set("margin")  # beyond it is no ground
        margin = 0.0 if is_at_edge else self.margin / 100.0 * float(np.hypot(*(high - low)[:2]))
        if self.shape == "HULL":
            corners = places[convex_hull_2d(places[:, :2].tolist()), :2]
            middle = corners.mean(axis=0)
            away = corners - middle
            corners = middle + away * (1.0 + margin / np.linalg.norm(away, axis=1, keepdims=True).min())
        else:
            (x, y), (east, north) = low[:2] - margin, high[:2] + margin
            corners = [(x, y), (east, y), (east, north), (x, north)]
        if len(corners) < 3 or not (high - low)[:2].all():
            raise InputRefused(
                "the points lie in one line", advice="draw the region, or import further points"
            )
        above = high[2] + _ABOVE * (high[2] - low[2])
        row.region = shapes.new_outline(scene, f"{row.name} region", corners, above)
        self.report({"INFO"}, f"{row.region.name}: a curve, which you can edit")


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
