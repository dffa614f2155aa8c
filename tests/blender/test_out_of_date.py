# SPDX-License-Identifier: GPL-3.0-or-later
"""A model says that it is out of date where anything that made it has changed, and only there."""

import json
import os
import shutil
from unittest import mock

import bpy
from blender_state import empty_file
from panel_case import SAMPLES, PanelCase, ops, raise_by, stack
from realmodel.bl import overlay
from realmodel.bl.display import replacing
from realmodel.bl.scene import build_job, live
from realmodel.core import Model

_SAID = "out of date"


class OutOfDate(PanelCase):
    def check(self, expected, what=""):
        self.assertEqual(live.check(self.scene), expected, what)
        self.assertEqual(self.model.is_outdated, expected, what)

    def built(self, *heights):
        items = stack(*(heights or (0.0, 10.0, 30.0)))
        ops.build()
        self.check(False)
        return items

    def opened(self):
        """The example of two layers, in files of the test's own, built."""
        folder = shutil.copytree(SAMPLES / "two_layers", self.folder / "two_layers")
        ops.open_project(filepath=str(folder / "project.toml"))
        ops.build()
        self.check(False)
        return folder

    def test_each_change_and_its_way_back(self):
        items = self.built()
        surface, rock = self.model.rocks[0].surfaces[1], self.model.rocks[0]
        changes = (
            (surface, "rule", "conformable"),
            (surface, "name", "other"),
            (surface, "property_id", surface.property_id + 1),
            (rock, "base_elevation", -5.0),
            (self.model.library[0], "name", "granite"),
            (self.model.library[0], "density", 2650.0),
            (self.model, "name", "other"),
            (items[0], "location", (0.0, 0.0, 1.0)),
        )
        for row, key, value in changes:
            before = getattr(row, key)
            before = tuple(before) if key == "location" else before
            setattr(row, key, value)
            bpy.context.view_layer.update()
            self.check(True, key)
            setattr(row, key, before)
            if key == "base_elevation":
                rock.use_base = False
            bpy.context.view_layer.update()
            self.check(False, key)

    def test_surfaces_removed_and_moved_and_an_edited_object(self):
        self.built()
        ops.surface_move(direction="DOWN")
        self.check(True)
        ops.surface_move(direction="UP")
        self.check(False)
        ops.surface_remove()
        self.check(True)
        empty_file()
        items = self.built()
        raise_by(items[1], 1.0)
        self.check(True)
        ops.build()
        self.check(False)
        bpy.data.objects.remove(items[1])
        self.check(True)

    def test_what_is_only_for_the_eye_changes_nothing(self):
        self.built()
        self.model.library[0].color = (1.0, 0.0, 0.0)
        self.model.color_by, self.model.display, self.model.stage = "AGE", "SURFACES", 1
        self.model.view.exaggeration = 3.0
        bpy.context.view_layer.update()
        self.check(False)

    def test_a_file_on_disk(self):
        folder = self.opened()
        self.save_and_open()
        self.check(False, "opened again")
        os.utime(folder / "clay.csv", (1.0, 1.0))
        self.check(True)
        ops.build()
        self.check(False)
        (folder / "clay.csv").unlink()
        self.check(False, "the .blend has what was in it")

    def test_an_interface_edited_by_hand(self):
        self.opened()
        raise_by(self.model.rocks[0].surfaces[0].interface, 0.5)
        self.check(True)
        ops.build()
        self.check(False)

    def test_settings_that_change_during_a_build(self):
        """As by Ctrl+Z."""
        self.built()
        surface = self.model.rocks[0].surfaces[1]
        surface.rule = "conformable"
        job = build_job.BuildJob(self.scene, bpy.context.evaluated_depsgraph_get())
        surface.rule = "erosional"
        job.run()
        self.check(True)
        surface.rule = "conformable"
        self.check(False)

    def test_legend_report_and_exports_say_so(self):
        self.built()
        path = self.folder / "report.json"
        self.assertFalse(any(_SAID in key.title for key in overlay._keys(self.scene)))
        ops.report(filepath=str(path))
        self.assertNotIn(_SAID, path.read_text())
        self.model.rocks[0].surfaces[1].rule = "conformable"
        self.assertTrue(all(_SAID in key.title for key in overlay._keys(self.scene)))
        ops.report(filepath=str(path))
        self.assertEqual(json.loads(path.read_text())["warnings"][0]["kind"], "outdated")
        ops.export(filepath=str(self.folder / "model.npz"))
        warning = Model.load(self.folder / "model.npz").warnings[0]
        self.assertEqual(warning.kind, "outdated")

    def test_another_model_is_not_built_in_silence(self):
        self.built()
        self.model.rocks[0].surfaces[1].rule = "conformable"
        self.save_and_open()
        self.check(True)
        self.refused(ops.report, "out of date, and not in memory", filepath=str(self.folder / "r.json"))
        ops.build()
        ops.report(filepath=str(self.folder / "r.json"))

    def test_cells_of_a_model_that_is_not_in_memory(self):
        """In a window, where they are made in a thread: the view says why they are not."""
        self.built()
        self.model.rocks[0].surfaces[1].rule = "conformable"
        self.save_and_open()
        with mock.patch.object(replacing, "must_finish_now", return_value=False):
            bpy.context.scene.realmodel.display = "POLYHEDRA"
        self.assertIn("out of date, and not in memory", bpy.context.scene.realmodel.view.message)
