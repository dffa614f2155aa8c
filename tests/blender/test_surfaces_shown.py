# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces as they survive, and editing them from the view."""

import bpy
import numpy as np
import realmodel
from blender_state import coordinates
from panel_case import ops
from realmodel.bl.project import surface_statistics
from realmodel.core.display import polygon_mesh
from view_case import Case


def setUpModule():
    realmodel.register()


def tearDownModule():
    realmodel.unregister()


def area_in_plan(mesh):
    return sum(polygon.area * abs(polygon.normal.z) for polygon in mesh.polygons)


class Surviving(Case):
    def bodies(self):
        found = [o for o in self.scene.objects if o.get("realmodel_view") == "surviving"]
        return {item.parent.name: item for item in found}

    def test_what_erosion_has_left(self):
        before = self.contents()
        self.settings.display, self.settings.view.surfaces = "SURFACES", "SURVIVING"
        found = self.bodies()
        # S2 is eroded everywhere, S3 lies under the cap; S1 is left where S3 is higher, which is nowhere
        whole = 100.0 * 80.0
        self.assertNotIn("S2", found)
        self.assertAlmostEqual(area_in_plan(found["S4"].data), whole, delta=0.1)
        self.assertAlmostEqual(area_in_plan(found["S0"].data), whole, delta=0.1)
        heights = coordinates(found["S4"].data)
        np.testing.assert_allclose(heights[:, 2], 24.0 + 0.01 * heights[:, 1], atol=1e-4)
        self.assertTrue(all(polygon.normal.z > 0 for polygon in found["S4"].data.polygons))
        self.assertEqual(self.in_sight("interface"), set())
        self.assertEqual(len(self.in_sight("view")), len(found))
        self.settings.display = "BLOCKS"
        self.assertEqual(self.bodies(), {})
        self.assertEqual(self.contents(), before)

    def test_areas_are_those_of_the_results(self):
        self.settings.display, self.settings.view.surfaces = "SURFACES", "SURVIVING"
        for name, item in self.bodies().items():
            row = next(row for row in self.settings.rocks[0].surfaces if row.interface.name == name)
            expected = surface_statistics.read(row)["area"]
            self.assertAlmostEqual(area_in_plan(item.data), expected, delta=1e-3 * expected, msg=name)

    def test_at_a_stage_of_the_cut_and_after_a_build(self):
        self.settings.display, self.settings.view.surfaces = "SURFACES", "SURVIVING"
        self.settings.stage = 2
        self.assertIn("S2", self.bodies())
        self.assertNotIn("S3", self.bodies())
        self.settings.stage = 4
        self.assertNotIn("S2", self.bodies())
        ops.section_plane(axis="X")
        self.settings.view.plane.location.x = 30.0
        ops.section_update()
        self.assertLess(coordinates(self.bodies()["S4"].data)[:, 0].max(), 30.001)
        ops.section_remove()
        interface = self.settings.rocks[0].surfaces[4].interface
        interface.location.z = 2.0
        bpy.context.view_layer.update()
        ops.build()
        heights = coordinates(self.bodies()["S4"].data)
        np.testing.assert_allclose(heights[:, 2], 26.0 + 0.01 * heights[:, 1], atol=1e-4)
        bpy.context.view_layer.update()
        at = np.array(self.bodies()["S4"].matrix_world)
        np.testing.assert_allclose(at, np.eye(4), atol=1e-5)

    def test_edit_and_done(self):
        self.settings.display = "SURFACES"
        self.settings.rocks[0].active_surface = 4
        ops.edit_surface()
        item = self.settings.rocks[0].surfaces[4].interface
        self.assertEqual((bpy.context.mode, bpy.context.object), ("EDIT_MESH", item))
        self.assertLessEqual({o.name for o in self.blocks().values()}, self.in_sight())
        ops.edit_done()
        self.assertEqual((bpy.context.mode, self.settings.display), ("OBJECT", "SURFACES"))
        with self.assertRaisesRegex(RuntimeError, "nothing is being edited"):
            ops.edit_done()

    def test_the_core_leaves_nothing_out(self):
        shapes = polygon_mesh.of_surfaces(self.model, np.zeros(3))
        count = sum(shape.polygons for shape in shapes if shape is not None)
        self.assertEqual(count, int((self.model.face_surface >= 0).sum()))
