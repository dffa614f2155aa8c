# SPDX-License-Identifier: GPL-3.0-or-later
"""A project proposed in the panel: in the scene with its reasons, or nothing changes; undone in one step."""

import json
from unittest.mock import patch

import bpy
import numpy as np
from panel_case import PanelCase, ops
from realmodel.bl.project import imported, observed_blocks
from realmodel.core.readers import hole_files

UNITS = ("Chalk", "Marl", "Sand", "Clay")  # the oldest first


def write_tables(folder, exchanged=None):
    """Three tables of twelve holes, and the properties of an operator that reads them. exchanged: the hole
    in which Marl lies over Sand."""
    rng = np.random.default_rng(3)
    collars, survey, intervals = ["hole,x,y,z"], ["hole,depth,azimuth,dip"], ["hole,from,to,block"]
    for n in range(12):
        collars.append(f"B{n},{100 * (n % 4)},{90 * (n // 4)},{50 + n % 3}")
        survey += [f"B{n},0,0,-90", f"B{n},60,0,-90"]
        names = list(UNITS[::-1])
        if n == exchanged:
            names[1:3] = names[2:0:-1]
        depths = np.cumsum([0.0, *rng.uniform(6.0, 12.0, 4)]).round(2)
        intervals += [f"B{n},{a},{b},{c}" for a, b, c in zip(depths[:-1], depths[1:], names, strict=True)]
    files = {"collars.csv": collars, "intervals.csv": intervals, "survey.csv": survey}
    for name, rows in files.items():
        (folder / name).write_text("\n".join(rows) + "\n")
    return {"directory": str(folder), "files": [{"name": name} for name in files]}


class Proposals(PanelCase):
    def reasons(self, kind):
        return [row for row in self.model.proposal if row.kind == kind]

    def blocks(self):
        return [row.block for row in self.model.rocks[0].surfaces]

    def test_it_is_in_the_scene_and_builds(self):
        ops.boreholes_read(**write_tables(self.folder), propose=True)
        rock = self.model.rocks[0]
        self.assertEqual(self.blocks(), list(UNITS))
        self.assertGreater(rock.edge_length, 0.0)
        self.assertTrue(rock.use_base)
        over = {row.block: row.name for row in rock.surfaces}
        self.assertEqual({row.name: row.unit for row in rock.codes}, over)
        self.assertEqual(
            [imported.unit_text(rock, row) for row in rock.codes], [row.name for row in rock.codes]
        )
        self.assertEqual(len(self.reasons("rule")), len(UNITS) - 1)
        choices = {row.name for row in self.reasons("choice")}
        self.assertLessEqual({"Order", "Region", "Edge Length", "Ground", "Method"}, choices)
        self.assertTrue(all(row.text for row in self.model.proposal))
        ops.build()
        self.assertEqual({row.name for row in self.model.results if row.cells}, set(UNITS))

    def test_codes_mean_what_names_say(self):
        ops.boreholes_read(
            **write_tables(self.folder), propose=True, names="/^(Marl|Sand)$/ = Beds; Cl* = Clay"
        )
        self.assertEqual(self.blocks(), ["Chalk", "Beds", "Clay"])
        rock = self.model.rocks[0]
        meant = {row.name: imported.unit_text(rock, row) for row in rock.codes}
        self.assertEqual(meant, {"Chalk": "Chalk", "Marl": "Beds", "Sand": "Beds", "Clay": "Clay"})
        ops.codes_reset(pattern="Sand")
        self.assertIn("Sand", self.blocks())

    def test_tables_are_read_once(self):
        with patch.object(hole_files, "read_hole_rows", side_effect=hole_files.read_hole_rows) as read:
            ops.propose_project(**write_tables(self.folder))
        self.assertEqual(read.call_count, 1)

    def test_of_a_file_that_holds_all_tables(self):
        groups = {
            "LOCA": ["LOCA_ID,LOCA_NATE,LOCA_NATN,LOCA_GL", ",m,m,m", "ID,2DP,2DP,2DP"],
            "GEOL": ["LOCA_ID,GEOL_TOP,GEOL_BASE,GEOL_LEG", ",m,m,", "ID,2DP,2DP,PA"],
        }
        rows = {"LOCA": [], "GEOL": []}
        for n in range(6):
            rows["LOCA"].append(f"B{n},{500000 + 80 * (n % 3)},{200000 + 70 * (n // 3)},{40 + n}")
            rows["GEOL"] += [f"B{n},{10 * k},{10 * k + 10},{unit}" for k, unit in enumerate(UNITS[::-1])]
        lines = []
        for group, (names, units, types) in groups.items():
            lines += [f"GROUP,{group}", f"HEADING,{names}", f"UNIT,{units}", f"TYPE,{types}"]
            lines += [f"DATA,{row}" for row in rows[group]] + [""]
        text = "\r\n".join(
            ",".join(f'"{cell}"' for cell in line.split(",")) if line else "" for line in lines
        )
        (self.folder / "site.ags").write_text(text)
        ops.boreholes_read(filepath=str(self.folder / "site.ags"), propose=True)
        self.assertEqual(self.blocks(), list(UNITS))
        self.assertEqual({row.name for row in self.model.rocks[0].codes}, set(UNITS))
        ops.build()
        self.assertEqual({row.name for row in self.model.results if row.cells}, set(UNITS))

    def test_conflicts_have_hole_and_depth(self):
        """They come before all choices."""
        ops.propose_project(**write_tables(self.folder, exchanged=5))
        conflict = self.model.proposal[0]
        self.assertEqual((conflict.kind, conflict.hole), ("conflict", "B5"))
        self.assertGreater(float(conflict.depth), 0.0)
        self.assertIn("'Marl' lies over 'Sand'", conflict.text)
        ops.proposal_show()
        self.assertTrue(self.model.view.show_hole_names)
        self.model.active_reason = len(self.model.proposal) - 1
        self.refused(ops.proposal_show, "the row has no hole")

    def test_nothing_changes_where_it_is_refused(self):
        ops.boreholes_read(**write_tables(self.folder), propose=True)
        before = self.blocks(), len(self.model.proposal)
        (self.folder / "bad.csv").write_text("hole,from,to,block\nX,0,5,Sand\n")
        (self.folder / "dips.csv").write_text("x,y,dip,dip_direction\n0,0,5,90\n")
        for name, said in (("bad.csv", "collar|unit"), ("dips.csv", "boreholes or a map")):
            self.refused(ops.boreholes_read, said, filepath=str(self.folder / name), propose=True)
            self.assertEqual((self.blocks(), len(self.model.proposal)), before)

    def test_undo_in_one_step(self):
        bpy.ops.ed.undo_push(message="before")
        ops.boreholes_read(**write_tables(self.folder), propose=True)
        bpy.ops.ed.undo_push(message="proposed")
        bpy.ops.ed.undo()
        self.assertFalse(self.model.exists)
        self.assertEqual((len(self.model.rocks), len(self.model.proposal)), (0, 0))
        bpy.ops.ed.redo()
        self.assertEqual(self.blocks(), list(UNITS))

    def test_another_model_has_no_proposal(self):
        ops.propose_project(**write_tables(self.folder))
        ops.open_sample(sample="two_layers", build=False)
        self.assertEqual(len(self.model.proposal), 0)

    def test_codes_are_regrouped_afterward(self):
        """Units that no code means any more go, with their surfaces."""
        ops.propose_project(**write_tables(self.folder))
        ops.codes_assign(pattern="Sand", unit="Marl")
        self.assertEqual(self.blocks(), ["Chalk", "Marl", "Clay"])
        rock = self.model.rocks[0]
        observed = observed_blocks.of_rock(rock)
        self.assertEqual(set(observed.blocks), {row.name for row in rock.surfaces})
        ops.build()
        self.assertEqual(len([row for row in self.model.results if row.cells]), 3)

    def test_of_a_map_on_its_ground(self):
        """Its units, the ground as the youngest surface; without a ground it is refused."""
        shapes = []
        for number, (age, unit) in enumerate(((3, "Marl"), (2, "Sand"), (1, "Clay"))):
            west, east = 100.0 * number, 100.0 * (number + 1)
            ring = [[west, 0.0], [east, 0.0], [east, 200.0], [west, 200.0], [west, 0.0]]
            shapes.append(
                {
                    "type": "Feature",
                    "properties": {"unit": unit, "age": age},
                    "geometry": {"type": "Polygon", "coordinates": [ring]},
                }
            )
        maps = self.folder / "map.geojson"
        maps.write_text(json.dumps({"type": "FeatureCollection", "features": shapes}))
        places = [f"{x},{y},{100 - 0.1 * x}" for x in range(0, 301, 20) for y in range(0, 201, 20)]
        (self.folder / "ground.csv").write_text("\n".join(["x,y,z", *places]) + "\n")
        self.refused(ops.propose_project, "no elevations", filepath=str(maps), map_block="unit")
        self.assertFalse(self.model.exists)
        ops.propose_project(filepath=str(maps), map_block="unit", map_ground="ground.csv")
        self.assertEqual(sorted(self.blocks()), ["Clay", "Marl", "Sand"])
        self.assertEqual(self.model.rocks[0].surfaces[-1].name, "ground")
        self.assertTrue(self.model.view.show_map)
        ops.build()
