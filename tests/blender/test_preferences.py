# SPDX-License-Identifier: GPL-3.0-or-later
"""Each preference has its effect."""

import os
import sys

import bpy
from panel_case import PanelCase, sheet, stack
from realmodel import preferences
from realmodel.bl.host.threads import threads
from realmodel.bl.objects import built_models
from realmodel.bl.scene import live
from realmodel.core.base import work

ops = bpy.ops.realmodel


class Preferences(PanelCase):
    def setUp(self):
        super().setUp()
        addons = bpy.context.preferences.addons
        addons.new().module = "realmodel"  # as enabling does
        self.addCleanup(lambda: addons.remove(addons["realmodel"]))

    @property
    def chosen(self):
        return bpy.context.preferences.addons["realmodel"].preferences

    def test_defaults_are_those_of_an_add_on_that_is_not_enabled(self):
        enabled = preferences.current()
        self.assertIsInstance(enabled, preferences.RealModelPreferences)
        names = list(preferences.RealModelPreferences.__annotations__)
        values = [getattr(enabled, name) for name in names]
        addons = bpy.context.preferences.addons
        addons.remove(addons["realmodel"])
        for name, value in zip(names, values, strict=True):
            self.assertAlmostEqual(getattr(preferences.current(), name), value, 6, name)
        addons.new().module = "realmodel"

    def test_threads(self):
        self.assertEqual(threads(), max(1, os.cpu_count() - 1))
        self.assertEqual(threads(is_short=True), 0)
        self.chosen.threads = 3
        self.assertEqual((threads(), threads(is_short=True)), (3, 3))
        found = []
        work.start(lambda _: found.append(threads())).wait()
        self.assertEqual(found, [3])
        stack(0.0, 10.0)
        ops.build()
        from realmodel.bl.objects import built_models

        self.assertEqual(built_models.current(self.scene).threads, 3)

    def test_device(self):
        stack(0.0, 10.0)
        self.chosen.device = "CUDA"
        sys.modules["realmodel._native_cuda"] = None  # as where it is not built
        self.addCleanup(sys.modules.pop, "realmodel._native_cuda")
        ops.build()
        self.chosen.device = "CPU"
        warnings = [str(warning) for warning in built_models.current(self.scene).warnings]
        self.assertEqual(len([text for text in warnings if text.startswith("device 'cuda'")]), 1)
        ops.build()
        self.assertEqual(built_models.current(self.scene).warnings, [])

    def test_memory_limit(self):
        stack(0.0, 10.0)
        self.chosen.memory_limit = 1e-6
        self.refused(ops.build, r"memory.*allowed")
        self.chosen.memory_limit = 0.0
        ops.build()

    def test_live_pause(self):
        stack(0.0, 10.0)
        ops.build()
        self.model.live = True
        self.live_is_done()
        for pause in (0.0, 0.4):
            self.chosen.live_pause = pause
            self.model.rocks[0].surfaces[1].block = f"after {pause}"
            self.live_is_done()
            self.assertGreaterEqual(live.measured[self.scene.name], pause)
        self.chosen.live_pause = 60.0
        live.touch(self.scene)
        live._work.look()
        self.assertEqual(live._work._jobs, {})
        live.stop_work()

    def test_a_new_model_begins_as_chosen(self):
        self.chosen.display, self.chosen.cells = "LINES", "BLOCKS"
        ops.rock_add()
        self.assertEqual((self.model.display, self.model.cells), ("LINES", "BLOCKS"))
        self.model.display = "AREAS"
        ops.new()
        self.assertEqual(self.model.display, "AREAS", "a model that is replaced leaves its display")
        bpy.context.window.scene = bpy.data.scenes.new("other")
        sheet("S", 0.0).select_set(True)
        ops.from_selected()
        self.assertEqual((self.model.display, self.model.cells), ("LINES", "BLOCKS"))
