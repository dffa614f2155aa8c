# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh object divided along another one: sub-surfaces, sub-blocks and loops."""

import math
import runpy
import unittest

import bpy
import numpy as np
from blender_state import coordinates, open_edges, volume
from boolean_case import BooleanCase, ball, cube, material
from mathutils import Euler, Matrix
from panel_case import SAMPLES, sheet


class Divide(BooleanCase):
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
        self.assertTrue(all(edge.is_loose for edge in loop.edges), "others are not drawn")
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


class Sample(BooleanCase):
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


if __name__ == "__main__":
    unittest.main()
