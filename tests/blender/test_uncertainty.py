# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the heights of interpolated interfaces, as attributes of their meshes."""

import bpy
import numpy as np
from made_projects import interpolated, two_rocks
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.objects import model_tree
from realmodel.bl.pictures import batch
from realmodel.bl.project import surface_statistics
from realmodel.core import build
from realmodel.core.drawing import color_scale


def values(mesh, name):
    read = np.empty(len(mesh.vertices), np.float32)
    mesh.attributes[name].data.foreach_get("value", read)
    return read


class Uncertainty(PanelCase):
    def test_interpolated_interfaces_have_variance_and_distance(self):
        model = build(interpolated())
        batch.write_scene(model)
        interfaces = model_tree.model_objects(bpy.context.scene, "interface")
        self.assertEqual(len(interfaces), 3)
        for number, item in enumerate(interfaces):
            attributes = model.surface_attributes(number)
            distance = values(item.data, "distance")
            np.testing.assert_allclose(distance, attributes["distance"], rtol=1e-6)
            self.assertGreater(distance.max(), 1.0)
            if number == 2:  # inverse distance gives no variance
                self.assertNotIn("variance", item.data.attributes)
                continue
            variance = values(item.data, "variance")
            np.testing.assert_allclose(variance, attributes["variance"], rtol=1e-6)

    def test_ready_meshes_have_none(self):
        batch.write_scene(build(two_rocks()))
        for item in model_tree.model_objects(bpy.context.scene, "interface"):
            self.assertFalse({"variance", "distance"} & set(item.data.attributes.keys()))


class UncertaintyInThePanel(PanelCase):
    def test_what_is_built_from_the_panel_has_the_attributes(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        for _ in range(2):  # an interface that stays the same keeps them
            ops.build()
            found = [o for o in self.scene.objects if o.get("realmodel") == "interface"]
            self.assertTrue(found)
            for item in found:
                names = set(item.data.attributes.keys())
                self.assertLessEqual({"variance", "distance"}, names)
                self.assertEqual(len(item.data.attributes["variance"].data), len(item.data.vertices))

    def colors(self, item):
        found = np.empty(4 * len(item.data.vertices), np.float32)
        item.data.color_attributes["realmodel_shade"].data.foreach_get("color_srgb", found)
        return found.reshape(-1, 4)[:, :3]

    def test_all_surfaces_have_one_scale(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        ops.build()
        item = self.model.rocks[0].surfaces[1].interface
        own = item.material_slots[0].material
        self.model.display, self.model.color_by = "SURFACES", "UNCERTAINTY"
        interfaces = [surface.interface for surface in self.model.rocks[0].surfaces]
        deviations = [np.sqrt(values(each.data, "variance")) for each in interfaces]
        most = max(each.max() for each in deviations)
        self.assertAlmostEqual(self.model.view.shade_limits[1], most, places=5)
        self.assertEqual(self.model.view.shade_limits[0], 0.0)
        for each, deviation in zip(interfaces, deviations, strict=True):
            expected = color_scale.colors(deviation, (0.0, most))[:, :3]
            np.testing.assert_allclose(self.colors(each), expected, atol=0.01)
        self.assertEqual(item.material_slots[0].material.name, "Color Scale")
        self.assertEqual(item.data.color_attributes.active_color.name, "realmodel_shade")
        self.assertEqual(self.model.results[1].object.material_slots[0].material.name, "Color Scale")
        self.assertGreater(surface_statistics.read(self.model.rocks[0].surfaces[1])["deviation"], 0.0)
        self.model.color_by = "PROPERTY"
        self.assertEqual(item.material_slots[0].material, own)
        self.assertNotIn("Color Scale", bpy.data.materials)
        self.assertNotIn("realmodel_shade", item.data.attributes)

    def test_elevation_and_thickness(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        ops.build()
        self.model.color_by = "ELEVATION"
        block = self.model.results[1].object
        heights = np.array([v.co.z for v in block.data.vertices])
        low, high = self.model.view.shade_limits
        self.assertAlmostEqual(
            high, max(max(v.co.z for v in o.data.vertices) for o in self.shown()), places=4
        )
        np.testing.assert_allclose(
            self.colors(block), color_scale.colors(heights, (low, high))[:, :3], atol=0.01
        )
        self.model.color_by = "THICKNESS"
        thickest = self.model.view.shade_limits[1]
        self.assertGreater(thickest, 0.0)
        self.assertLess(thickest, high - low)
        before = self.colors(block)
        ops.build()
        np.testing.assert_array_equal(self.colors(block), before)
        ops.section_plane(axis="Y")
        half = next(o for o in self.scene.objects if o.get("realmodel_view") == "cut")
        self.assertEqual(len(self.colors(half)), len(half.data.vertices))

    def shown(self):
        rows = [row.object for row in self.model.results]
        return rows + [surface.interface for surface in self.model.rocks[0].surfaces]
