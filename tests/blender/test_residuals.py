# SPDX-License-Identifier: GPL-3.0-or-later
"""Residuals of points in the viewport and in numbers."""

import bpy
import numpy as np
from blender_state import coordinates
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
            self.assertEqual(row[3:6], (0.0, 0.0, 0.0))  # tied surfaces pass through their points
        self.assertEqual({polygon.material_index for polygon in item.data.polygons}, {residuals._STEPS // 2})
        self.assertIsNone(residuals.key(self.scene))
        ops.build()
        self.assertEqual(residuals.rows(self.scene), rows)
        self.model.view.show_residuals = False
        self.assertFalse([o for o in self.scene.objects if o.get("realmodel_view") == "residuals"])
        self.model.color_by = "AGE"
        self.model.color_by = "PROPERTY"
        self.assertEqual({material.name for material in bpy.data.materials}, before)

    def test_bodies_are_as_long_as_wide_and_apart_however_heights_are_stretched(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        if not len(self.model.results):
            ops.build()
        self.model.view.exaggeration = 6.0
        self.model.view.show_residuals = True
        item = next(o for o in self.scene.objects if o.get("realmodel_view") == "residuals")
        middles = {}
        for stretch in (6.0, 1.0, 2.5):
            self.model.view.exaggeration = stretch
            bpy.context.view_layer.update()
            matrix = np.array(item.matrix_world)
            shown = coordinates(item.data) @ matrix[:3, :3].T + matrix[:3, 3]
            bodies = shown.reshape(-1, 6, 3)
            size = np.ptp(bodies, axis=1)
            np.testing.assert_allclose(size[:, 2], size[:, 0], rtol=1e-3)
            np.testing.assert_allclose(size, size[0, 0], rtol=1e-2)
            middle = bodies.mean(axis=1)
            away = np.linalg.norm(middle[:, None] - middle[None], axis=2)
            np.fill_diagonal(away, np.inf)
            self.assertLess((away.min(axis=1) < 0.99 * size[0, 0]).mean(), 0.2)
            middles[stretch] = (middle - matrix[:3, 3]) / (1.0, 1.0, stretch)
        np.testing.assert_allclose(middles[6.0], middles[1.0], atol=1e-3)
        np.testing.assert_allclose(middles[2.5], middles[1.0], atol=1e-3)
