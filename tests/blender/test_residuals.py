# SPDX-License-Identifier: GPL-3.0-or-later
"""Residuals of points in the viewport and in numbers."""

import bpy
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.display import residuals


class ResidualsOfPoints(PanelCase):
    def test_points_and_numbers(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        if not len(self.model.results):
            ops.build()
        before = {material.name for material in bpy.data.materials}
        self.model.view.show_residuals = True
        item = next(o for o in self.scene.objects if o.get("realmodel_view") == "residuals")
        rows = residuals.rows(self.scene)
        self.assertTrue(rows)
        self.assertEqual(len(item.data.polygons), 8 * sum(row[2] for row in rows))
        for row in rows:
            self.assertGreater(row[4], 0.0)
            self.assertGreaterEqual(abs(row[5]), row[4])
            self.assertLess(abs(row[5]), 1.0)  # kriging honors its points; what is left is the mesh's
        ops.build()
        self.assertEqual(residuals.rows(self.scene), rows)
        self.model.view.show_residuals = False
        self.assertFalse([o for o in self.scene.objects if o.get("realmodel_view") == "residuals"])
        self.model.color_by = "AGE"
        self.model.color_by = "PROPERTY"
        self.assertEqual({material.name for material in bpy.data.materials}, before)
