# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects with series in Blender: built as by the core, kept in the .blend, and saved again."""

import bpy
import numpy as np
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl import series_settings
from realmodel.core import InputRefused, build, load_project
from realmodel.core.surfaces.prepare import with_arrays
from recording_layout import draw_tab

FOLDER = SAMPLES / "recumbent_fold"
PROJECT = FOLDER / "project.toml"
BEDS = ("lower_bed", "middle_bed", "upper_bed")


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

    def test_a_fold_is_made_from_scratch(self):
        ops.new()
        for name in (*BEDS, "unconformity", "ground"):
            ops.surface_add(filepath=str(FOLDER / f"{name}.csv"))
        rock = self.model.rocks[0]
        rock.active_surface = 1
        self.refused(ops.boreholes_read, "overturned", filepath=str(FOLDER / "dips.csv"))
        ops.series_add(kind="field")
        row = rock.series[0]
        self.assertEqual((row.youngest, row.oldest), ("middle_bed", "middle_bed"))
        row.youngest, row.oldest = "upper_bed", "lower_bed"
        self.assertEqual([each.series for each in rock.surfaces], ["series"] * 3 + [""] * 2)
        ops.boreholes_read(filepath=str(FOLDER / "dips.csv"))  # of the active surface's series
        self.assertIn("50 dips", draw_tab(bpy.context).labels)
        self.refused(ops.build, "has no region")
        self.assertIn("has no region", " ".join(draw_tab(bpy.context).labels))
        ops.region_around()
        self.refused(ops.build, "base_elevation")
        drawn = draw_tab(bpy.context)
        self.assertIn("has no Base Elevation", " ".join(drawn.labels))
        rock.base_elevation = -600.0
        row.resolution = 40.0
        rock.edge_length = 60.0
        ops.build()
        self.assertEqual(series_settings.refusal(rock, row), "")
        built = set(self.volumes())
        self.assertEqual(len(built), 5)
        saved = self.folder / "made.toml"
        ops.save_project(filepath=str(saved))
        given = load_project(saved).rocks[0].series[0]
        self.assertEqual((given.name, given.kind, given.resolution), ("series", "field", 40.0))

    def test_what_was_opened_is_saved_the_same(self):
        ops.open_project(filepath=str(PROJECT))
        saved = self.folder / "saved.toml"
        ops.save_project(filepath=str(saved))
        before, after = (with_arrays(load_project(path)).rocks[0] for path in (PROJECT, saved))
        for one, other in zip(before.series, after.series, strict=True):
            self.assertEqual((one.name, one.kind, one.resolution), (other.name, other.kind, other.resolution))
            np.testing.assert_array_equal(one.dips.positions, other.dips.positions)
            np.testing.assert_array_equal(one.dips.normals, other.dips.normals)
        self.assertEqual([each.series for each in before.surfaces], [each.series for each in after.surfaces])

    def test_series_are_added_removed_and_moved(self):
        ops.new()
        ops.rock_add()
        for name in "ABCDEF":
            ops.surface_add(name=name, empty=True)
        rock = self.model.rocks[0]
        rock.active_surface = 0
        ops.series_add(kind="field")
        rock.series[0].youngest = "B"
        rock.active_surface = 3
        ops.series_add(kind="sheets")
        rock.series[1].youngest = "E"
        self.assertEqual([row.name for row in rock.series], ["series", "series 2"])
        rock.series[1].name = "cover"
        self.assertEqual(self.run_of("cover"), "DE")
        ops.series_move(direction="DOWN")  # past C
        self.assertEqual(self.order(), "ABDECF")
        ops.series_move(direction="DOWN")  # past the other series
        self.assertEqual(self.order(), "DEABCF")
        self.assertEqual([row.name for row in rock.series], ["cover", "series"])
        ops.series_move(direction="UP")
        self.assertEqual(self.order(), "ABDECF")
        rock.series[1].oldest = "F"  # beyond the youngest: it alone
        self.assertEqual(self.run_of("cover"), "F")
        rock.surfaces["A"].series = "cover"
        self.assertIn("not consecutive", series_settings.refusal(rock, rock.series[1]))
        self.assertIn("not consecutive", " ".join(draw_tab(bpy.context).labels))
        rock.active_series = 1
        ops.series_remove()
        self.assertEqual([each.series for each in rock.surfaces], ["", "series", "", "", "", ""])

    def order(self):
        return "".join(row.name for row in self.model.rocks[0].surfaces)

    def run_of(self, series):
        return "".join(row.name for row in self.model.rocks[0].surfaces if row.series == series)

    def test_dips_by_hand_and_those_of_a_surface(self):
        ops.open_project(filepath=str(PROJECT))
        rock = self.model.rocks[0]
        rock.active_surface = 1
        self.scene.cursor.location = (10.0, 20.0, 30.0)
        ops.dip_add(dip=60.0, dip_direction=90.0, overturned=True)
        dips = series_settings.dips_of(rock.series[0])
        self.assertEqual(len(dips), 51)
        np.testing.assert_allclose(dips.normals[-1], (-np.sqrt(0.75), 0.0, -0.5), atol=1e-12)
        ops.series_dips_remove()
        self.assertIsNone(series_settings.dips_of(rock.series[0]))
        rock.surfaces[1].series = ""
        self.refused(ops.dip_add, "one height", dip=60.0, overturned=True)
        ops.dip_add(dip=45.0, dip_direction=90.0)
        rock.surfaces[1].series = "folded beds"
        self.refused(ops.build, "give the dips to the series")
        ops.series_take_dips()
        dips = series_settings.dips_of(rock.series[0])
        normal = dips.normals[0] / np.linalg.norm(dips.normals[0])
        np.testing.assert_allclose(normal, (np.sqrt(0.5), 0.0, np.sqrt(0.5)), atol=1e-12)
        self.assertEqual(rock.surfaces[1].dips, "")

    def test_an_edited_level_set_is_refused(self):
        ops.open_project(filepath=str(PROJECT))
        self.model.rocks[0].series[0].resolution = 100.0
        ops.build()
        item = self.model.rocks[0].surfaces[1].interface
        item.data.vertices[0].co.z += 1.0
        item.data.update()
        bpy.context.view_layer.update()
        self.refused(ops.build, "is a level set of series")

    def test_a_damaged_series_is_refused_with_its_name(self):
        ops.open_project(filepath=str(PROJECT))
        row = self.model.rocks[0].series[0]
        row.dips = "not what is stored"
        with self.assertRaises(InputRefused):
            series_settings.dips_of(row)
        self.refused(ops.build, "series 'folded beds': what the .blend keeps of it cannot be read")
        self.assertIn("cannot be read", " ".join(draw_tab(bpy.context).labels))
