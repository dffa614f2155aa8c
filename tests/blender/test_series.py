# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects with series in Blender: built as by the core, kept in the .blend, and saved again."""

import bpy
import numpy as np
from panel_case import SAMPLES, PanelCase, ops
from realmodel.core import build, load_project
from recording_layout import draw_tab

PROJECT = SAMPLES / "recumbent_fold" / "project.toml"


class Series(PanelCase):
    def test_the_panel_says_what_it_is(self):
        ops.open_project(filepath=str(PROJECT))
        rock = self.model.rocks[0]
        for number, surface in enumerate(rock.surfaces):
            rock.active_surface = number
            labels = " ".join(draw_tab(bpy.context).labels)
            self.assertEqual("A level set of the field" in labels, surface.series == "folded beds")

    def test_a_fold_is_built_kept_and_saved(self):
        ops.open_project(filepath=str(PROJECT))
        ops.build()
        expected = {block.name: block.volume for block in build(load_project(PROJECT)).blocks}
        self.assertEqual(self.volumes(), expected)
        for name in expected:
            self.assertIn(name, bpy.data.objects)
        self.save_and_open()
        for surface in self.model.rocks[0].surfaces:
            surface.filepath = ""  # what the .blend keeps is enough
        ops.build()
        self.assertEqual(self.volumes(), expected)
        saved = self.folder / "saved.toml"
        ops.save_project(filepath=str(saved))
        rock, given = (load_project(path).rocks[0] for path in (saved, PROJECT))
        self.assertEqual([each.series for each in rock.surfaces], [each.series for each in given.surfaces])
        self.assertEqual(rock.series[0].resolution, given.series[0].resolution)
        again = build(load_project(saved))
        np.testing.assert_allclose(
            [block.volume for block in again.blocks], list(expected.values()), rtol=1e-9
        )
