# SPDX-License-Identifier: GPL-3.0-or-later
"""Problems of boreholes are listed, and the repair of each row can be refused, with undo."""

import bpy
from panel_case import PanelCase, ops
from realmodel.bl.project import observed_blocks

INTERVALS = """hole,from,to,block
B1,0,5,Sand
B1,9,5,Clay
B2,0,3,Sand
B2,3.003,8,Clay
B3,0,4,Sand
B3,4,7,Clay
"""


class HoleProblems(PanelCase):
    def setUp(self):
        super().setUp()
        (self.folder / "c.csv").write_text("hole,x,y,z\nB1,0,0,10\nB2,50,0,10\nB3,0,50,11\n")
        (self.folder / "i.csv").write_text(INTERVALS)
        ops.boreholes_read(directory=str(self.folder), files=[{"name": "c.csv"}, {"name": "i.csv"}])

    @property
    def rock(self):
        return self.model.rocks[0]

    def problems(self):
        return {(row.file, row.line): (row.kind, row.action) for row in self.rock.hole_problems}

    def depths(self, hole):
        observations = observed_blocks.of_rock(self.rock)
        return sorted(set(observations.depths[observations.holes == hole].tolist()))

    def number(self, line):
        return [row.line for row in self.rock.hole_problems].index(line)

    def test_they_are_listed(self):
        self.assertEqual(self.problems()["i.csv", 3], ("reversed", "repaired"))
        self.assertEqual([row.hole for row in self.rock.hole_problems if row.line == 3], ["B1"])
        self.assertEqual(self.depths("B1"), [0.0, 5.0, 9.0])

    def test_a_row_is_left_out_as_written_and_repaired_again(self):
        ops.hole_problem_decide(index=self.number(3), decision="LEFT_OUT")
        self.assertEqual(self.problems()["i.csv", 3], ("switched_off", "left out"))
        self.assertEqual(self.depths("B1"), [0.0, 5.0])
        ops.hole_problem_decide(index=self.number(3), decision="REPAIR")
        self.assertEqual(self.depths("B1"), [0.0, 5.0, 9.0])
        gap = next(line for (_, line), (kind, _) in self.problems().items() if kind == "gap")
        ops.hole_problem_decide(index=self.number(gap), decision="WRITTEN")
        self.assertEqual(self.problems()["i.csv", gap], ("unrepaired", "used"))
        self.assertEqual(self.depths("B2"), [0.0, 3.0, 3.003, 8.0])
        self.assertEqual([row.name for row in self.rock.surfaces], ["Clay", "Sand"])

    def test_undo(self):
        bpy.ops.ed.undo_push(message="imported")
        ops.hole_problem_decide(index=self.number(3), decision="LEFT_OUT")
        bpy.ops.ed.undo_push(message="decided")
        bpy.ops.ed.undo()
        self.assertEqual(self.depths("B1"), [0.0, 5.0, 9.0])
        self.assertEqual(self.problems()["i.csv", 3], ("reversed", "repaired"))

    def test_the_hole_is_shown(self):
        ops.hole_problem_show(index=self.number(3))
        self.assertTrue(self.model.view.show_hole_names)
        self.refused(ops.hole_problem_show, "no row of the list is active", index=99)

    def test_files_that_are_gone(self):
        (self.folder / "i.csv").unlink()
        before = self.problems()
        self.refused(ops.hole_problem_decide, "file not found", index=0, decision="LEFT_OUT")
        self.assertEqual(self.problems(), before)
