# SPDX-License-Identifier: GPL-3.0-or-later
"""What Booleans of two mesh objects keep: materials, attributes, UV maps, edges and faces."""

import math
import unittest
from itertools import pairwise

import bpy
import numpy as np
from blender_state import coordinates, corners, volume
from boolean_case import BooleanCase, attribute, ball, corner_uvs, cube, material, world
from realmodel.bl.host import versions


class Layers(BooleanCase):
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

    def test_the_first_of_two_kinds_with_one_name_is_kept(self):
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


class AsBlender(BooleanCase):
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


if __name__ == "__main__":
    unittest.main()
