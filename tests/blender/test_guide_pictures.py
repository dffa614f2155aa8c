# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of panels in the guide show what the panels have: `scripts/draw_guide.py` wrote down what they
had when it took the pictures. Where this fails, draw them again: `scripts/draw_guide.py start tour`."""

import json
import sys
from pathlib import Path

import bpy
from panel_case import PanelCase, ops

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import guide_panels


class GuidePictures(PanelCase):
    def setUp(self):
        super().setUp()
        self.kept = json.loads(guide_panels.RECORD.read_text(encoding="utf-8"))

    def compare(self, *names):
        for name in names:
            with self.subTest(panel=name):
                shown = guide_panels.shown(bpy.context, name)
                self.assertEqual(shown, self.kept[name], f"docs/images/guide/{name}.png is out of date")
                self.assertTrue((guide_panels.RECORD.parent / f"{name}.png").is_file())

    def test_the_tab_in_a_new_file(self):
        self.compare(guide_panels.START)

    def test_each_panel(self):
        ops.open_sample(sample=guide_panels.EXAMPLE)
        guide_panels.choose_rows(self.model)
        self.compare(*guide_panels.PANELS)

    def test_a_missing_setting_is_noticed(self):
        ops.open_sample(sample=guide_panels.EXAMPLE, build=False)
        self.model.rocks[0].active_surface = 2
        shown = guide_panels.shown(bpy.context, "surfaces")
        self.assertIn("RealModelSurface.method", shown)
        self.assertIn("realmodel.draw_contacts", shown)
