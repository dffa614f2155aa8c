# SPDX-License-Identifier: GPL-3.0-or-later
"""Codes of field data: counted when they are imported, and regrouped afterward, with undo."""

import bpy
import numpy as np
from panel_case import PanelCase, ops
from realmodel.bl.project import observed_blocks

UNITS = ("Marl", "Sand", "Clay", "Silt", "Gravel", "Loam", "Fill")  # the oldest first
CODES = [f"{unit[:2].upper()}{n}" for unit in UNITS for n in range(5)][:32]


class Codes(PanelCase):
    def import_holes(self, count=6, picks=False):
        """Holes with all codes, the youngest on top; the depths of their contacts differ."""
        rng = np.random.default_rng(5)
        collars, intervals, tops = ["hole,x,y,z"], ["hole,from,to,block"], ["hole,surface,depth"]
        for n in range(count):
            collars.append(f"B{n},{100 * (n % 4)},{90 * (n // 4)},50")
            depths = np.cumsum(np.r_[0.0, rng.uniform(0.5, 2.0, len(CODES))]).round(2)
            logged = list(zip(depths[:-1], depths[1:], CODES[::-1], strict=True))
            intervals += [f"B{n},{a},{b},{c}" for a, b, c in logged]
            tops += [f"B{n},{c},{a}" for a, _, c in logged]
        names = ["collars.csv", "picks.csv" if picks else "intervals.csv"]
        for name, rows in zip(names, (collars, tops if picks else intervals), strict=True):
            (self.folder / name).write_text("\n".join(rows) + "\n")
        ops.boreholes_read(directory=str(self.folder), files=[{"name": name} for name in names])

    @property
    def rock(self):
        return self.model.rocks[0]

    def surfaces(self):
        return [row.name for row in self.rock.surfaces]

    def test_they_are_counted(self):
        self.import_holes()
        self.assertEqual({row.name for row in self.rock.codes}, set(CODES))
        row = self.rock.codes["MA0"]
        self.assertEqual((row.holes, row.rows, row.unit), (6, 6, "MA0"))
        observations = observed_blocks.of_rock(self.rock)
        ends = observations.depths[observations.blocks == "MA0"].reshape(-1, 2)
        self.assertAlmostEqual(row.length, float(np.ptp(ends, axis=1).sum()), places=3)

    def test_many_to_few_in_few_clicks(self):
        self.import_holes()
        self.assertEqual(self.surfaces(), CODES)
        for unit in UNITS:
            ops.codes_assign(pattern=f"{unit[:2]}*", unit=unit)
        self.assertEqual(self.surfaces(), list(UNITS))
        self.assertEqual({row.block for row in self.rock.surfaces}, set(UNITS))
        observations = observed_blocks.of_rock(self.rock)
        self.assertEqual(set(observations.blocks), set(UNITS))
        self.assertEqual(len(np.unique(observations.holes)), 6)

    def test_a_regular_expression_and_what_is_none(self):
        self.import_holes()
        ops.codes_assign(pattern="/^(MA|SA)[0-3]$/", unit="Old")
        self.assertEqual(
            {row.name for row in self.rock.codes if row.unit == "Old"}, set(CODES[:4] + CODES[5:9])
        )
        self.refused(ops.codes_assign, "no regular expression", pattern="/(/", unit="Old")

    def test_they_move_to_the_next_unit(self):
        self.import_holes()
        for unit in UNITS:
            ops.codes_assign(pattern=f"{unit[:2]}*", unit=unit)
        self.rock.active_code = self.rock.codes.find("MA4")
        ops.codes_move(direction="UP")
        self.assertEqual(self.rock.codes["MA4"].unit, "Sand")
        self.assertFalse(any(row.chosen for row in self.rock.codes))
        self.rock.codes["MA4"].chosen = self.rock.codes["CL0"].chosen = True
        ops.codes_move(direction="DOWN")
        self.assertEqual([self.rock.codes[code].unit for code in ("MA4", "CL0")], ["Marl", "Sand"])
        self.refused(ops.codes_move, "oldest unit", pattern="MA4", direction="DOWN")
        ops.codes_ignore(pattern="MA4")
        self.refused(ops.codes_move, "means no surface", pattern="MA4", direction="UP")

    def test_picks_take_the_place_of_their_earlier_points(self):
        self.import_holes(picks=True)
        for unit in UNITS:
            ops.codes_assign(pattern=f"{unit[:2]}*", unit=unit)
        points = sum(len(row.stored["points"]) for row in self.rock.surfaces)
        self.assertEqual(points, 6 * len(CODES))
        self.assertEqual(self.surfaces(), list(UNITS))

    def test_ticks_nothing_and_reset(self):
        self.import_holes(count=4)
        self.refused(ops.codes_ignore, "no code is chosen")
        self.refused(ops.codes_assign, "no unit is given", pattern="*")
        ops.codes_choose(pattern="MA0, FI*")
        self.assertEqual([row.name for row in self.rock.codes if row.chosen], ["FI1", "FI0", "MA0"])
        ops.codes_ignore()
        self.assertNotIn("MA0", self.surfaces())
        self.assertEqual(self.rock.codes["MA0"].unit, "")
        self.assertNotIn("MA0", observed_blocks.of_rock(self.rock).blocks)
        ops.codes_reset(pattern="MA0")
        self.assertIn("MA0", self.surfaces())
        ops.codes_ignore(pattern="*")
        self.assertEqual(self.surfaces(), [])
        self.assertIsNone(observed_blocks.of_rock(self.rock))

    def test_a_renamed_surface_stays_what_its_codes_mean(self):
        self.import_holes(count=4)
        ops.codes_assign(pattern="MA*", unit="Marl")
        self.rock.surfaces["Marl"].name = "Marlstone"
        self.assertEqual(self.rock.codes["MA3"].unit, "Marlstone")
        ops.codes_assign(pattern="SA*", unit="marlstone")
        self.assertEqual(self.rock.codes["SA0"].unit, "Marlstone")
        self.assertEqual(self.surfaces()[:2], ["Marlstone", "CL0"])

    def test_nothing_changes_where_a_file_is_refused(self):
        """Neither codes nor surfaces nor data, also where the second of two imports is refused."""
        self.import_holes(count=4)
        (self.folder / "places.csv").write_text("x,y,z,block\n1,2,30,MA0\n5,2,30,SA1\n")
        ops.boreholes_read(filepath=str(self.folder / "places.csv"))

        def state():
            rock = self.rock
            codes = [(row.name, row.unit, row.chosen, row.rows) for row in rock.codes]
            return codes, self.surfaces(), rock.imports, rock.observations.digest, rock.hole_picks.digest

        (self.folder / "places.csv").write_text("nothing\n")
        before = state()
        for operator, arguments in (
            (ops.codes_assign, {"pattern": "MA*", "unit": "Marl"}),
            (ops.codes_ignore, {"pattern": "MA*"}),
        ):
            self.refused(operator, "places.csv", **arguments)
            self.assertEqual(state(), before)

    def test_undo(self):
        self.import_holes(count=4)
        bpy.ops.ed.undo_push(message="imported")
        ops.codes_assign(pattern="MA*", unit="Marl")
        bpy.ops.ed.undo_push(message="assigned")
        bpy.ops.ed.undo()
        self.assertEqual(self.surfaces(), CODES)
        self.assertEqual(self.rock.codes["MA0"].unit, "MA0")

    def test_codes_of_any_signs(self):
        """Whatever stands in a table can be a code, also what parts names in the field Names."""
        codes = ["a;b", "c = d", "12", "ü (x)", "A*"]
        (self.folder / "collars.csv").write_text("hole\tx\ty\tz\nB\t0\t0\t9\n")
        rows = [f"B\t{n}\t{n + 1}\t{code}" for n, code in enumerate(codes)]
        (self.folder / "i.csv").write_text("\n".join(["hole\tfrom\tto\tblock", *rows]) + "\n")
        ops.boreholes_read(directory=str(self.folder), files=[{"name": "collars.csv"}, {"name": "i.csv"}])
        self.assertEqual([row.name for row in self.rock.codes], codes)
        ops.codes_choose()
        self.assertEqual(sum(row.chosen for row in self.rock.codes), 5)
        ops.codes_assign(unit="all = one; rock")
        self.assertEqual(self.surfaces(), ["all = one; rock"])
        self.assertEqual({row.unit for row in self.rock.codes}, {"all = one; rock"})
