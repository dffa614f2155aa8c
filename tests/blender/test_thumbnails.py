# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that come with the add-on: one for each preset of Fill with Strata."""

import bpy
from panel_case import PanelCase
from realmodel.bl.host import thumbnails


class Thumbnails(PanelCase):
    def test_each_preset_has_a_picture_unlike_the_others(self):
        items = bpy.ops.realmodel.fill_with_strata.get_rna_type().properties["preset"].enum_items
        shown = thumbnails.pictures("filling.jpg")
        self.assertEqual(len(shown), len([item for item in items if item.identifier != "NONE"]))
        self.assertEqual(shown.shape[1], shown.shape[2])
        self.assertEqual(len({picture.tobytes() for picture in shown}), len(shown))
        for picture in shown:
            self.assertGreater(picture[:, :, :3].std(), 0.05)  # not empty
