# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of faults and bodies have in common: walls, boxes, displaced sheets and a model of them."""

import bpy
import numpy as np
from mathutils import Matrix
from panel_case import PanelCase, ops, select
from realmodel.bl.objects import meshes
from realmodel.bl.project import settings

THROW = 4.0


def mesh_object(name, vertices, triangles):
    """A mesh object of the scene."""
    mesh = meshes.triangle_mesh(name, np.asarray(vertices, np.float32), np.asarray(triangles))
    item = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(item)
    return item


def wall(name="F1", x=50.0, z=(-60.0, 60.0), y=(-20.0, 120.0), lean=0.0):
    """A plane along y through (x, 0, 0), which leans to the east going down."""
    corners = [(x - lean * h, at, h) for h, at in ((z[0], y[0]), (z[0], y[1]), (z[1], y[1]), (z[1], y[0]))]
    return mesh_object(name, corners, [[0, 1, 2], [0, 2, 3]])


def box(name, low, high):
    """A closed box."""
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    item = bpy.context.object
    item.name = name
    low, high = np.array(low), np.array(high)
    item.data.transform(Matrix.LocRotScale((low + high) / 2, None, tuple(high - low)))
    return item


def stepped(name, height, x=50.0, throw=THROW):
    """A level sheet, in two parts that a fault at x has moved apart: the east lies lower."""
    parts = [(0.0, x, height), (x, 100.0, height - throw)]
    vertices = [
        (a, y, z) for west, east, z in parts for a, y in ((west, 0), (east, 0), (east, 100), (west, 100))
    ]
    return mesh_object(name, vertices, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])


class StructureCase(PanelCase):
    def faulted(self, *more, build=True, throw=THROW):
        """Three level surfaces over a base, displaced by F1; more: further objects."""
        items = [stepped(f"S{n}", 10.0 * n, throw=throw) for n in range(3)]
        select(*items)
        ops.from_selected(add_base=True)
        settings.active_rock(self.scene).base_elevation = -20.0
        select(wall(), *more)
        ops.fault_body_from_selected()
        if build:
            ops.build()
        return items

    def objects(self, kind):
        return [item for item in self.scene.objects if item.get("realmodel") == kind]
