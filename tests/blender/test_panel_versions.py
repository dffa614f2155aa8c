# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of RealModel 0.1, version 6 of the settings, opened today: tests/data/versions/v6.blend, written by
make_version_fixture.py from the example two_layers, whose files are not beside it."""

import math
from pathlib import Path

import bpy
from panel_case import PanelCase, ops, raise_by
from realmodel import handlers
from realmodel.bl.project import settings

FILES = Path(__file__).resolve().parents[1] / "data" / "versions"
CLAY, SAND = 105000.0, 25400.0  # about: methods become better


class Versions(PanelCase):
    def test_a_file_of_an_earlier_version_can_be_gone_on_with(self):
        bpy.ops.wm.open_mainfile(filepath=str(FILES / "v6.blend"))
        self.assertEqual(self.model.version, settings.VERSION)
        self.assertEqual([s.name for s in self.model.rocks[0].surfaces], ["top of clay", "ground"])
        self.assertEqual([e.name for e in self.model.library], ["Clay", "Sand"])
        self.assert_volumes(CLAY, SAND)
        before = sorted(o.name for o in self.scene.objects)
        ops.build()
        self.assertEqual(sorted(o.name for o in self.scene.objects), before)
        clay, sand = self.volumes().values()
        self.assert_volumes(CLAY, SAND)
        ground = self.model.rocks[0].surfaces[1].interface
        raise_by(ground, 1.0)
        ops.build()
        self.assertAlmostEqual(sum(self.volumes().values()), clay + sand + 6000.0, delta=0.05)

    def assert_volumes(self, clay, sand, tolerance=0.02):
        volumes = self.volumes()
        self.assertEqual(set(volumes), {"Clay", "Sand"})
        for name, expected in (("Clay", clay), ("Sand", sand)):
            self.assertTrue(math.isclose(volumes[name], expected, rel_tol=tolerance), volumes)

    def test_a_file_of_another_version_is_reported_and_left_alone(self):
        manager = bpy.context.window_manager.realmodel
        ops.rock_add()
        for version, writer in ((settings.VERSION, ""), (4, "a test version"), (99, "a newer version")):
            self.model.version = version
            manager.problem = ""
            handlers.check_versions()
            self.assertEqual(self.model.version, version)
            self.assertIn(writer, manager.problem)
            self.assertEqual(bool(writer), bool(manager.problem))
