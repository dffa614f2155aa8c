# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of logged boreholes, observed blocks and dips, several tables at once."""

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import PanelCase, ops, outline
from realmodel.bl.project import (
    borehole_picks,
    method_settings,
    observed_blocks,
    project_settings,
    surface_dips,
)
from realmodel.bl.scene import borehole_points, data_objects
from realmodel.operators import boreholes

COLLARS = "hole,x,y,z\n" + "".join(
    f"B{n},{x},{y},60\n" for n, (x, y) in enumerate([(5, 5), (95, 5), (50, 95)])
)
SURVEY = "hole,depth,azimuth,dip\nB0,0,0,-90\nB1,0,0,-90\nB2,0,0,-90\n"
LOGS = "hole,from,to,lith\n" + "".join(
    f"B{n},0,{8 + n},Gravel\nB{n},{8 + n},20,Clay\nB{n},20,21,lost core\nB{n},21,{30 + n},Sandstone\n"
    for n in range(3)
)
OUTCROPS = "id,x,y,z,unit\n1,20,30,55,Gravel\n2,60,60,30,Sandstone\n"
DIPS = "x,y,dip,strike\n30,30,10,0\n70,30,12,10\n"
TABLES = {"collars.csv": COLLARS, "survey.csv": SURVEY, "logs.csv": LOGS}


class FieldTables(PanelCase):
    def read(self, tables, **options):
        for name, text in tables.items():
            (self.folder / name).write_text(text)
        files = [{"name": name} for name in tables]
        first = str(self.folder / next(iter(tables)))
        ops.boreholes_read(filepath=first, directory=str(self.folder), files=files, **options)

    @property
    def rock(self):
        return self.model.rocks[self.model.active_rock]

    def clouds(self):
        return {item.name: item for item in data_objects.objects(self.scene)}

    def state(self):
        """What an import changes: of the rows, and of the objects."""
        rows = [
            (
                rock.name,
                rock.observations.digest,
                rock.hole_picks.digest,
                [(s.name, s.stored.digest, s.dips.digest) for s in rock.surfaces],
            )
            for rock in self.model.rocks
        ]
        return rows, [entry.name for entry in self.model.library], sorted(o.name for o in self.scene.objects)

    def test_logs_make_a_model(self):
        self.read(TABLES)
        self.assertEqual([s.name for s in self.rock.surfaces], ["Sandstone", "Clay", "Gravel"])
        seen = observed_blocks.of_rock(self.rock)
        self.assertEqual(len(seen), 18, "the ends of nine intervals: lost core is none")
        self.assertEqual(sorted(set(seen.blocks)), ["Clay", "Gravel", "Sandstone"])
        self.assertEqual(sorted(set(seen.depths[seen.holes == "B1"])), [0, 9, 20, 21, 31])
        self.assertEqual(set(self.clouds()), {"rock mass boreholes"})
        self.assertTrue(any(item.get("realmodel_view") == "boreholes" for item in self.scene.objects))
        ops.region_around()
        self.assertEqual(self.rock.base_elevation, 21.0, "below the holes, for the sandstone")
        for surface in self.rock.surfaces:
            surface.method = "natural_neighbour"
        ops.build()
        self.assertEqual([row.name for row in self.model.results], ["Sandstone", "Clay", "Gravel"])
        self.assertTrue(all(volume > 0 for volume in self.volumes().values()))

    def test_logs_of_a_hole_without_a_collar_are_left_out(self):
        logs = LOGS.replace("B2", "B7").replace("B1,9,20,Clay", "b1,9,20,CLAY")
        self.read({**TABLES, "logs.csv": logs})
        seen = observed_blocks.of_rock(self.rock)
        self.assertEqual(set(seen.holes), {"B0", "B1"})
        self.assertEqual([s.name for s in self.rock.surfaces], ["Sandstone", "Clay", "Gravel"])
        self.assertEqual(sorted(set(seen.depths[seen.holes == "B1"])), [0, 9, 20, 21, 31])

    def test_lines_and_tubes_go_to_the_ends_of_the_holes(self):
        self.read(TABLES)
        item = self.clouds()["rock mass boreholes"]
        places = coordinates(item.data).astype(float) + np.array(item.location)
        low = places[:, 2].min() + project_settings.model_origin(self.scene)[2]
        self.assertAlmostEqual(low, 60 - 32, places=4)
        self.assertEqual(len(item.data.edges), 12, "collar 0, top, 20, 21, end of each of three holes")
        ops.region_around()
        self.rock.base_elevation = 0.0
        for surface in self.rock.surfaces:
            surface.method = "natural_neighbour"
        ops.build()
        self.model.view.show_boreholes = True
        item = next(o for o in self.scene.objects if o.get("realmodel_view") == "boreholes")
        found = coordinates(item.data).astype(float) + project_settings.model_origin(self.scene)
        self.assertAlmostEqual(found[:, 2].min(), 60 - 32, places=3)
        material = {
            name: {
                m.name for row in self.model.results if row.name == name for m in row.object.data.materials
            }
            for name in ("Gravel", "Clay", "Sandstone")
        }
        names = [item.data.materials[p.material_index].name for p in item.data.polygons]
        heights = [np.mean([found[v, 2] for v in polygon.vertices]) for polygon in item.data.polygons]
        for height, name in zip(heights, names, strict=True):
            if height > 52:
                self.assertIn(name, material["Gravel"])
            if 40 < height < 50:
                self.assertIn(name, material["Clay"])
            if height < 39:
                self.assertIn(name, material["Sandstone"])
        self.assertFalse(((np.array(heights) < 39.9) & (np.array(heights) > 39.1)).any(), "lost core")

    def test_the_dialog_says_what_the_chosen_files_are(self):
        given = {**TABLES, "outcrops.csv": OUTCROPS, "dips.csv": DIPS, "other.csv": "a,b\n1,2\n"}
        shown, contained = {}, {}
        for name, text in given.items():
            (self.folder / name).write_text(text)
            *shown[name], contained[name] = boreholes.shown_kind(self.folder / name, "")
        self.assertIn("columns do not say", shown.pop("other.csv")[0])
        self.assertIn("block\u00a0=\u00a0lith", contained["logs.csv"][0])
        self.assertEqual(contained["logs.csv"][1], "codes Clay, Gravel, Sandstone, lost core")
        kinds = ["collars", "survey", "intervals", "observations", "dips"]
        self.assertEqual(shown, {name: [kind, "CHECKMARK"] for name, kind in zip(shown, kinds, strict=True)})
        named = "hole = a; depth = b; azimuth = b"
        self.assertEqual(boreholes.shown_kind(self.folder / "other.csv", named)[0], "survey")

    def test_a_hole_that_is_read_again_replaces_its_intervals(self):
        self.read(TABLES)
        self.read(TABLES)
        self.assertEqual(len(observed_blocks.of_rock(self.rock)), 18)
        self.assertEqual(len(self.rock.surfaces), 3)

    def test_names_translate_codes_and_unknown_ones_are_said(self):
        self.read(TABLES)
        before = observed_blocks.of_rock(self.rock)
        coded = {**TABLES, "logs.csv": LOGS.replace("Clay", "CLY").replace("Gravel", "QAL")}
        self.read(coded, names="CLY = Clay; QAL =", add_surfaces=False)
        seen = observed_blocks.of_rock(self.rock)
        self.assertEqual(len(seen), 12, "QAL says nothing")
        self.assertEqual(sorted(set(seen.blocks)), ["Clay", "Sandstone"])
        self.read(coded, names="CLY = Clay", add_surfaces=False)
        self.assertEqual(len(observed_blocks.of_rock(self.rock)), 12, "QAL is no block")
        self.assertEqual(len(self.rock.surfaces), 3)
        self.read(TABLES)
        self.assertEqual(len(observed_blocks.of_rock(self.rock)), len(before))

    def test_outcrops_and_dips(self):
        self.read(TABLES)
        self.rock.active_surface = self.rock.surfaces.find("Clay")
        self.read({"outcrops.csv": OUTCROPS, "dips.csv": DIPS})
        self.assertEqual(len(observed_blocks.of_rock(self.rock)), 20)
        self.assertEqual(len(self.clouds()["rock mass observations"].data.vertices), 2)
        dips = surface_dips.of_row(self.rock.surfaces["Clay"])
        self.assertEqual(len(dips), 2)
        # a strike to the north dips to the east, where the surface falls
        self.assertAlmostEqual(dips.gradients[0, 0], -np.tan(np.radians(10)), places=12)
        self.assertAlmostEqual(dips.gradients[0, 1], 0.0, places=12)
        self.read({"outcrops.csv": OUTCROPS})
        self.assertEqual(len(observed_blocks.of_rock(self.rock)), 20, "the same places")

    def test_dips_that_name_surfaces_are_of_the_rock_mass(self):
        self.read(TABLES)
        named = "x,y,z,dip,strike,unit\n20,20,50,10,0,Clay\n60,60,40,12,0,Sandstone\n70,20,40,12,0,\n"
        self.read({"dips.csv": named})
        self.assertFalse(any(surface.dips for surface in self.rock.surfaces))
        dips = surface_dips.of_row(self.rock)
        self.assertEqual(dips.blocks.tolist(), ["Clay", "Sandstone", ""])
        self.rock.surfaces["Clay"].name = "Loam"
        self.assertEqual(surface_dips.of_row(self.rock).blocks.tolist(), ["Loam", "Sandstone", ""])
        self.rock.region, self.rock.base_elevation = (
            outline("r", [(0, 0), (100, 0), (100, 100), (0, 100)]),
            -200.0,
        )
        for surface in self.rock.surfaces:
            surface.rule = "conformable"
        ops.build()
        ops.save_project(filepath=str(self.folder / "p.toml"))
        self.assertIn("rock_mass_dips.csv", (self.folder / "p.toml").read_text())
        surface = self.rock.surfaces["Loam"]
        self.assertEqual(method_settings.dips_unused(surface), [])
        surface.method = "tin"
        self.assertIn("have no effect on 'Loam'", method_settings.dips_unused(surface)[0])
        ops.rock_dips_remove()
        self.assertEqual(method_settings.dips_unused(surface), [])
        self.refused(ops.rock_dips_remove, "has no dips")

    def test_dips_can_be_removed_where_the_method_does_not_use_them(self):
        self.read(TABLES)
        self.rock.region, self.rock.base_elevation = (
            outline("r", [(0, 0), (100, 0), (100, 100), (0, 100)]),
            0.0,
        )
        self.read({"dips.csv": DIPS})
        for surface in self.rock.surfaces:
            surface.method = "natural_neighbour"
            said = method_settings.dips_unused(surface)
            self.assertEqual(bool(said), bool(surface.dips), "said before a build refuses it")
        self.refused(ops.build, "does not use dips")
        ops.dips_remove()
        self.refused(ops.dips_remove, "has no dips")
        ops.build()
        self.assertEqual(len(self.model.results), 3)

    def test_picks_that_are_switched_off(self):
        picks = (
            "hole,x,y,z,surface,depth,use\nP0,5,5,60,Clay,12,0\nP1,95,5,60,Clay,13,1\nP2,50,95,60,Clay,14,1\n"
        )
        self.read({"picks.csv": picks}, add_surfaces=True)
        (row,) = self.rock.surfaces
        self.assertEqual(borehole_points.left_out(row).tolist(), [[5, 5, 48]])
        self.assertEqual(borehole_points.own_points(self.scene, row)[:, 2].tolist(), [47, 46])

    def test_observations_can_be_removed(self):
        self.read(TABLES)
        picks = "hole,x,y,z,surface,depth\nP1,50,50,60,Clay,12\n"
        self.read({"picks.csv": picks})
        self.assertEqual(set(borehole_picks.of_rock(self.rock)), {"B0", "B1", "B2", "P1"})
        ops.observations_remove()
        self.assertEqual(set(borehole_picks.of_rock(self.rock)), {"P1"})
        self.assertIsNone(observed_blocks.of_rock(self.rock))
        self.assertEqual(set(self.clouds()), {"rock mass boreholes", "Clay points"})
        self.refused(ops.observations_remove, "no observations")

    def test_refused_tables_leave_the_scene_as_it_was(self):
        empty = self.state()
        self.refused(self.read, "no surface that the dips", tables={**TABLES, "dips.csv": DIPS})
        self.refused(
            self.read, "no hole of it has a collar", tables={**TABLES, "logs.csv": LOGS.replace("B", "C")}
        )
        self.refused(self.read, "both have collars", tables={**TABLES, "more.csv": COLLARS})
        self.refused(self.read, "columns do not say", tables={"other.csv": "a,b\n1,2\n"})
        self.refused(self.read, "neither picks nor intervals", tables={"collars.csv": COLLARS})
        self.assertEqual(self.state(), empty)
        self.read(TABLES)
        there = self.state()
        bad = DIPS.replace("12", "95")
        self.refused(self.read, "overturned", tables={"outcrops.csv": OUTCROPS, "bad.csv": bad})
        self.assertEqual(self.state(), there)
        self.rock.surfaces[-1].source, self.rock.surfaces[-1].filepath = "MESH_FILE", "none.off"
        there = self.state()
        self.refused(self.read, "takes no dips", tables={"outcrops.csv": OUTCROPS, "dips.csv": DIPS})
        self.assertEqual(self.state(), there)

    def test_an_import_can_be_undone(self):
        self.read(TABLES)
        if not bpy.ops.ed.undo_push.poll():
            self.skipTest("no undo in this Blender")
        bpy.ops.ed.undo_push(message="before")
        before = self.state()
        self.read({"outcrops.csv": OUTCROPS, "dips.csv": DIPS})
        bpy.ops.ed.undo_push(message="after")
        self.assertNotEqual(self.state(), before)
        bpy.ops.ed.undo()
        self.assertEqual(self.state(), before)

    def test_what_was_read_is_kept_and_saved_with_the_project(self):
        self.read(TABLES)
        self.read({"outcrops.csv": OUTCROPS, "dips.csv": DIPS})
        ops.region_around()
        before = self.state()
        self.save_and_open()
        self.assertEqual(self.state(), before)
        ops.save_project(filepath=str(self.folder / "p.toml"))
        text = (self.folder / "p.toml").read_text()
        self.assertIn("observations = ", text)
        self.assertIn("dips = ", text)
