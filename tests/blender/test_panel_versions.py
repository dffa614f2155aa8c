# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of every version of the settings, opened today. tests/data/versions has one of each, written by
make_version_fixture.py from the example two_layers, whose files are not beside it."""

import json
import math
from pathlib import Path

import bpy
import realmodel
from panel_case import PanelCase, ops, raise_by
from realmodel import handlers, versioning
from realmodel.bl import reading_text, settings

FILES = Path(__file__).resolve().parents[1] / "data" / "versions"
CLAY, SAND = 105000.0, 25400.0  # about: methods become better


class Versions(PanelCase):
    def test_there_is_a_file_of_every_version(self):
        self.assertEqual(
            {path.name for path in FILES.glob("*.blend")},
            {f"v{n}.blend" for n in range(settings.VERSION + 1)},
        )
        self.assertEqual(len(versioning._STEPS), settings.VERSION)

    def test_each_can_be_gone_on_with(self):
        for path in sorted(FILES.glob("*.blend")):
            with self.subTest(path.name):
                bpy.ops.wm.open_mainfile(filepath=str(path))
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

    def test_texts_of_version_3_become_settings(self):
        ops.rock_add()
        for number in range(3):
            ops.surface_add(empty=True)
            if number:
                ops.rock_add()
        by_length, by_points, by_number = rocks = self.model.rocks
        with settings.filling():
            by_length.edge_length = 9.7
            by_points.mesh_options = '{"edge_length": "auto", "triangles": 300}'
            by_number.mesh_options = '{"triangles": 500}'
            row = by_length.surfaces[0]
            row.reading = (
                '{"columns": ["E", 2, "Z"], "where": {"bed": ["a", "b"]}, "nodata": [-9, ""], "height": "h", '
                '"separator": "\\t", "units": {"z": "ft"}}'
            )
        given = json.loads(row.reading)
        for rock in rocks:
            rock.edges_by = "LENGTH"
        self.model.version = 3
        handlers.migrate_all()
        self.assertEqual([rock.edges_by for rock in rocks], ["LENGTH", "AUTO", "TRIANGLES"])
        self.assertEqual(
            (by_points.use_triangles, by_points.triangles, by_number.triangles), (True, 300, 500)
        )
        self.assertEqual(settings.number(by_length, "edge_length"), 9.7)
        self.assertEqual((reading_text.options(row), row.reading), (given, ""))

    def assert_volumes(self, clay, sand, tolerance=0.02):
        volumes = self.volumes()
        self.assertEqual(set(volumes), {"Clay", "Sand"})
        for name, expected in (("Clay", clay), ("Sand", sand)):
            self.assertTrue(math.isclose(volumes[name], expected, rel_tol=tolerance), volumes)

    def test_damage_is_reported_and_left_alone(self):
        realmodel.unregister()
        bpy.ops.wm.open_mainfile(filepath=str(FILES / "v0.blend"))
        text = self.scene["realmodel_project"]
        realmodel.register()
        middle = len(text) // 2
        spoiled = text[:middle] + "AAAA" * 50 + text[middle + 200 :]
        for value in (text[:middle], text[:middle] + "!" + text[middle:], "", "UEsDBA==", 5, spoiled):
            self.scene["realmodel_project"] = value
            handlers.migrate_all()
            self.assertFalse(self.model.exists)
            self.assertIn("cannot be read", bpy.context.window_manager.realmodel.problem)
            self.assertEqual(len([o for o in self.scene.objects if o.get("realmodel")]), 4)

    def test_a_newer_file_is_left_alone(self):
        ops.rock_add()
        self.model.version = settings.VERSION + 1
        handlers.migrate_all()
        self.assertEqual(self.model.version, settings.VERSION + 1)
