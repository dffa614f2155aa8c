# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of two mesh objects: volumes, transforms, what is refused, and progress."""

import math
import unittest

import bpy
import numpy as np
from blender_state import coordinates, corners, inventory, volume
from boolean_case import BooleanCase, ball, cube, solid, world
from panel_case import ops, select, sheet, stack
from realmodel.bl.objects.boolean_job import BooleanJob
from realmodel.core import Cancelled


class Solids(BooleanCase):
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


class Refused(BooleanCase):
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


class InBetween(BooleanCase):
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
