# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned holes in the panel: tubes, tables, and what an ensemble says."""

import csv

import numpy as np
from blender_state import coordinates
from panel_case import SAMPLES, PanelCase, ops, raise_by, select, sheet, stack
from realmodel.bl.objects import built_models
from realmodel.bl.scene import planned_holes


class PlannedHoles(PanelCase):
    def tubes(self):
        return [item for item in self.scene.objects if item.get("realmodel_view") == "planned"]

    def a_model(self):
        self.items = stack(0.0, 20.0, 35.0)
        ops.build()
        ops.planned_hole_add()
        return self.model.planned_holes[0]

    def test_a_hole_through_level_layers(self):
        row = self.a_model()
        hole = planned_holes.kept(row)
        self.assertEqual([hole.block_names[each.block] for each in hole.intervals], ["S2 block", "S1 block"])
        self.assertEqual([(each.begin, each.end) for each in hole.intervals], [(0, 15), (15, 35)])
        self.assertEqual((row.east, row.north, row.height), ("50.000", "50.000", "35.000"))
        (item,) = self.tubes()
        self.assertTrue(item.show_in_front, "within the blocks nobody would see it")
        found = coordinates(item.data)
        self.assertAlmostEqual(found[:, 2].max(), 35, places=4)
        self.assertAlmostEqual(found[:, 2].min(), 35 - 1.1 * 35, places=4)
        used = {p.material_index for p in item.data.polygons}
        self.assertEqual(used, {0, 1, 2}, "the axis and two blocks")
        materials = {m.name for r in self.model.results for m in r.object.data.materials}
        self.assertTrue({m.name for m in item.data.materials[1:]} <= materials)

    def test_it_begins_in_the_middle_or_where_the_cursor_was_put(self):
        select(sheet("low", 0.0, at=(-10.0, -10.0)), sheet("high", 20.0, at=(-10.0, -10.0)))
        ops.from_selected()
        ops.build()
        for cursor, wanted in (((0, 0, 0), ("40.000", "40.000")), ((1, 2, 0), ("1.000", "2.000"))):
            self.scene.cursor.location = cursor
            ops.planned_hole_add()
            row = self.model.planned_holes[self.model.active_planned_hole]
            self.assertEqual((row.east, row.north), wanted)

    def test_it_follows_its_settings(self):
        row = self.a_model()
        row.east, row.height = "10", "45"
        row.azimuth, row.dip, row.length = 90.0, 30.0, 60.0
        hole = planned_holes.kept(row)
        self.assertTrue(np.allclose([(e.begin, e.end) for e in hole.intervals], [(20, 50), (50, 60)]))
        self.assertTrue(np.allclose(hole.rows()[0]["vertical_from"], 10))
        (item,) = self.tubes()
        self.assertAlmostEqual(coordinates(item.data)[:, 0].max(), 10 + 60 * np.cos(np.radians(30)), delta=1)
        row.east = "no number"
        self.assertEqual(row.east, "10.000")
        self.scene.cursor.location = (20.0, 30.0, 35.0)
        ops.planned_hole_collar()
        self.assertEqual((row.east, row.north, row.height), ("20.000", "30.000", "35.000"))
        row.height, row.dip = "80", 90.0
        planned_holes.begin_on_ground(row)
        self.assertEqual(row.height, "35.000")
        ops.planned_hole_remove()
        self.assertEqual(self.tubes(), [])

    def test_it_follows_the_model(self):
        row = self.a_model()
        raise_by(self.items[1], -5.0)
        ops.build()
        hole = planned_holes.kept(row)
        self.assertEqual([(each.begin, each.end) for each in hole.intervals], [(0, 20), (20, 35)])
        self.assertEqual(len(self.tubes()), 1)
        ops.surface_remove()
        ops.build()
        self.assertEqual(len(planned_holes.kept(self.model.planned_holes[0]).intervals), 1)

    def test_it_is_kept_in_the_file(self):
        self.a_model()
        before = planned_holes.kept(self.model.planned_holes[0]).rows()
        self.save_and_open()
        row = self.model.planned_holes[0]
        self.assertEqual(planned_holes.kept(row).rows(), before)
        self.assertEqual(len(self.tubes()), 1)
        row.length = 20.0  # a model that was not built since the file was opened is not in memory
        self.assertIsNone(built_models.current(self.scene))
        self.assertIsNone(planned_holes.kept(row))
        self.refused(ops.planned_hole_save, "blocks are not known yet", filepath=str(self.folder / "h.csv"))
        ops.build()
        self.assertEqual([e.end for e in planned_holes.kept(row).intervals], [15, 20])

    def test_an_ensemble_says_how_certain_it_is(self):
        ops.open_project(filepath=str(SAMPLES / "uncertain_valley" / "project.toml"))
        if not len(self.model.results):
            ops.build()
        ops.planned_hole_add()
        row = self.model.planned_holes[0]
        self.refused(ops.planned_hole_certainty, "no ensemble")
        ops.ensemble(realizations=4, seed=2)
        with_variance = planned_holes.kept(row).contacts
        self.assertTrue(all(each.share is None for each in with_variance))
        ops.planned_hole_certainty()
        hole = planned_holes.kept(row)
        self.assertTrue(all(0 <= each.probability <= 1 for each in hole.intervals))
        self.assertTrue(any(each.share == 1.0 and each.deviation > 0 for each in hole.contacts))
        self.assertEqual(hole.probability.shape, (len(hole.depths), len(hole.block_names)))
        ops.planned_hole_save(filepath=str(self.folder / "h.csv"))
        rows = list(csv.DictReader((self.folder / "h.csv").read_text().splitlines()))
        self.assertEqual([each["name"] for each in rows], [each["name"] for each in hole.rows()])
        self.assertIn("probability Gravel", rows[0])
        row.dip = 80.0
        self.assertIsNone(planned_holes.kept(row).probability, "it was moved since")
        self.assertEqual(planned_holes.axis_of(row).collar, tuple(hole.axis.collar))
