# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects for the tests of Booleans of mesh objects, and what they ask of the results."""

import math

import bpy
import numpy as np
from blender_state import coordinates, open_edges
from panel_case import PanelCase, ops, select

_FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def solid(name, vertices, faces, at=(0.0, 0.0, 0.0)):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    item = bpy.data.objects.new(name, mesh)
    item.location = at
    bpy.context.collection.objects.link(item)
    return item


def cube(name, at=(0.0, 0.0, 0.0), size=2.0):
    half = size / 2
    vertices = [((n & 1) * size - half, (n >> 1 & 1) * size - half, (n >> 2) * size - half) for n in range(8)]
    return solid(name, vertices, _FACES, at)


def ball(name, radius=1.0, at=(0.0, 0.0, 0.0), n=16):
    """Rings of quads, and triangles at the poles."""
    vertices = [(0, 0, radius)]
    for ring in range(1, n):
        theta = math.pi * ring / n
        for k in range(2 * n):
            phi = math.pi * k / n
            vertices.append(
                (
                    radius * math.sin(theta) * math.cos(phi),
                    radius * math.sin(theta) * math.sin(phi),
                    radius * math.cos(theta),
                )
            )
    vertices.append((0, 0, -radius))
    last, m = len(vertices) - 1, 2 * n
    faces = [(0, 1 + k, 1 + (k + 1) % m) for k in range(m)]
    for ring in range(n - 2):
        a, b = 1 + ring * m, 1 + (ring + 1) * m
        faces += [(a + k, b + k, b + (k + 1) % m, a + (k + 1) % m) for k in range(m)]
    faces += [(last, last - m + (k + 1) % m, last - m + k) for k in range(m)]
    return solid(name, vertices, faces, at)


def material(name):
    return bpy.data.materials.new(name)


def world(item):
    """(V, 3): the vertices of an object in the world."""
    matrix = np.array(item.matrix_world)
    return coordinates(item.data) @ matrix[:3, :3].T + matrix[:3, 3]


def corner_uvs(mesh, name="UVMap"):
    found = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[name].data.foreach_get("uv", found)
    return found.reshape(-1, 2)


def attribute(mesh, name, kind="value", columns=1):
    data = mesh.attributes[name].data
    found = np.empty(len(data) * columns, np.float32)
    data.foreach_get(kind, found)
    return found.reshape(-1, columns) if columns > 1 else found


class BooleanCase(PanelCase):
    def run_boolean(self, first, second, operation, **options):
        """The first is the active one; returns the active object afterwards."""
        select(second, first)
        ops.boolean(operation=operation, **options)
        found = bpy.context.view_layer.objects.active
        if operation != "DIVIDE":
            self.assert_sound(found.data)
            self.assertEqual(open_edges(found.data), 0)
        return found

    def assert_sound(self, mesh):
        """Blender finds nothing to correct."""
        before = len(mesh.vertices), len(mesh.edges), len(mesh.polygons)
        self.assertFalse(mesh.validate(verbose=True), mesh.name)
        self.assertEqual((len(mesh.vertices), len(mesh.edges), len(mesh.polygons)), before)

    def division(self, first, second, **options):
        """{kind: [object, ...]}."""
        known = set(bpy.data.objects)
        self.run_boolean(first, second, "DIVIDE", **options)
        made = [item for item in bpy.data.objects if item not in known]
        for item in made:
            self.assert_sound(item.data)
        kinds = ("sub_surface", "sub_block", "loop")
        return {kind: [item for item in made if item["realmodel"] == kind] for kind in kinds}
