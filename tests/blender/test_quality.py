# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of a surface: charts, figures, and worst points."""

from types import SimpleNamespace

import bpy
import numpy as np
from blender_state import inventory
from panel_case import PanelCase, ops
from realmodel.bl.scene import quality
from realmodel.core import cross_validate
from realmodel.operators.judge import REALMODEL_OT_save_chart as SaveChart
from realmodel.operators.sections import REALMODEL_OT_save_section as SaveSection


class Quality(PanelCase):
    def setUp(self):
        super().setUp()
        quality.forget()
        ops.open_sample(sample="gravel_plain")
        if not len(self.model.results):
            ops.build()
        self.rock = self.model.rocks[0]

    def choose(self, name):
        self.rock.active_surface = self.rock.surfaces.find(name)

    def interpolated(self):
        """The name of a surface from points."""
        return next(row.name for row in self.rock.surfaces if "POINTS" in row.source)

    def test_a_surface_from_points(self):
        name = self.interpolated()
        self.choose(name)
        before = inventory()
        self.assertIsNone(quality.found(self.scene))
        self.assertEqual(ops.check_quality(), {"FINISHED"})
        found = quality.found(self.scene)
        points = found.cross_validation.points
        alone = cross_validate(points)
        self.assertAlmostEqual(found.cross_validation.rmse, alone.rmse, places=9)
        self.assertEqual(inventory(), before)
        for chart, *_ in quality.CHARTS:
            quality.icon(self.scene, chart, 160)
            quality.icon(self.scene, chart, 160)
            self.assertTrue(quality.lines(found, chart, "m"))
        deviations = [quality.volume_deviation(self.scene, row) for row in self.model.results]
        self.assertTrue(any(deviations))
        self.assertEqual(len(quality._pictures), 3)
        for picture in quality._pictures.values():
            self.assertEqual(tuple(picture.image_size), (160, 160))
            pixels = np.array(picture.image_pixels_float).reshape(-1, 4)
            self.assertEqual(pixels[:, 3].min(), 1.0)
            self.assertGreater((pixels[:, :3] == 1.0).all(axis=1).sum(), 160 * 80)  # the page
            self.assertGreater((pixels[:, :3] < 0.5).any(axis=1).sum(), 300)  # what is drawn on it
        ops.cursor_to_point(index=0)
        worst = np.abs(found.cross_validation.errors).argmax()
        origin = np.array(self.scene.get("realmodel_origin", (0, 0, 0)))
        np.testing.assert_allclose(np.array(self.scene.cursor.location) + origin, points[worst], rtol=1e-6)
        for ending in ("svg", "png", "dxf"):
            path = self.folder / f"chart.{ending}"
            ops.save_chart(filepath=str(path), chart="CROSS_VALIDATION")
            self.assertGreater(path.stat().st_size, 1000)
        words = [cls.of_what(SimpleNamespace(chart="MESH"), bpy.context) for cls in (SaveChart, SaveSection)]
        self.assertEqual(words, [(name, "mesh"), ("section",)], "not to replace each other's files")
        self.refused(ops.save_chart, "must end in", filepath=str(self.folder / "chart.bmp"))

    def test_another_build_has_not_been_checked(self):
        self.choose(self.interpolated())
        ops.check_quality()
        ops.build()
        self.assertIsNone(quality.found(self.scene))
        self.refused(ops.save_chart, "was not checked yet", filepath=str(self.folder / "never.svg"))

    def test_in_a_thread(self):
        self.choose(self.interpolated())
        quality.start(self.scene)
        self.assertIsNotNone(quality.state())
        quality._working["job"].wait(60)
        self.assertIsNone(quality._look())
        self.assertIsNotNone(quality.found(self.scene))
        quality.start(self.scene)
        quality.stop()
        self.assertIsNone(quality.state())
        self.assertFalse(bpy.app.timers.is_registered(quality._look))

    def test_a_new_surface_is_not_in_the_model(self):
        ops.surface_add(empty=True)
        self.rock.active_surface = len(self.rock.surfaces) - 1
        self.refused(ops.check_quality, "is not in the built model")
