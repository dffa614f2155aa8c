# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows and reads is in the unit of the model."""

import unittest
from types import SimpleNamespace

import bpy
from panel_case import PanelCase, ops
from realmodel.bl.pictures import batch
from realmodel.bl.project import units
from realmodel.core import build, load_project
from realmodel.core.base.units import METERS

PROJECT = """format = 1
name = "quarry"
units = "{unit}"
[[rock]]
name = "r"
region = [[0, 0], [2000, 0], [2000, 500], [0, 500]]
edge_length = 250
base_elevation = 0
[[rock.surface]]
name = "S"
method = "constant"
value = 40
"""


class Numbers(unittest.TestCase):
    def test_no_digit_is_cut_and_thousands_stand_apart(self):
        for value, text in (
            (0.0, "0"),
            (12.3456, "12.35"),
            (999.96, "1,000"),
            (4500.4, "4,500"),
            (999_999.0, "999,999"),
            (999_999.7, "1 M"),
            (38_896_678.0, "38.9 M"),
            (194_050_816.0, "194.1 M"),
            (-2.5e6, "-2.5 M"),
            (4_321_000_000.0, "4,321 M"),
            (2e15, "2.000e+15"),
        ):
            self.assertEqual(units.number_text(value), text, value)


class ModelInFeet(PanelCase):
    def open(self, unit):
        path = self.folder / "p.toml"
        path.write_text(PROJECT.format(unit=unit))
        ops.open_project(filepath=str(path))
        return path

    def test_one_unit_of_the_scene_is_one_of_the_model(self):
        for unit, system, length_unit in (
            ("ft", "IMPERIAL", "FEET"),
            ("us-ft", "IMPERIAL", "FEET"),
            ("in", "IMPERIAL", "INCHES"),
            ("km", "METRIC", "KILOMETERS"),
            ("m", "METRIC", "METERS"),
        ):
            self.open(unit)
            shown = self.scene.unit_settings
            self.assertAlmostEqual(shown.scale_length, float(METERS[unit]), places=7)
            self.assertEqual((shown.system, shown.length_unit), (system, length_unit))

    def test_lengths_are_typed_and_read_in_feet(self):
        self.open("ft")
        shown = self.scene.unit_settings
        typed = bpy.utils.units.to_value(shown.system, "LENGTH", "10 ft") / shown.scale_length
        self.assertAlmostEqual(typed, 10.0, places=5)
        edge = self.model.rocks[0].edge_length * shown.scale_length
        text = bpy.utils.units.to_string(shown.system, "LENGTH", edge, precision=3, split_unit=False)
        self.assertTrue(text.startswith("250"), text)

    def test_labels_are_in_feet(self):
        self.open("ft")
        ops.build()
        row = self.model.results[0]
        self.assertEqual(units.volume_text(self.scene, row), "40 M")
        self.assertEqual(units.unit_text(self.scene, 3), "ft³")
        self.assertEqual(units.full_volume_text(self.scene, row), "40,000,000 ft³")
        self.assertEqual(units.total_volume_text(self.scene), "40 M ft³")
        self.assertEqual(units.area_text(self.scene, 1e6), "1 M ft²")
        self.assertEqual(units.length_text(self.scene, 40.0), "40 ft")

    def test_a_large_model_is_measured_in_cubic_kilometers(self):
        path = self.folder / "p.toml"
        path.write_text(PROJECT.format(unit="m").replace("2000", "31000").replace("500]", "13000]"))
        ops.open_project(filepath=str(path))
        self.model.rocks[0].edge_length = 20000.0
        ops.build()
        (row,) = self.model.results  # ten thousand millions would have no room in the list
        self.assertEqual(units.volume_text(self.scene, row), "16.12")
        self.assertEqual(units.unit_text(self.scene, 3), "km³")
        self.assertEqual(units.total_volume_text(self.scene), "16.12 km³")
        self.assertEqual(units.full_volume_text(self.scene, row), "16,120,000,000 m³")

    def test_who_sees_the_other_system_reads_its_units(self):
        self.open("ft")
        self.scene.unit_settings.system = "METRIC"
        self.assertEqual(units.length_text(self.scene, 100.0), "30.48 m")
        self.assertEqual(units.area_text(self.scene, 100.0), "9.29 m²")
        self.open("m")
        self.scene.unit_settings.system = "IMPERIAL"
        self.assertEqual(units.length_text(self.scene, 0.3048), "1 ft")
        self.scene.unit_settings.system = "NONE"
        self.assertEqual(units.length_text(self.scene, 0.3048), "0.3048 m")

    def test_another_unit_sets_the_scene_up_and_is_undone(self):
        self.model.units = "yd"
        self.assertAlmostEqual(self.scene.unit_settings.scale_length, 0.9144, places=6)
        self.model.units = "m"
        self.assertEqual(self.scene.unit_settings.scale_length, 1.0)

    def test_a_system_chosen_by_the_user_stays(self):
        self.scene.unit_settings.system = "IMPERIAL"
        self.open("m")
        self.assertEqual(self.scene.unit_settings.system, "IMPERIAL")
        self.scene.unit_settings.system = "NONE"
        self.open("ft")
        self.assertEqual(self.scene.unit_settings.system, "NONE")
        self.assertAlmostEqual(self.scene.unit_settings.scale_length, 0.3048, places=6)

    def test_a_batch_build_does_the_same(self):
        path = self.folder / "p.toml"
        path.write_text(PROJECT.format(unit="ft"))
        batch.write_scene(build(load_project(path)))
        self.assertAlmostEqual(self.scene.unit_settings.scale_length, 0.3048, places=6)


class Rows(unittest.TestCase):
    def test_a_share_says_less_than_one_percent(self):
        from realmodel.ui.lists import share_text

        self.assertEqual(share_text(SimpleNamespace(share=49.05, volume=1.0)), "49")
        self.assertEqual(share_text(SimpleNamespace(share=0.2, volume=1.0)), "< 1")
        self.assertEqual(share_text(SimpleNamespace(share=0.0, volume=0.0)), "0")
