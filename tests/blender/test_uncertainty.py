# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the heights of interpolated interfaces, as attributes of their meshes."""

import bpy
import numpy as np
from made_projects import interpolated, two_rocks
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl import batch, scene, surface_figures, uncertainty
from realmodel.core import build


def values(mesh, name):
    read = np.empty(len(mesh.vertices), np.float32)
    mesh.attributes[name].data.foreach_get("value", read)
    return read


class Uncertainty(PanelCase):
    def test_interpolated_interfaces_have_variance_distance_and_colour(self):
        model = build(interpolated())
        batch.write_scene(model)
        interfaces = scene.model_objects(bpy.context.scene, "interface")
        self.assertEqual(len(interfaces), 3)
        for number, item in enumerate(interfaces):
            told = model.surface_attributes(number)
            distance = values(item.data, "distance")
            np.testing.assert_allclose(distance, told["distance"], rtol=1e-6)
            self.assertGreater(distance.max(), 1.0)
            if number == 2:  # inverse distance tells no variance
                self.assertNotIn("variance", item.data.attributes)
                self.assertNotIn("uncertainty", item.data.color_attributes)
                continue
            variance = values(item.data, "variance")
            np.testing.assert_allclose(variance, told["variance"], rtol=1e-6)
            layer = item.data.color_attributes["uncertainty"]
            colours = np.empty(4 * len(variance), np.float32)
            layer.data.foreach_get("color_srgb", colours)
            colours = colours.reshape(-1, 4)
            surest, least_sure = colours[variance.argmin()], colours[variance.argmax()]
            self.assertGreater(least_sure[:3].sum(), surest[:3].sum() + 0.5)
            np.testing.assert_allclose(least_sure, (0.995, 0.910, 0.215, 1.0), atol=0.01)

    def test_ready_meshes_have_none(self):
        batch.write_scene(build(two_rocks()))
        for item in scene.model_objects(bpy.context.scene, "interface"):
            self.assertFalse({"variance", "distance", "uncertainty"} & set(item.data.attributes.keys()))

    def test_colours_of_what_is_not_known(self):
        found = uncertainty.colours(np.array([0.0, np.nan, 4.0]))
        self.assertEqual(found.shape, (3, 4))
        np.testing.assert_allclose(found[1], (0.35, 0.35, 0.35, 1.0), atol=1e-6)
        sure = uncertainty.colours(np.zeros(2))
        np.testing.assert_allclose(sure, [(0.0, 0.135, 0.305, 1.0)] * 2, atol=1e-6)


class UncertaintyInThePanel(PanelCase):
    def test_what_is_built_from_the_panel_has_the_attributes(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        for _ in range(2):  # an interface that stays the same keeps them
            ops.build()
            found = [o for o in self.scene.objects if o.get("realmodel") == "interface"]
            self.assertTrue(found)
            for item in found:
                names = set(item.data.attributes.keys())
                self.assertLessEqual({"variance", "distance", "uncertainty"}, names)
                self.assertEqual(len(item.data.attributes["variance"].data), len(item.data.vertices))

    def test_it_can_be_seen(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        ops.build()
        item = self.model.rocks[0].surfaces[1].interface
        own = item.material_slots[0].material
        self.model.display, self.model.color_by = "SURFACES", "UNCERTAINTY"
        material = item.material_slots[0].material
        self.assertEqual(material.name, "Uncertainty")
        given = next(node for node in material.node_tree.nodes if node.type == "ATTRIBUTE")
        self.assertEqual(given.attribute_name, "uncertainty")
        self.assertEqual(item.data.color_attributes.active_color_index, 0)
        self.assertEqual(self.model.results[0].object.material_slots[0].material.name, "Clay")
        self.assertGreater(surface_figures.read(self.model.rocks[0].surfaces[1])["deviation"], 0.0)
        path = self.folder / "uncertain.png"
        ops.view(direction="TOP")
        ops.capture(filepath=str(path), width=64, height=64)
        self.model.color_by = "PROPERTY"
        self.assertEqual(item.material_slots[0].material, own)
        self.assertNotIn("Uncertainty", bpy.data.materials)
