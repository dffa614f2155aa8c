# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of two mesh objects: volumes, and what stays of materials, attributes and transforms."""

import math
import runpy
import unittest
from itertools import pairwise

import bpy
import numpy as np
from blender_state import coordinates, corners, inventory, open_edges, volume
from mathutils import Euler, Matrix
from panel_case import SAMPLES, PanelCase, ops, select, sheet, stack
from realmodel.bl import versions
from realmodel.bl.boolean_job import BooleanJob
from realmodel.core import Cancelled

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


class Case(PanelCase):
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


class Solids(Case):
    def test_volumes(self):
        for operation, wanted in (("UNION", 15.0), ("INTERSECT", 1.0), ("DIFFERENCE", 7.0)):
            a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
            found = self.run_boolean(a, b, operation)
            self.assertEqual((found, found.name), (a, "A"))
            self.assertEqual(volume(found.data), wanted)
            self.assertTrue(b.hide_get() and b.hide_render)
            self.assertEqual(bpy.context.selected_objects, [a])
            for item in (a, b):
                bpy.data.objects.remove(item)

    def test_quads_that_are_not_divided_stay(self):
        found = self.run_boolean(ball("A"), cube("B", (0.0, 0.0, 1.0), 1.0), "DIFFERENCE")
        sizes = np.diff(corners(found.data)[0])
        self.assertGreater(np.count_nonzero(sizes == 4), 300)
        untouched = self.run_boolean(cube("C"), cube("D", (9.0, 0.0, 0.0)), "UNION")
        self.assertEqual(np.diff(corners(untouched.data)[0]).tolist(), [4] * 12)

    def test_vertices_of_the_active_object_stay_to_the_last_bit(self):
        a, b = ball("A", 0.7, (1000.3, 0.1, 0.0)), ball("B", 0.5, (1000.3, 0.9, 0.0))
        a.rotation_euler = b.rotation_euler = (0.1, 0.2, 0.3)
        before = {tuple(place) for place in coordinates(a.data).tolist()}
        found = self.run_boolean(a, b, "UNION")
        after = {tuple(place) for place in coordinates(found.data).tolist()}
        self.assertGreater(len(after & before), 0.5 * len(before))

    def test_transforms(self):
        """Scaled unevenly, mirrored and turned: the volume is that of the shapes as they are shown."""
        for scale in ((1.0, 1.0, 1.0), (2.0, 0.5, 1.0), (-1.0, 1.0, 1.0), (-2.0, 0.5, -1.5)):
            for mirrored in (1.0, -1.0):
                a, b = ball("A"), ball("B", 1.0, (0.2, 0.3, 0.4))
                a.scale, a.rotation_euler = (mirrored, 1.5, 1.0), (0.3, 0.1, -0.4)
                b.scale, b.rotation_euler = scale, (0.5, -0.2, 0.7)
                bpy.context.view_layer.update()
                parts = [volume(i.data) * abs(i.matrix_world.determinant()) for i in (a, b)]
                both = {}
                for operation in ("UNION", "INTERSECT"):
                    one = self.run_boolean(a, b, operation, keep_operands=True)
                    self.assertEqual(one.matrix_world, a.matrix_world)
                    self.assertGreater(volume(one.data) * mirrored, 0 if mirrored > 0 else -1e9)
                    self.assertGreater(volume(one.data), 0, "it faces outward in its own coordinates")
                    both[operation] = volume(one.data) * abs(one.matrix_world.determinant())
                self.assertAlmostEqual(sum(both.values()), sum(parts), delta=1e-5 * sum(parts))
                for item in list(bpy.data.objects):
                    bpy.data.objects.remove(item)

    def test_a_parent_counts(self):
        empty = bpy.data.objects.new("Parent", None)
        bpy.context.collection.objects.link(empty)
        empty.location = (1.0, 1.0, 1.0)
        a, b = cube("A"), cube("B")
        b.parent = empty
        self.assertEqual(volume(self.run_boolean(a, b, "INTERSECT").data), 1.0)

    def test_faces_in_one_plane(self):
        """Side by side, one on the other, and equal: exact, so nothing is left between."""
        found = self.run_boolean(cube("A"), cube("B", (2.0, 0.0, 0.0)), "UNION")
        self.assertEqual(volume(found.data), 16.0)
        self.assertFalse((world(found)[:, 0] == 1.0).all())
        found = self.run_boolean(cube("C"), cube("D"), "INTERSECT")
        self.assertEqual((volume(found.data), len(found.data.vertices)), (8.0, 8))
        found = self.run_boolean(cube("E"), cube("F", (1.5, 0.0, 0.0), 1.0), "DIFFERENCE")
        self.assertEqual(volume(found.data), 8.0)

    def test_modifiers_are_applied(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        array = a.modifiers.new("Array", "ARRAY")
        array.relative_offset_displace = (2.0, 0.0, 0.0)
        b.modifiers.new("Subdivision", "SUBSURF")
        found = self.run_boolean(a, b, "UNION")
        self.assertFalse(len(found.modifiers))
        self.assertEqual(len(b.modifiers), 1)
        self.assertGreater(volume(found.data), 16.0)

    def test_shape_keys_are_applied(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        a.shape_key_add(name="Basis")
        key = a.shape_key_add(name="Up")
        for point in key.data:
            point.co.z += 4.0
        key.value = 0.5
        found = self.run_boolean(a, b, "INTERSECT")
        self.assertIsNone(found.data.shape_keys)
        self.assertAlmostEqual(volume(found.data), 1.0 * 1.0 * 1.0, places=5)

    def test_others_keep_a_mesh_that_they_share(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        other = bpy.data.objects.new("Other", a.data)
        bpy.context.collection.objects.link(other)
        self.run_boolean(a, b, "UNION")
        self.assertEqual(len(other.data.polygons), 6)
        self.assertNotEqual(other.data, a.data)

    def test_keep_operands(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        before = coordinates(a.data).tobytes()
        found = self.run_boolean(a, b, "DIFFERENCE", keep_operands=True)
        self.assertEqual(found.name, "A Difference")
        self.assertEqual(volume(found.data), 7.0)
        self.assertEqual(coordinates(a.data).tobytes(), before)
        self.assertFalse(b.hide_get() or b.hide_render)
        self.assertFalse([mesh.name for mesh in bpy.data.meshes if not mesh.users])

    def test_properties_and_names_of_the_mesh_stay(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        a.data.name, a.data["note"] = "My Mesh", "mine"
        found = self.run_boolean(a, b, "UNION")
        self.assertEqual((found.data.name, found.data["note"]), ("My Mesh", "mine"))
        self.assertFalse([mesh.name for mesh in bpy.data.meshes if not mesh.users])


class Layers(Case):
    def test_materials(self):
        red, blue, green = (material(name) for name in ("red", "blue", "green"))
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        for kept in (red, blue):
            a.data.materials.append(kept)
        a.data.polygons[5].material_index = 1  # x = 1
        for kept in (green, blue):
            b.data.materials.append(kept)
        b.data.polygons[0].material_index = 1  # z = 0 in the world
        found = self.run_boolean(a, b, "DIFFERENCE")
        mesh = found.data
        self.assertEqual(list(mesh.materials), [red, blue, green])
        for polygon in mesh.polygons:
            at, normal = polygon.center, polygon.normal
            if (normal.x > 0.9 and at.x > 0.9) or (normal.z > 0.9 and abs(at.z) < 0.1):
                wanted = blue
            else:
                wanted = green if max(at) < 0.9 and min(at) > -0.1 and max(normal) > 0.9 else red
            self.assertEqual(mesh.materials[polygon.material_index], wanted, (tuple(at), tuple(normal)))

    def test_an_object_without_materials(self):
        red = material("red")
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        a.data.materials.append(red)
        mesh = self.run_boolean(a, b, "DIFFERENCE").data  # as of Blender's Boolean: the cut is red as well
        self.assertEqual(list(mesh.materials), [red])
        a, b = cube("C"), cube("D", (1.0, 1.0, 1.0))
        b.data.materials.append(red)
        mesh = self.run_boolean(a, b, "UNION").data
        self.assertEqual(list(mesh.materials), [None, red])
        self.assertEqual({p.material_index for p in mesh.polygons}, {0, 1})

    def test_materials_of_the_object(self):
        red, blue = material("red"), material("blue")
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        a.data.materials.append(red)
        a.material_slots[0].link, a.material_slots[0].material = "OBJECT", blue
        found = self.run_boolean(a, b, "UNION")
        self.assertEqual([slot.material for slot in found.material_slots], [blue])

    def test_uv_maps_are_interpolated(self):
        """The maps are linear in space, so that they are known everywhere."""
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        for item, factor in ((a, 1.0), (b, 10.0)):
            uv_map = item.data.uv_layers.new(name="UVMap")
            at = world(item)[versions.corner_vertices(item.data)] if factor == 1.0 else None
            bpy.context.view_layer.update()
            at = world(item)[versions.corner_vertices(item.data)]
            uv_map.data.foreach_set("uv", (at[:, :2] * factor + at[:, 2:]).astype(np.float32).ravel())
            item.data.materials.append(material(f"of {item.name}"))
        for name in ("Second", "UVMap"):
            if name == "Second":
                b.data.uv_layers.new(name=name)
        mesh = self.run_boolean(a, b, "UNION").data
        self.assertEqual([uv_map.name for uv_map in mesh.uv_layers], ["UVMap", "Second"])
        at = coordinates(mesh)[versions.corner_vertices(mesh)]
        factor = np.repeat([(1.0, 10.0)[p.material_index] for p in mesh.polygons], np.diff(corners(mesh)[0]))
        np.testing.assert_allclose(
            corner_uvs(mesh), at[:, :2] * factor[:, None] + at[:, 2:], rtol=1e-5, atol=1e-5
        )

    def test_attributes_of_every_domain(self):
        a, b = ball("A"), ball("B", 1.0, (0.7, 0.2, 0.1))
        bpy.context.view_layer.update()
        for item in (a, b):
            mesh, at = item.data, world(item)
            made = mesh.attributes.new("height", "FLOAT", "POINT")
            made.data.foreach_set("value", at[:, 2].astype(np.float32))
            made = mesh.attributes.new("place", "FLOAT_VECTOR", "CORNER")
            made.data.foreach_set("vector", at[versions.corner_vertices(mesh)].astype(np.float32).ravel())
            made = mesh.attributes.new("tint", "BYTE_COLOR", "CORNER")
            made.data.foreach_set("color", np.tile((1.0, 0.0, float(item == b), 1.0), len(mesh.loops)))
        marked = a.data.attributes.new("number", "INT", "FACE")
        marked.data.foreach_set("value", np.arange(len(a.data.polygons), dtype=np.int32))
        flags = b.data.attributes.new("flag", "BOOLEAN", "POINT")
        flags.data.foreach_set("value", np.ones(len(b.data.vertices), bool))
        words = a.data.attributes.new("word", "STRING", "FACE")
        is_text = isinstance(words.data[7].value, str)  # by version it is one or the other
        words.data[7].value = "seven" if is_text else b"seven"
        centers = np.array([p.center for p in a.data.polygons])
        mesh = self.run_boolean(a, b, "UNION").data
        np.testing.assert_allclose(attribute(mesh, "height"), coordinates(mesh)[:, 2], atol=1e-6)
        at = coordinates(mesh)[versions.corner_vertices(mesh)]
        np.testing.assert_allclose(attribute(mesh, "place", "vector", 3), at, atol=1e-6)
        flag = attribute(mesh, "flag")
        tint = attribute(mesh, "tint", "color", 4)
        self.assertEqual({tuple(c) for c in np.rint(tint).tolist()}, {(1, 0, 0, 1), (1, 0, 1, 1)})
        starts, vertices = corners(mesh)
        number = attribute(mesh, "number").astype(int)
        for polygon, (first, last) in enumerate(pairwise(starts)):
            if tint[first, 2] > 0.5:
                self.assertTrue(flag[vertices[first:last]].all())
                self.assertEqual(number[polygon], 0)
            else:
                away = np.linalg.norm(centers - np.array(mesh.polygons[polygon].center), axis=1)
                self.assertLess(away[number[polygon]], 0.2)
        kept = {entry.value for entry in mesh.attributes["word"].data}
        self.assertEqual(len(kept), 2)

    def test_vertex_groups(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        a.vertex_groups.new(name="up").add([4, 5, 6, 7], 1.0, "REPLACE")
        b.vertex_groups.new(name="all").add(range(8), 0.25, "REPLACE")
        found = self.run_boolean(a, b, "UNION")
        self.assertEqual([group.name for group in found.vertex_groups], ["up", "all"])
        up, every = (found.vertex_groups[name].index for name in ("up", "all"))
        for vertex in found.data.vertices:
            weights = {entry.group: entry.weight for entry in vertex.groups}
            x, y, z = vertex.co
            if max(x, y, z) > 1.0 or min(x, y, z) >= 0.0:
                self.assertEqual(weights.get(every), 0.25, tuple(vertex.co))
            if max(x, y, z) <= 1.0 and min(x, y, z) < 0.0:
                self.assertAlmostEqual(weights.get(up, 0.0), (z + 1.0) / 2.0, places=5, msg=tuple(vertex.co))

    def test_shading_and_edges(self):
        a, b = ball("A"), cube("B", (0.0, 0.0, 1.01))
        for polygon in a.data.polygons:
            polygon.use_smooth = True
        edges = versions.edge_vertices(a.data)
        equator = [n for n, ends in enumerate(edges) if abs(coordinates(a.data)[ends, 2]).max() < 1e-6]
        upright = [n for n, ends in enumerate(edges) if abs(coordinates(a.data)[ends, 1]).max() < 1e-6]
        self.assertEqual((len(equator), len(upright)), (32, 32))
        for number in (*equator, *upright):
            a.data.edges[number].use_seam = True
        for number in upright:
            a.data.edges[number].use_edge_sharp = True
        mesh = self.run_boolean(a, b, "DIFFERENCE").data
        for polygon in mesh.polygons:
            flat = abs(polygon.normal.z) > 0.999 and abs(polygon.center.z - 0.01) < 1e-6
            self.assertEqual(polygon.use_smooth, not flat)
        at, lengths = coordinates(mesh), {"seam": 0.0, "sharp": 0.0}
        for edge in mesh.edges:
            ends = at[list(edge.vertices)]
            length = float(np.linalg.norm(ends[0] - ends[1]))
            lengths["seam"] += length * edge.use_seam
            lengths["sharp"] += length * edge.use_edge_sharp
            if edge.use_edge_sharp and abs(ends[:, 2] - 0.01).max() > 1e-6:
                self.assertLess(abs(ends[:, 1]).max(), 1e-6)
        # the lower half of a great circle, and the edge of the cut
        self.assertAlmostEqual(lengths["sharp"], math.pi + 2 * math.pi, delta=0.06)
        self.assertAlmostEqual(lengths["seam"], math.pi + 2 * math.pi, delta=0.06)

    def test_another_kind_of_the_same_name_is_told(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        made = a.data.attributes.new("x", "FLOAT", "POINT")
        made.data.foreach_set("value", np.ones(8, np.float32))
        b.data.attributes.new("x", "INT", "FACE")
        mesh = self.run_boolean(a, b, "UNION").data
        self.assertEqual((mesh.attributes["x"].domain, mesh.attributes["x"].data_type), ("POINT", "FLOAT"))
        self.assertEqual(attribute(mesh, "x").max(), 1.0)

    def test_a_mirrored_object_keeps_its_maps(self):
        a, b = cube("A"), cube("B", (1.0, 0.5, 0.25))
        a.scale = (-1.0, 1.0, 1.0)
        bpy.context.view_layer.update()
        uv_map = a.data.uv_layers.new(name="UVMap")
        at = coordinates(a.data)[versions.corner_vertices(a.data)]
        uv_map.data.foreach_set("uv", at[:, 1:].astype(np.float32).ravel())
        mesh = self.run_boolean(a, b, "DIFFERENCE").data
        at = coordinates(mesh)[versions.corner_vertices(mesh)]
        own = np.repeat([p.center.x * 1.0 <= 1.0 for p in mesh.polygons], np.diff(corners(mesh)[0]))
        uvs = corner_uvs(mesh)
        filled = own & (uvs != 0).any(axis=1)
        self.assertGreater(filled.sum(), 30)
        np.testing.assert_allclose(uvs[filled], at[filled, 1:], atol=1e-6)


class AsBlender(Case):
    """Blender's own modifier is the measure: the same volumes, and areas by material and by UV map."""

    def pair(self):
        a, b = ball("A"), cube("B", (0.4, 0.3, 0.2), 1.5)
        for item, index in ((a, 0), (b, 1)):
            for name in ("red", "blue"):
                item.data.materials.append(bpy.data.materials.get(name) or material(name))
            at = coordinates(item.data)[versions.corner_vertices(item.data)]
            item.data.uv_layers.new(name="UVMap").data.foreach_set("uv", at[:, :2].astype(np.float32).ravel())
            item.data.polygons.foreach_set(
                "material_index", np.full(len(item.data.polygons), index, np.int32)
            )
        return a, b

    def measures(self, mesh):
        """Volume, area of each material, and areas in the UV map."""
        areas, uv_areas = np.zeros(2), 0.0
        uvs = corner_uvs(mesh).astype(float)
        for polygon in mesh.polygons:
            areas[polygon.material_index] += polygon.area
            first, *others = (uvs[k] for k in polygon.loop_indices)
            turns = [
                (q - first)[0] * (r - first)[1] - (q - first)[1] * (r - first)[0] for q, r in pairwise(others)
            ]
            uv_areas += abs(sum(turns)) / 2
        return [volume(mesh), *areas.tolist(), uv_areas]

    def test_the_same(self):
        for operation in ("UNION", "INTERSECT", "DIFFERENCE"):
            a, b = self.pair()
            modifier = a.modifiers.new("Boolean", "BOOLEAN")
            modifier.operation, modifier.object, modifier.solver = operation, b, "EXACT"
            bpy.context.view_layer.update()
            theirs = bpy.data.meshes.new_from_object(a.evaluated_get(bpy.context.evaluated_depsgraph_get()))
            a.modifiers.clear()
            ours = self.run_boolean(a, b, operation).data
            self.assertEqual([m.name for m in ours.materials], [m.name for m in theirs.materials])
            np.testing.assert_allclose(self.measures(ours), self.measures(theirs), rtol=1e-5)
            for item in (a, b):
                bpy.data.objects.remove(item)


class Divide(Case):
    def test_a_sheet_and_a_ball(self):
        plane, globe = sheet("Sheet", 0.25, 1, 4.0, (-2.0, -2.0)), ball("Ball")
        red = material("red")
        globe.data.materials.append(red)
        made = self.division(plane, globe)
        names = sorted(item.name for item in made["sub_surface"])
        self.assertEqual(
            names, ["Part of Ball", "Part of Ball.001", "Sheet inside Ball", "Sheet outside Ball"]
        )
        blocks = made["sub_block"]
        self.assertEqual([item.name.split(".")[0] for item in blocks], ["Part of Ball"] * 2)
        total = volume(globe.data)
        self.assertAlmostEqual(sum(item["realmodel_volume"] for item in blocks), total, places=5)
        for item in blocks:
            self.assertEqual(open_edges(item.data), 0)
            self.assertAlmostEqual(item["realmodel_volume"], volume(item.data), places=5)
            self.assertIn(red, list(item.data.materials))
        self.assertEqual([item.name for item in made["loop"]], ["Loop, Hard Closed"])
        loop = made["loop"][0].data
        self.assertEqual(len(loop.edges), len(loop.vertices))
        np.testing.assert_allclose(coordinates(loop)[:, 2], 0.25, atol=1e-6)
        for item in (plane, globe):
            self.assertTrue(item.hide_get() and item.hide_render)
        collection = bpy.data.collections["Sheet divided by Ball"]
        self.assertEqual([c.name for c in collection.children], ["Sub-Surfaces", "Sub-Blocks", "Loops"])
        self.assertEqual(set(collection.all_objects), {i for items in made.values() for i in items})

    def test_two_solids(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        made = self.division(a, b, keep_operands=True)
        volumes = {item.name: item["realmodel_volume"] for item in made["sub_block"]}
        self.assertEqual(volumes, {"A without B": 7.0, "A and B": 1.0, "B without A": 7.0})
        self.assertEqual(
            sorted(item.name for item in made["sub_surface"]),
            ["A inside B", "A outside B", "B inside A", "B outside A"],
        )
        self.assertFalse(a.hide_get() or b.hide_get())

    def test_volumes_are_those_of_the_world(self):
        a, b = cube("A"), cube("B", (3.0, 1.0, 1.0))
        a.scale = (-3.0, 1.0, 2.0)
        made = self.division(a, b)
        volumes = {item.name: item["realmodel_volume"] for item in made["sub_block"]}
        self.assertAlmostEqual(volumes["A and B"], 1.0 * 1.0 * 2.0, places=6)
        for item in made["sub_block"]:
            self.assertGreater(volume(item.data), 0.0)
            shown = volume(item.data) * abs(item.matrix_world.determinant())
            self.assertAlmostEqual(shown, volumes[item.name], places=5)

    def test_open_sheets(self):
        a, b = sheet("A", 0.0, 2, 4.0, (-2.0, -2.0)), sheet("B", 0.0, 2, 2.0, (-1.0, -1.0))
        b.matrix_world = (
            Matrix.Translation((0.0, 0.0, 0.5)) @ Euler((math.pi / 2, 0.0, 0.0)).to_matrix().to_4x4()
        )
        made = self.division(a, b)
        self.assertEqual([item.name for item in made["loop"]], ["Loop, Open"])
        self.assertFalse(made["sub_block"])
        self.assertEqual(
            {item.name.split(".")[0] for item in made["sub_surface"]}, {"Part of A", "Part of B"}
        )
        areas = sum(sum(p.area for p in item.data.polygons) for item in made["sub_surface"])
        self.assertAlmostEqual(areas, 20.0, places=4)


class Sample(Case):
    def test_it_is_made(self):
        made = runpy.run_path(str(SAMPLES / "booleans" / "scene.py"))["make"]()
        names = [parts.name for parts in made]
        self.assertEqual(
            names,
            ["Sheet divided by Sculpture", "Cylinder 1 divided by Cylinder 2", "Torus 1 divided by Torus 2"],
        )
        counts = []
        for parts in made:
            kinds = [item["realmodel"] for item in parts.all_objects if item.type == "MESH"]
            counts.append([kinds.count(kind) for kind in ("sub_surface", "sub_block", "loop")])
        self.assertEqual(counts, [[4, 2, 1], [6, 4, 2], [6, 4, 2]])
        volumes = {i.name: i["realmodel_volume"] for i in made[1].all_objects if "realmodel_volume" in i}
        whole = volumes["Cylinder 1 without Cylinder 2"] + volumes["Cylinder 1 and Cylinder 2"]
        exact = 96 / 2 * math.sin(2 * math.pi / 96) * 0.6**2 * 2.8
        self.assertAlmostEqual(whole, exact, places=5)


class Refused(Case):
    def refuse(self, first, second, expected, operation="UNION"):
        select(second, first)
        before = inventory()
        self.refused(ops.boolean, expected, operation=operation)
        self.assertEqual(inventory(), before)

    def test_an_open_surface(self):
        a, plane = cube("A"), sheet("Plane", 0.0, 1, 4.0, (-2.0, -2.0))
        for operation in ("UNION", "INTERSECT", "DIFFERENCE"):
            expected = r"Plane: it is open, for example near \(.*2.*\); close it"
            self.refuse(a, plane, expected, operation)
            self.refuse(plane, a, expected, operation)

    def test_normals_that_face_both_ways(self):
        a, b = cube("A"), cube("B", (1.0, 1.0, 1.0))
        b.data.polygons[2].flip()
        self.refuse(a, b, "B: its triangles face both ways, for example near")

    def test_nothing_in_common(self):
        self.refuse(cube("A"), cube("B", (5.0, 0.0, 0.0)), "no volume in common", "INTERSECT")
        self.refuse(cube("C", size=1.0), cube("D"), "C lies inside of D", "DIFFERENCE")

    def test_no_faces(self):
        empty = solid("Empty", [(0, 0, 0), (1, 0, 0)], [])
        self.refuse(cube("A"), empty, "Empty: it has no faces")

    def test_scale_of_zero(self):
        a, b = cube("A"), cube("B")
        b.scale.x = 0.0
        self.refuse(a, b, "B: its scale is zero")

    def test_not_finite(self):
        a, b = cube("A"), cube("B")
        b.data.vertices[3].co.x = math.nan
        select(b, a)
        self.refused(ops.boolean, "B: vertex 3 is .*not finite", operation="UNION")

    def test_polls(self):
        a, b = cube("A"), cube("B")
        select(a)
        self.refused(ops.boolean, "select one other mesh object")
        select(b, cube("C"), a)
        self.refused(ops.boolean, "select one other mesh object")
        select(b)
        bpy.context.view_layer.objects.active = None
        self.refused(ops.boolean, "active object is no mesh")
        select(b, a)
        bpy.ops.object.mode_set(mode="EDIT")
        self.refused(ops.boolean, "Object Mode")
        bpy.ops.object.mode_set(mode="OBJECT")

    def test_an_object_of_the_model(self):
        stack(0.0, 10.0)
        ops.build()
        block = next(row.object for row in self.model.results if row.object is not None)
        other = ball("Ball", 20.0, (50.0, 50.0, 5.0))
        self.refuse(block, other, "an object of the model.*Keep Operands", "DIFFERENCE")
        found = self.run_boolean(block, other, "DIFFERENCE", keep_operands=True)
        self.assertLess(volume(found.data), volume(block.data))


class InBetween(Case):
    """The work goes on in a thread, and the user meanwhile does what he likes."""

    def job(self, operation="UNION", n=16):
        self.a, self.b = ball("A", n=n), ball("B", 1.0, (0.5, 0.0, 0.0), n)
        select(self.b, self.a)
        self.before = inventory()
        return BooleanJob(self.scene, self.a, self.b, operation, bpy.context.evaluated_depsgraph_get())

    def test_done(self):
        job = self.job()
        job.start()
        job.wait()
        self.assertEqual(inventory(), self.before)
        self.assertTrue(job.hand_over(0.0))
        job.finish()
        self.assertGreater(volume(self.a.data), 4.5)

    def test_cancelled(self):
        job = self.job(n=300)
        job.start()
        job.cancel()
        job.wait()
        with self.assertRaises(Cancelled):
            job.finish()
        self.assertEqual(inventory(), self.before)

    def test_an_object_is_gone(self):
        job = self.job()
        job.start()
        bpy.data.objects.remove(self.b)
        with self.assertRaisesRegex(Exception, "object 'B' is gone"):
            job.finish()

    def test_an_object_is_edited(self):
        job = self.job()
        job.start()
        bpy.ops.object.mode_set(mode="EDIT")
        with self.assertRaisesRegex(Exception, "'A' is being edited"):
            job.finish()
        bpy.ops.object.mode_set(mode="OBJECT")

    def objects(self):
        """All but the scene, whose settings are other ones for Python after undo."""
        return {key: value for key, value in inventory().items() if key[0] != "scenes"}

    def test_undo_is_one_step(self):
        if not bpy.ops.ed.undo_push.poll():
            self.skipTest("this Blender has no undo in background")
        cube("A"), cube("B", (1.0, 1.0, 1.0))
        select(bpy.data.objects["B"], bpy.data.objects["A"])
        for operation in ("UNION", "DIVIDE"):
            bpy.ops.ed.undo_push(message="before")
            before = self.objects()
            ops.boolean(operation=operation)
            bpy.ops.ed.undo_push(message="boolean")
            self.assertNotEqual(self.objects(), before)
            bpy.ops.ed.undo()
            self.assertEqual(self.objects(), before)
            self.assertFalse(bpy.data.objects["B"].hide_get())
            bpy.context.view_layer.objects.active = bpy.data.objects["A"]


if __name__ == "__main__":
    unittest.main()
