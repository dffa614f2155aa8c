# SPDX-License-Identifier: GPL-3.0-or-later
"""Juxtaposition diagrams and stereonets saved from the panel."""

from panel_case import PanelCase, ops


class DiagramsTest(PanelCase):
    def test_both_diagrams_of_a_model_with_a_fault_and_dips(self):
        self.refused(ops.save_stereonet, "no model yet", filepath=str(self.folder / "never.svg"))
        ops.open_sample(sample="faulted_dome")
        if not len(self.model.results):
            ops.build()
        self.model.structure_kind = "FAULT"
        path = self.folder / "fault.svg"
        self.assertEqual(ops.save_juxtaposition(filepath=str(path)), {"FINISHED"})
        text = path.read_text()
        self.assertIn("<title>footwall Salt</title>", text)
        self.assertIn("eastern fault", text)
        path = self.folder / "dips.svg"
        self.assertEqual(ops.save_stereonet(filepath=str(path), of="beds", net="EQUAL_ANGLE"), {"FINISHED"})
        self.assertIn("60 poles", path.read_text())
        self.assertIn("Wulff", path.read_text())
        self.refused(ops.save_stereonet, "no dips of 'x'", filepath=str(self.folder / "x.svg"), of="x")
