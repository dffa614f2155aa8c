# SPDX-License-Identifier: GPL-3.0-or-later
"""The model origin, and colors of the library as Blender wants them."""

import unittest

import bpy
import numpy as np
from blender_state import empty_file
from mathutils import Color
from realmodel.bl.objects import materials, origin


class Origin(unittest.TestCase):
    def test_models_near_zero_keep_their_coordinates(self):
        box = np.array([[0.0, 0.0, 400.0], [500.0, 300.0, 480.0]])
        np.testing.assert_array_equal(origin.choose_origin(box), 0.0)

    def test_utm_keeps_a_millimeter_over_ten_kilometers(self):
        shake = np.random.default_rng(1)
        low = np.array([377400.0, 5397900.0, -300.0])
        points = low + shake.random((20000, 3)) * (10000.0, 10000.0, 1500.0)
        chosen = origin.choose_origin(points)
        away = np.abs(origin.offsets_from(chosen, points).astype(np.float64) + chosen - points)
        self.assertLess(away.max(), 1e-3)

    def test_a_high_place_is_moved_as_well(self):
        box = np.array([[0.0, 0.0, 1e6], [2.0, 2.0, 1e6 + 1e-3]])
        self.assertEqual(origin.choose_origin(box).tolist(), [0.0, 0.0, 1e6])

    def test_east_and_north_move_together(self):
        box = np.array([[270000.0, 3912000.0, -2900.0], [331000.0, 3965000.0, 150.0]])
        self.assertEqual(origin.choose_origin(box).tolist(), [300000.0, 3940000.0, 0.0])

    def test_points_without_extent(self):
        self.assertEqual(origin.choose_origin(np.zeros((0, 3))).tolist(), [0.0, 0.0, 0.0])
        self.assertEqual(origin.choose_origin(np.array([[5.0, 5.0, 5.0]])).tolist(), [0.0, 0.0, 0.0])


class LibraryColors(unittest.TestCase):
    def test_blender_shows_the_color_that_was_given(self):
        for value in range(256):
            linear = materials.linear_color(f"#{value:02x}{255 - value:02x}40")
            shown = [round(255.0 * c) for c in Color(linear).from_scene_linear_to_srgb()]
            self.assertEqual(shown, [value, 255 - value, 64])

    def test_the_viewport_color_is_linear(self):
        kind = bpy.types.Material.bl_rna.properties["diffuse_color"].subtype
        self.assertEqual(kind, "COLOR", "COLOR_GAMMA would want sRGB values")

    def test_without_a_library(self):
        self.assertEqual(materials.name_and_color(None, 0), ("no property", materials.NEUTRAL_GRAY))
        self.assertEqual(materials.name_and_color(None, 7)[0], "property 7")

    def test_a_texture_stays_linked_and_exporters_find_the_color(self):
        empty_file()
        material = materials.new_material("rock", 3, "#808080")
        principled = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        noise = material.node_tree.nodes.new("ShaderNodeTexNoise")
        material.node_tree.links.new(noise.outputs[0], principled.inputs["Base Color"])
        materials.set_color(material, "#ff0000")
        self.assertEqual(principled.inputs["Base Color"].links[0].from_node, noise)
        self.assertEqual(tuple(principled.inputs["Base Color"].default_value), (1.0, 0.0, 0.0, 1.0))
        self.assertEqual(tuple(material.diffuse_color), (1.0, 0.0, 0.0, 1.0))
