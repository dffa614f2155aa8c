# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation by holes in the panel: the table, and the way to each hole."""

import bpy
from panel_case import PanelCase, ops
from realmodel.bl.field import hole_validation
from realmodel.bl.objects import built_models
from recording_layout import draw_tab

_HOLES = [(n, 20.0 * (n % 3), 20.0 * (n // 3)) for n in range(9)]


class HoleValidation(PanelCase):
    def setUp(self):
        super().setUp()
        collars, logs = ["hole,x,y,z"], ["hole,from,to,block"]
        for n, x, y in _HOLES:
            base = 10.0 + 0.1 * x + (15.0 if n == 4 else 0.0)  # of one hole the sand is too thick
            collars.append(f"B{n},{x},{y},50")
            logs += [f"B{n},0,{base},Sand", f"B{n},{base},40,Clay"]
        for name, lines in (("collars", collars), ("logs", logs)):
            (self.folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
        ops.boreholes_read(
            filepath=str(self.folder / "collars.csv"),
            directory=str(self.folder),
            files=[{"name": "collars.csv"}, {"name": "logs.csv"}],
        )
        self.rock = self.model.rocks[0]
        ops.region_around()
        self.rock.edge_length, self.rock.base_elevation = 10.0, 0.0
        for row in self.rock.surfaces:
            row.method = "universal_kriging"

    def test_the_table_says_what_the_core_says(self):
        self.refused(ops.cross_validate_holes, "press Build first")
        ops.build()
        self.refused(ops.cross_validate_holes, "two groups", folds=1)
        ops.cross_validate_holes()
        rows = self.model.left_out_holes
        found = built_models.current(self.scene).cross_validate_holes()
        self.assertEqual(hole_validation.summary(self.model), found.summary())
        self.assertEqual({row.name for row in rows}, {hole.hole for hole in found.holes})
        self.assertEqual(rows[0].name, "B4")  # the worst comes first
        worst = next(hole for hole in found.holes if hole.hole == "B4")
        self.assertEqual(rows[0].share, f"{100 * worst.share:.0f}")
        self.assertEqual(rows[0].error, f"{abs(worst.errors).max():.3g}")
        labels = draw_tab(bpy.context).labels
        self.assertIn("B4", labels)
        self.model.active_left_out_hole = 0
        self.assertTrue(self.model.view.show_boreholes and self.model.view.show_hole_names)
        text = " ".join(draw_tab(bpy.context).labels)
        self.assertIn("too high", text)
        ops.left_out_hole_show()
        ops.build()
        self.assertTrue(hole_validation.is_outdated(self.model))
        self.assertIn("was rebuilt", " ".join(draw_tab(bpy.context).labels))
        ops.left_out_holes_clear()
        self.assertEqual((len(rows), self.model.hole_validation), (0, ""))
        self.refused(ops.left_out_hole_show, "no holes were left out")

    def test_another_model_has_no_table(self):
        ops.build()
        ops.cross_validate_holes(folds=3)
        self.assertEqual(len(self.model.left_out_holes), 9)
        ops.clear()
        self.assertEqual((len(self.model.left_out_holes), self.model.hole_validation), (0, ""))

    def test_a_hole_without_which_there_is_no_surface_says_why(self):
        lines = ["hole,x,y,z,surface"]
        lines += ["A,5,5,30,Only", "B,15,15,50,Sand", "C,30,30,48,Sand", "D,5,30,49,Sand"]
        (self.folder / "picks.csv").write_text("\n".join(lines) + "\n")
        ops.new()
        ops.boreholes_read(filepath=str(self.folder / "picks.csv"))
        rock = self.model.rocks[0]
        ops.region_around()
        rock.edge_length, rock.base_elevation = 10.0, 0.0
        for row in rock.surfaces:
            row.method = "idw"
        ops.build()
        ops.cross_validate_holes()
        refused = [row for row in self.model.left_out_holes if row.refused]
        self.assertEqual([row.name for row in refused], ["A"])
        self.assertEqual(self.model.left_out_holes[0].name, "A")
        self.assertIn("no surfaces", " ".join(hole_validation.lines(refused[0])))
