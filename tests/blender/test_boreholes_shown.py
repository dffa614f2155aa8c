# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes as tubes in the colors of the layers."""

from unittest import mock

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.display import bodies, colors
from realmodel.bl.project import borehole_picks, observed_blocks, project_settings, surface_dips
from realmodel.core import Dips, Observations


class BoreholesShown(PanelCase):
    def test_materials_are_looked_for_once_and_not_for_each_datum(self):
        ops.rock_add()
        ops.surface_add(name="top", empty=True)
        rock, count = self.model.rocks[0], 200
        z = -np.arange(count, dtype=float)
        places = np.column_stack([np.zeros(count), np.zeros(count), z])
        used = np.arange(count) % 3 > 0
        observed_blocks.keep(
            rock, Observations(places, ["top"] * count, ["A"] * count, -z, np.arange(count) // 2, used)
        )
        surface_dips.keep(
            rock.surfaces[0], Dips(places[:, :2] + z[:, None], np.ones((count, 2)), z, used=used)
        )
        view = self.model.view
        with (
            mock.patch.object(colors, "of_property", wraps=colors.of_property) as of_property,
            mock.patch.object(colors, "plain_material", wraps=colors.plain_material) as plain,
        ):
            view.show_boreholes = view.show_contacts = view.show_dips = True
        self.assertEqual(len(bodies.listed(self.scene, "dips")), 1)
        self.assertLess(of_property.call_count + plain.call_count, 30)

    def test_tubes_stand_where_the_holes_are(self):
        ops.open_project(filepath=str(SAMPLES / "gravel_plain" / "project.toml"))
        if not len(self.model.results):
            ops.build()
        holes = borehole_picks.of_rock(self.model.rocks[0])
        self.assertGreater(len(holes), 3)
        before = {o.name for o in self.scene.objects}
        self.model.view.show_boreholes = True
        item = next(o for o in self.scene.objects if o.get("realmodel_view") == "boreholes")
        origin = project_settings.model_origin(self.scene)
        found = coordinates(item.data).astype(float) + origin
        plan = np.array([picks[-1][1][:2] for _, picks in holes.values()])
        away = np.linalg.norm(found[:, None, :2] - plan[None], axis=2).min(axis=1)
        self.assertLess(away.max(), 0.01 * np.ptp(found[:, :2], axis=0).max())
        lowest = min(picks[-1][1][2] for _, picks in holes.values())
        self.assertAlmostEqual(found[:, 2].min(), lowest, delta=0.1)
        used = {item.data.materials[polygon.material_index].name for polygon in item.data.polygons}
        names = {
            material.name
            for row in self.model.results
            if row.object
            for material in row.object.data.materials
        }
        self.assertTrue(used & names, (used, names))
        self.model.view.show_boreholes = False
        self.assertEqual({o.name for o in self.scene.objects}, before)

    def test_they_are_kept_in_the_file(self):
        ops.open_project(filepath=str(SAMPLES / "gravel_plain" / "project.toml"))
        before = borehole_picks.of_rock(self.model.rocks[0])
        self.save_and_open()
        self.assertEqual(borehole_picks.of_rock(bpy.context.scene.realmodel.rocks[0]), before)
