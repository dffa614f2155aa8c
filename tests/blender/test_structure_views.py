# SPDX-License-Identifier: GPL-3.0-or-later
"""The ways to look at a model with faults and bodies."""

import math

import blender_state
import bpy
from panel_case import ops, select
from realmodel.bl.display import bodies, colors, coordinates, modes, sections, viewpoints
from realmodel.bl.project import compartments
from structure_case import StructureCase, box


class Views(StructureCase):
    def setUp(self):
        super().setUp()
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)), box("tunnel", (20, -10, 2), (30, 110, 6)))
        next(body for body in self.model.bodies if body.name == "tunnel").void = True
        ops.build()

    def test_display_modes(self):
        for mode in ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS"):
            for subject in ("BLOCKS", "INTERFACES", "BOTH"):
                self.model.view.subject = subject
                self.model.display = mode
                self.assertEqual(self.model.view.message, "", mode)
        self.model.display = "SURFACES"
        fault = bpy.data.objects["F1"]
        self.assertFalse(fault.hide_get())
        self.assertFalse(self.model.structures.hide_render)
        self.model.faults[0].hide = True
        self.assertTrue(fault.hide_get())
        self.model.faults[0].hide = False
        self.model.view.surfaces = "SURVIVING"
        self.assertEqual(self.model.view.message, "")
        left = bodies.of_kind(self.scene, bodies.SURVIVING)
        self.assertIn(fault, left)
        self.assertEqual({round(v.co.x, 4) for v in left[fault].data.vertices}, {50.0})
        self.model.display = "BLOCKS"
        self.assertTrue(fault.hide_get())

    def test_colors_by_compartment(self):
        for by in ("PROPERTY", "BLOCK", "ROCK", "AGE", "ELEVATION", "THICKNESS", "UNCERTAINTY"):
            self.model.color_by = by
            self.assertEqual(self.model.view.message, "", by)
        self.model.color_by = "COMPARTMENT"
        key = colors.key(self.scene)
        self.assertEqual([name for name, _ in key.entries], compartments.names(self.scene))
        item = next(row.object for row in self.model.results if row.name == "S2 block")
        attribute = item.data.color_attributes["realmodel_shade"]
        self.assertEqual(attribute.domain, "CORNER")
        found = {
            tuple(round(255 * c) for c in attribute.data[i].color_srgb[:3])
            for polygon in item.data.polygons
            for i in polygon.loop_indices
        }
        self.assertEqual(found, {tuple(round(255 * c) for c in color) for _, color in key.entries})
        self.model.stage = 1
        self.model.stage = 2
        self.model.color_by = "PROPERTY"
        self.assertNotIn("realmodel_shade", item.data.color_attributes)

    def test_exploded_by_compartment(self):
        self.model.explode_direction = "COMPARTMENT"
        self.model.explode = 1.0
        parts = bodies.of_kind(self.scene, bodies.CELLS)
        rows = {row.name: row for row in self.model.results}
        item = rows["S1 block"].object
        self.assertTrue(item.hide_get())
        part = parts[item]
        self.assertFalse(part.hide_get())
        self.assertEqual(blender_state.open_edges(part.data), 0)
        self.assertAlmostEqual(blender_state.volume(part.data), self.volumes()["S1 block"], delta=1.0)
        x = blender_state.coordinates(part.data)[:, 0]
        self.assertAlmostEqual(x.min(), -25.0, places=3)
        self.assertAlmostEqual(x.max(), 125.0, places=3)
        self.assertFalse(((x > 26.0) & (x < 74.0)).any())
        self.assertEqual(tuple(item.delta_location), (0.0, 0.0, 0.0))
        points = viewpoints.model_points(self.scene)
        self.assertLess(points[:, 0].min(), -24.0)  # the frame has room for them
        self.assertLess(points[:, 1].max(), 101.0)  # and none for what reaches beyond the rock
        place = coordinates.under_ray(self.scene, (-15.0, 50.0, 100.0), (0.0, 0.0, -1.0))
        self.assertAlmostEqual(place.x, 10.0, places=3)
        self.assertEqual(place.block, "S2 block")
        for mode in ("AREAS", "LINES", "POINTS", "POLYHEDRA", "SURFACES", "BLOCKS"):
            self.model.display = mode
            self.assertEqual(self.model.view.message, "", mode)
        self.model.color_by = "COMPARTMENT"
        self.assertIn("realmodel_shade", bodies.of_kind(self.scene, bodies.CELLS)[item].data.color_attributes)
        self.model.stage = 1
        self.assertEqual(modes.apart_shown(self.scene), 1.0)
        ops.build()
        self.assertTrue(bodies.of_kind(self.scene, bodies.CELLS))
        self.model.explode = 0.0
        self.assertFalse(bodies.of_kind(self.scene, bodies.CELLS))
        self.assertFalse(item.hide_get())

    def test_sections_and_cuts(self):
        found = sections.by_plane(self.scene, (0.0, 50.0, 0.0), (0.0, 1.0, 0.0))
        self.assertGreater(len(found), 0)
        ops.section(location=(0.0, 50.0, 0.0), normal=(0.0, 1.0, 0.0))
        ops.section_plane(axis="Y")
        self.model.view.use_section = True
        self.assertEqual(self.model.view.message, "")
        halves = bodies.of_kind(self.scene, bodies.CUT)
        item = next(row.object for row in self.model.results if row.name == "S1 block")
        self.assertEqual(blender_state.open_edges(halves[item].data), 0)
        self.assertIn("realmodel_compartment", halves[item].data.attributes)
        self.model.explode_direction = "COMPARTMENT"
        self.model.explode = 1.0
        self.assertEqual(self.model.view.message, "")
        part = bodies.of_kind(self.scene, bodies.CELLS)[item]
        self.assertLess(abs(blender_state.volume(part.data)), self.volumes()["S1 block"] * 0.6)
        line = bpy.data.curves.new("line", "CURVE")
        line.dimensions = "3D"
        spline = line.splines.new("POLY")
        spline.points.add(1)
        for point, at in zip(spline.points, ((10, 50), (90, 60)), strict=True):
            point.co = (*at, 0.0, 1.0)
        curve = bpy.data.objects.new("line", line)
        self.scene.collection.objects.link(curve)
        select(curve)
        ops.fence()

    def test_coordinates_in_and_over_a_tunnel(self):
        self.assertEqual(coordinates.at_point(self.scene, (25.0, 50.0, 8.0)).block, "S1 block")
        self.assertIsNone(coordinates.at_point(self.scene, (25.0, 50.0, 4.0)))
        over = coordinates.at_point(self.scene, (25.0, 50.0, 9.0))
        self.assertTrue(math.isclose(over.thickness, 4.0, rel_tol=1e-5), over.thickness)
