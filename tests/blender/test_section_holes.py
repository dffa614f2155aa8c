# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections through chosen boreholes."""

from itertools import pairwise

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.project import project_settings
from realmodel.bl.scene import section_holes


class SectionHoles(PanelCase):
    def a_model(self):
        ops.open_project(filepath=str(SAMPLES / "gravel_plain" / "project.toml"))
        if not len(self.model.results):
            ops.build()
        return section_holes.paths(self.scene)

    def test_a_section_goes_through_the_holes_and_beyond(self):
        holes = self.a_model()
        self.refused(ops.fence_holes, "no boreholes are chosen")
        names = list(holes)[:3]
        section_holes.choose(self.scene, names)
        self.assertEqual(self.model.view.section_holes, ", ".join(names))
        self.model.view.section_beyond = 10.0
        line = section_holes.line(self.scene)
        plan = [holes[name][0][:2] for name in names]
        length = sum(np.linalg.norm(b - a) for a, b in pairwise(plan))
        self.assertTrue(np.allclose(line[1], plan[1]))
        self.assertAlmostEqual(np.linalg.norm(line[0] - plan[0]), 0.1 * length, places=4)
        ops.fence_holes()
        item = bpy.context.active_object
        self.assertTrue(item.name.startswith("Holes"))
        found = coordinates(item.data).astype(float) + project_settings.model_origin(self.scene)
        for place in plan[1:2]:
            near = np.abs(found[:, :2] - place).max(axis=1) < 1e-2
            self.assertTrue(near.any(), "the bend is at the hole")
        ops.save_section(filepath=str(self.folder / "holes.svg"), along="HOLES")
        drawn = (self.folder / "holes.svg").read_text()
        self.assertIn("Distance", drawn)
        for name in names:
            self.assertIn(f">{name}<", drawn)

    def test_names_are_read_as_they_are_typed(self):
        self.a_model()
        self.model.view.section_holes = ' W1,"a, b" ,, W2 '
        self.assertEqual(section_holes.chosen(self.scene), ["W1", "a, b", "W2"])
        section_holes.choose(self.scene, ["a, b", "W2"])
        self.assertEqual(section_holes.chosen(self.scene), ["a, b", "W2"])
        self.refused(ops.fence_holes, "there is no hole a, b and W2")
        self.refused(ops.pick_holes, "no borehole was picked")
        self.model.view.section_holes = ""
        self.refused(ops.save_section, "no boreholes are chosen", filepath="x.svg", along="HOLES")

    def test_sheets_have_the_sections_of_the_scene(self):
        self.a_model()
        file = self.folder / "sheets.svg"
        ops.save_sheets(filepath=str(file))
        self.assertNotIn("Section A-A", file.read_text())
        section_holes.choose(self.scene, list(section_holes.paths(self.scene))[:3])
        ops.section_plane(axis="Y")
        self.model.library[0].color = (0.25, 0.5, 1.0)
        ops.save_sheets(filepath=str(file), size="A2-portrait", scale=5000.0)
        drawn = file.read_text()
        for text in ("Section A-A'", "Section B-B'", "Scale 1 : 5,000 on A2", "Sheet 1 of 1"):
            self.assertIn(f">{text}<", drawn)
        self.assertNotIn("Section C-C", drawn)
        self.assertEqual(drawn.count('fill="#4080ff"'), 4, "map, sections and legend have the color of now")
        self.refused(ops.save_sheets, "take the scale 1 : 5,000", filepath=str(file), scale=100.0)
        self.assertEqual(file.read_text(), drawn)
