# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects with series in Blender: built as by the core, kept in the .blend, and saved again."""

import shutil
import time

import bpy
import numpy as np
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl import display, overlay
from realmodel.bl.display import cuts, ensembles
from realmodel.bl.field import data, edits, handle
from realmodel.bl.jobs.estimate_job import EstimateJob
from realmodel.bl.objects import built_models, meshes
from realmodel.bl.project import series_settings, surface_dips
from realmodel.bl.scene import live
from realmodel.core import Cancelled, InputRefused, SpaceDips, build, estimate, load_project
from realmodel.core.readers import gradient_of
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

    def coarse(self):
        """The example with a field and a mesh that are built soon, in a folder of its own."""
        project = shutil.copytree(FOLDER, self.folder / "coarse") / PROJECT.name
        text = project.read_text(encoding="utf-8")
        for given, used in (("resolution = 20", "resolution = 80"), ("edge_length = 40", "edge_length = 80")):
            self.assertIn(given, text)
            text = text.replace(given, used)
        project.write_text(text, encoding="utf-8")
        return project

    def test_an_estimate_knows_the_lattice_of_a_field(self):
        project = self.coarse()
        ops.open_project(filepath=str(project))
        self.assertNotIn("nodes of lattices", draw_tab(bpy.context).labels)
        ops.estimate()
        labels = draw_tab(bpy.context).labels
        expected = estimate(load_project(project))
        self.assertIn(f"{expected.lattice_nodes:,}", labels)
        self.assertIn("memory while building columns", labels)
        self.assertEqual(len(self.model.results), 0)
        self.model.rocks[0].series[0].resolution = 100.0
        self.assertNotIn("nodes of lattices", draw_tab(bpy.context).labels)
        job = EstimateJob(self.scene, bpy.context.evaluated_depsgraph_get())
        job.start()
        job.cancel()
        self.assertRaises(Cancelled, job.finish)

    def test_a_fold_is_built_kept_and_saved(self):
        project = self.coarse()
        ops.open_project(filepath=str(project))
        ops.build()
        expected = {block.name: block.volume for block in build(load_project(project)).blocks}
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
        rock, given = (load_project(path).rocks[0] for path in (saved, project))
        self.assertEqual([each.series for each in rock.surfaces], [each.series for each in given.surfaces])
        self.assertEqual(rock.series[0].resolution, given.series[0].resolution)
        again = build(load_project(saved))
        np.testing.assert_allclose(
            [block.volume for block in again.blocks], list(expected.values()), rtol=1e-9
        )

    def test_walls_have_corners_within_for_their_bedding(self):
        """So that laminae follow the fold there: the corners of cells alone are hundreds of meters apart."""
        ops.open_project(filepath=str(self.coarse()))
        ops.build()
        for name in ("Marl", "Limestone", "Sandstone", "Shale"):
            mesh = bpy.data.objects[name].data
            self.assertFalse(mesh.validate())
            self.assertEqual(len(mesh.attributes[meshes.PREFIX + "height"].data), len(mesh.loops))
            surfaces = [each.value for each in mesh.attributes[meshes.FACE_SURFACE].data]
            at = meshes.mesh_coordinates(mesh)
            walls = [polygon for polygon, surface in zip(mesh.polygons, surfaces, strict=True) if surface < 0]
            sides = np.array([key for polygon in walls for key in polygon.edge_keys])
            self.assertLess(np.linalg.norm(at[sides[:, 0]] - at[sides[:, 1]], axis=1).max(), 2.001 * 80)
            self.assertGreater(len(walls), 100)

    def test_an_ensemble_draws_fields(self):
        ops.open_project(filepath=str(self.coarse()))
        ops.build()
        self.assertEqual(ops.ensemble(realizations=2, seed=1), {"FINISHED"})
        rows = ensembles.table(self.scene)["blocks"]
        self.assertEqual(len(rows), 5)
        self.assertTrue(all(row["percentiles"][0] < row["percentiles"][2] for row in rows))

    def test_sheets_keep_the_dips_of_their_series(self):
        random = np.random.default_rng(2)
        for name, height in (("low", 0.0), ("high", 10.0)):
            rows = [f"{x},{y},{height + 0.1 * x}" for x, y in random.uniform(0, 100, (9, 2))]
            (self.folder / f"{name}.csv").write_text("\n".join(["x,y,z", *rows]))
        (self.folder / "dips.csv").write_text(
            "x,y,dip,dip_direction,surface,block\n20,30,20,90,,\n70,60,9,270,high,\n40,80,7,270,,high\n"
        )
        project = self.folder / "sheets.toml"
        project.write_text(
            'format = 1\nname = "p"\n[[rock]]\nname = "r"\n'
            "region = [[0, 0], [100, 0], [100, 100], [0, 100]]\n"
            "edge_length = 20\nbase_elevation = -50\n"
            '[[rock.series]]\nname = "J"\nkind = "sheets"\ndips = "dips.csv"\n'
            '[[rock.surface]]\nname = "low"\npoints = "low.csv"\nseries = "J"\n'
            '[[rock.surface]]\nname = "high"\npoints = "high.csv"\nseries = "J"\n'
        )
        expected = [block.volume for block in build(load_project(project)).blocks]
        ops.open_project(filepath=str(project))
        rock = self.model.rocks[0]
        self.assertIn("3 dips", " ".join(draw_tab(bpy.context).labels))
        rock.surfaces[1].name = "top"
        dips = surface_dips.of_row(rock.series[0])
        self.assertEqual([names.tolist() for names in dips.named], [["", "top", ""], ["", "", "top"]])
        self.save_and_open()
        ops.build()
        self.assertEqual(list(self.volumes().values()), expected)
        saved = self.folder / "saved.toml"
        ops.save_project(filepath=str(saved))
        self.assertEqual([block.volume for block in build(load_project(saved)).blocks], expected)
        row = self.model.rocks[0].series[0]
        surface_dips.add(row, SpaceDips(np.zeros((1, 3)), np.array([[1.0, 0.0, 2.0]])))
        self.assertEqual(surface_dips.of_row(row).gradients[-1].tolist(), [-0.5, 0.0])

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
        needs = "needs a base elevation and a region"
        self.assertIn(needs, " ".join(draw_tab(bpy.context).labels))
        self.assertNotIn("is unbounded", " ".join(draw_tab(bpy.context).labels), "the hint says it")
        ops.region_around()
        self.refused(ops.build, "base_elevation")
        drawn = draw_tab(bpy.context)
        self.assertIn(needs, " ".join(drawn.labels))
        rock.base_elevation = -600.0
        drawn = draw_tab(bpy.context)
        self.assertNotIn(needs, " ".join(drawn.labels))
        self.assertIn("RealModelRock.base_elevation", drawn.properties)
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
        dips = surface_dips.of_row(rock.series[0])
        self.assertEqual(len(dips), 51)
        np.testing.assert_allclose(dips.normals[-1], (-np.sqrt(0.75), 0.0, -0.5), atol=1e-12)
        ops.series_dips_remove()
        self.assertIsNone(surface_dips.of_row(rock.series[0]))
        rock.surfaces[1].series = ""
        self.refused(ops.dip_add, "one height", dip=60.0, overturned=True)
        ops.dip_add(dip=45.0, dip_direction=90.0)
        rock.surfaces[1].series = "folded beds"
        self.refused(ops.build, "give the dips to the series")
        ops.series_take_dips()
        dips = surface_dips.of_row(rock.series[0])
        normal = dips.normals[0] / np.linalg.norm(dips.normals[0])
        np.testing.assert_allclose(normal, (np.sqrt(0.5), 0.0, np.sqrt(0.5)), atol=1e-12)
        self.assertFalse(rock.surfaces[1].dips)

    def test_a_dip_by_hand_is_what_was_typed(self):
        ops.new()
        ops.surface_add(name="A", empty=True)
        ops.dip_add(dip=33.3, dip_direction=12.1)
        dips = surface_dips.of_row(self.model.rocks[0].surfaces[0])
        self.assertEqual(dips.gradients.tolist(), [gradient_of(33.3, 12.1).tolist()])

    def test_sheets_take_dips_of_their_surfaces_and_of_none(self):
        ops.new()
        for name in ("A", "B"):
            ops.surface_add(name=name, empty=True)
        rock = self.model.rocks[0]
        ops.series_add(kind="sheets")
        row = rock.series[0]
        row.oldest = "A"
        table = self.folder / "dips.csv"
        table.write_text("x,y,dip,dip_direction,surface\n1,2,10,90,A\n3,4,20,90,\n")
        ops.boreholes_read(filepath=str(table), series="series")
        ops.dip_add(location=(5.0, 6.0, 7.0), dip=30.0, dip_direction=90.0)
        dips = surface_dips.of_row(row)
        self.assertEqual(dips.named[0].tolist(), ["A", "", ""])
        np.testing.assert_allclose(dips.gradients[:, 0], -np.tan(np.radians([10, 20, 30])))
        self.assertFalse(rock.dips or rock.surfaces[0].dips)
        self.refused(ops.dip_add, "one height", overturned=True)
        self.assertEqual(len(data.groups(self.scene, (data.SERIES_DIP,))[0].places), 3)

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
        row["dips"]["arrays"]["positions"] = "not what is stored"
        with self.assertRaises(InputRefused):
            surface_dips.of_row(row)
        self.refused(ops.build, "series 'folded beds': the data stored in the .blend file are damaged")
        self.assertIn("are damaged", " ".join(draw_tab(bpy.context).labels))


class FieldData(PanelCase):
    """The contacts and dips of a series, datum by datum."""

    def setUp(self):
        super().setUp()
        ops.open_project(filepath=str(PROJECT))
        self.rock = self.model.rocks[0]

    def group(self):
        (found,) = data.groups(self.scene, (data.SERIES_DIP,))
        return found

    def test_dips_are_discs_on_both_limbs(self):
        self.model.view.show_dips = True
        (item,) = [item for item in self.scene.objects if item.get("realmodel_view") == "dips"]
        self.assertEqual(len(item.data.polygons), 50 * 5)
        group = self.group()
        normals = np.array([face.normal for face in item.data.polygons])[::5]  # toward younger rock
        given = group.normals / np.linalg.norm(group.normals, axis=1)[:, None]
        np.testing.assert_allclose(normals, given, atol=1e-3)
        self.assertTrue((normals[:, 2] < 0).any() and (normals[:, 2] > 0).any())

    def test_one_is_picked_switched_off_and_moved(self):
        datum = self.group().datum(1)
        self.scene.cursor.location = datum.place
        ops.datum_pick()
        self.assertIn("dip of the series 293/18 overturned of folded beds", handle.text_of(self.scene, datum))
        ops.datum_switch()
        self.assertEqual(int((~surface_dips.of_row(self.rock.series[0]).in_use).sum()), 1)
        moved = edits.move(self.scene, handle.active(self.scene), (800.0, 150.0, -290.0))
        dips = surface_dips.of_row(self.rock.series[0])
        np.testing.assert_array_equal(dips.positions[1], (800.0, 150.0, -290.0))
        self.assertFalse(dips.in_use[1] or moved.used)
        saved = self.folder / "saved.toml"
        ops.save_project(filepath=str(saved))
        (series,) = with_arrays(load_project(saved)).rocks[0].series
        np.testing.assert_array_equal(series.dips.in_use, dips.in_use)
        ops.data_switch_on()
        self.assertTrue(surface_dips.of_row(self.rock.series[0]).in_use.all())

    def test_misfits_lead_to_dips(self):
        self.rock.series[0].resolution = 100.0
        self.rock.edge_length = 100.0
        ops.build()
        self.model.view.show_misfits = True
        rows = [row for row in self.model.misfits if row.kind == "dip"]
        self.assertGreater(len(rows), 0)
        self.assertEqual({row.name for row in rows}, {"folded beds"})
        number = next(n for n, row in enumerate(self.model.misfits) if row.kind == "dip")
        self.model.active_misfit = number
        self.assertEqual(handle.active(self.scene).kind, data.SERIES_DIP)


class FieldShown(PanelCase):
    """The field on the face of the cut, and as level sets."""

    def setUp(self):
        super().setUp()
        ops.open_project(filepath=str(PROJECT))
        rock = self.model.rocks[0]
        rock.edge_length, rock.series[0].resolution = 100.0, 120.0
        ops.build()

    def body(self, kind):
        return [item for item in self.scene.objects if item.get("realmodel_view") == kind]

    def test_on_the_cut(self):
        view = self.model.view
        view.show_field_section = True
        self.assertEqual(self.body("field section"), [])
        self.assertIn("Add a section plane", " ".join(draw_tab(bpy.context).labels))
        ops.section_plane(axis="Y")
        view.use_section = True
        (item,) = self.body("field section")
        y = [vertex.co.y for vertex in item.data.vertices]
        self.assertLess(max(y) - min(y), 1e-3)
        used = {polygon.material_index for polygon in item.data.polygons}
        self.assertGreater(len(used), 8)
        (key,) = [key for key in overlay._keys(self.scene) if key.title == "Field of folded beds"]
        self.assertEqual(tuple(key.limits), tuple(view.field_limits))
        self.assertEqual([name for name, _ in key.names], ["lower bed", "middle bed", "upper bed"])
        levels = [level for _, level in key.names]
        self.assertEqual(sorted(levels), levels)
        view.plane.location.y += 100.0
        bpy.context.view_layer.update()
        cuts.cut_now(self.scene)
        display.mode_changed(self.scene)
        (moved,) = self.body("field section")
        self.assertAlmostEqual(moved.data.vertices[0].co.y - y[0], 100.0, delta=1e-2)
        view.use_section = False
        self.assertEqual(self.body("field section"), [])

    def test_level_sets(self):
        view = self.model.view
        view.field_levels = 3
        self.assertEqual(self.body("field levels"), [])
        view.show_field_levels = True
        (item,) = self.body("field levels")
        self.assertEqual(len({polygon.material_index for polygon in item.data.polygons}), 3)
        view.field_levels = 5
        (item,) = self.body("field levels")
        self.assertEqual(len({polygon.material_index for polygon in item.data.polygons}), 5)
        low = min(vertex.co.z for vertex in item.data.vertices)
        ops.build()  # they are made anew
        (again,) = self.body("field levels")
        self.assertAlmostEqual(min(vertex.co.z for vertex in again.data.vertices), low, delta=1e-3)
        ops.clear()
        self.assertEqual(self.body("field levels"), [])
        self.assertFalse(any(key.title.startswith("Field") for key in overlay._keys(self.scene)))


class LiveField(PanelCase):
    """While something changes a coarse field follows, then the whole one."""

    def setUp(self):
        super().setUp()
        ops.open_project(filepath=str(PROJECT))
        rock = self.model.rocks[0]
        rock.edge_length, rock.series[0].resolution = 100.0, 50.0
        ops.build()
        self.model.live = True
        self.live_is_done()

    def cells(self):
        counts = built_models.current(self.scene).field("folded beds").lattice.counts
        return int(np.prod(np.array(counts) - 1))

    def step(self):
        """Until the next build is done."""
        stamp = self.model.built_stamp
        while self.model.built_stamp == stamp:
            self.assertIsNotNone(wait := live._work.look())
            time.sleep(wait)

    def move_a_contact(self, by):
        surface = self.model.rocks[0].surfaces["middle bed"].name
        (group,) = [g for g in data.groups(self.scene, (data.POINT,)) if g.names[0] == surface]
        edits.move(self.scene, group.datum(0), group.places[0] + (0.0, 0.0, by))
        live.touch(self.scene)

    def test_coarse_first_then_the_whole(self):
        whole, before = self.cells(), self.volumes()
        self.assertFalse(self.model.is_coarse)
        self.move_a_contact(20.0)
        self.step()
        self.assertTrue(self.model.is_coarse)
        self.assertLess(self.cells(), 0.5 * whole)
        self.refused(ops.report, "coarse preview", filepath=str(self.folder / "r.json"), format="JSON")
        self.move_a_contact(20.0)  # before the whole one: a coarse one comes again
        self.step()
        self.assertTrue(self.model.is_coarse)
        self.live_is_done()
        self.assertFalse(self.model.is_coarse)
        self.assertEqual(self.cells(), whole)
        self.assertNotEqual(self.volumes(), before)
        ops.report(filepath=str(self.folder / "r.json"), format="JSON")
        self.move_a_contact(-40.0)
        self.live_is_done()
        for name, volume in self.volumes().items():
            self.assertAlmostEqual(volume, before[name], delta=1e-6 * before[name])

    def test_a_level_set_is_not_edited(self):
        self.model.rocks[0].active_surface = 1
        self.refused(ops.edit_surface, "Pick Datum")

    def test_a_build_ends_it(self):
        self.move_a_contact(20.0)
        self.step()
        self.model.live = False
        self.live_is_done()
        self.assertTrue(self.model.is_coarse)
        ops.build()
        self.assertFalse(self.model.is_coarse)
