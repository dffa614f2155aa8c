# SPDX-License-Identifier: GPL-3.0-or-later
"""Rock masses, surfaces, library and results: every operator with good and bad input."""

import csv
import importlib.util
import io
import json

import bpy
import numpy as np
from blender_state import inventory, volume
from panel_case import SAMPLES, PanelCase, ops, outline, select, sheet, stack
from realmodel.bl.display import shown_models
from realmodel.bl.project import method_settings, results, surface_statistics
from realmodel.bl.scene import region_size
from realmodel.core import load_library, load_project
from realmodel.core.exporters import MODEL
from realmodel.core.project.project import ROCK, SURFACE
from realmodel.core.project.project_writer import off_text, points_text
from realmodel.core.settings.methods import METHODS, NEIGHBOURS_OF_FITTED

POINTS = np.array([(x, y, 5.0 + 0.05 * x) for x in range(0, 101, 25) for y in range(0, 101, 25)], float)
SQUARE = [(0, 0), (100, 0), (100, 100), (0, 100)]


class Rocks(PanelCase):
    def test_add_copy_remove(self):
        self.refused(ops.rock_remove, "there is no rock mass")
        self.refused(ops.rock_copy, "there is no rock mass")
        for _ in range(2):
            ops.rock_add()
        self.assertEqual([r.name for r in self.model.rocks], ["rock mass", "rock mass 2"])
        self.model.rocks[1].edge_length = 2.5
        ops.surface_add(name="S0")
        ops.rock_copy()
        copied = self.model.rocks[2]
        self.assertEqual((copied.edge_length, copied.surfaces[0].name), (2.5, "S0"))
        self.assertEqual(self.model.active_rock, 2)
        ops.rock_remove()
        self.assertEqual(len(self.model.rocks), 2)

    def test_removing_takes_its_blocks(self):
        stack(0.0, 10.0)
        ops.rock_add()
        far = [sheet("A", 0.0, at=(500.0, 0.0)), sheet("B", 4.0, at=(500.0, 0.0))]
        for item in far:
            select(item)
            ops.surface_add(use_object=True)
        ops.build()
        self.assertEqual(len(self.model.results), 2)
        ops.rock_remove()
        self.assertEqual([row.name for row in self.model.results], ["S1 block"])
        self.assertNotIn("B block", bpy.data.objects)
        self.assertIn(far[0], list(self.scene.objects))
        self.assertEqual([c.name for c in bpy.data.collections["Model"].children], ["rock mass"])

    def region_area(self, region):
        ops.rock_add()
        self.model.rocks[0].region = region
        region_size.measure(self.scene, self.model.rocks[0], bpy.context.evaluated_depsgraph_get())
        return self.model.rocks[0].region_area

    def test_region_of_a_curve_with_a_hole(self):
        hole = [(20, 20), (20, 40), (40, 40), (40, 20)]
        self.assertAlmostEqual(self.region_area(outline("r", SQUARE, hole)), 9600.0, places=2)

    def test_region_of_a_mesh_is_its_border(self):
        self.assertAlmostEqual(self.region_area(sheet("r", 3.0)), 1e4, places=2)

    def test_a_new_region_is_measured_without_the_panel(self):
        ops.rock_add()
        self.model.rocks[0].region = outline("r", SQUARE)
        self.assertTrue(bpy.app.timers.is_registered(region_size._measure_all))
        region_size._measure_all()
        self.assertAlmostEqual(self.model.rocks[0].region_area, 1e4, places=2)

    def test_a_region_of_a_scene_that_was_never_shown_is_measured(self):
        other = bpy.data.scenes.new("other")
        rocks = other.realmodel.rocks
        region = outline("r", SQUARE)
        bpy.context.collection.objects.unlink(region)
        other.collection.objects.link(region)
        for row in (rocks.add(), rocks.add()):
            row.region = region
        region_size._measure_all()
        self.assertEqual([round(row.region_area, 2) for row in rocks], [1e4, 1e4])

    def test_an_open_region_is_refused(self):
        stack(0.0, 10.0)
        self.model.rocks[0].region = outline("r", SQUARE, cyclic=False)
        before = inventory()
        self.refused(ops.build, "region object 'r'.*open.*close the curve")
        self.assertEqual(inventory(), before)

    def test_a_region_that_was_deleted(self):
        ops.open_sample(sample="two_layers", build=False)
        rock = self.model.rocks[0]
        rock.region = outline("field", [(0, 0), (100, 0), (100, 60), (0, 60)])
        ops.build()
        select(rock.region)
        bpy.ops.object.delete()  # the setting still points to it
        before = self.volumes()
        self.refused(ops.build, "object 'field' was deleted from the scene; undo that, or choose another")
        self.assertEqual(self.volumes(), before)

    def test_the_number_of_triangles_beside_the_edge_length(self):
        ops.open_sample(sample="two_layers", build=False)
        rock = self.model.rocks[0]
        for edge_length in (2.0, 4.0, 8.0):
            rock.edge_length = edge_length
            region_size.measure(self.scene, rock, bpy.context.evaluated_depsgraph_get())
            expected = region_size.expected_triangles(rock)
            ops.build()
            triangles = surface_statistics.read(rock.surfaces[0])["triangles"]
            self.assertLess(abs(expected / triangles - 1.0), 0.35, (edge_length, expected, triangles))

    def test_region_cuts_and_base(self):
        stack(0.0, 10.0)
        rock = self.model.rocks[0]
        rock.region = outline("r", [(10, 10), (60, 10), (60, 60), (10, 60)])
        rock.base_elevation = -2.0  # who gives a base wants one
        ops.build()
        self.assertEqual(self.volumes(), {"base block": 5e3, "S1 block": 25e3})
        rock.base_elevation = 15.0
        self.refused(ops.build, "base_elevation 15 is not below")


class Surfaces(PanelCase):
    def rock(self):
        return self.model.rocks[0]

    def names(self):
        return [s.name for s in self.rock().surfaces]

    def test_add_move_copy_remove(self):
        ops.rock_add()
        for operator in (ops.surface_remove, ops.surface_copy, ops.surface_move, ops.surface_hide):
            self.refused(operator, "there is no surface")
        for name in ("old", "young"):
            ops.surface_add(name=name)
        ops.surface_move(direction="DOWN")
        self.assertEqual(self.names(), ["young", "old"])
        self.assertEqual(ops.surface_move(direction="DOWN"), {"CANCELLED"})
        ops.surface_move(direction="UP")
        self.assertEqual(self.names(), ["old", "young"])
        self.rock().surfaces[1].rule = "base"
        ops.surface_copy()
        self.assertEqual(self.names(), ["old", "young", "young 2"])
        self.assertEqual(self.rock().surfaces[2].rule, "base")
        ops.surface_remove()
        self.assertEqual(self.names(), ["old", "young"])
        ops.rock_remove()
        ops.surface_add(name="first")  # makes the rock mass that is missing
        self.assertEqual(self.names(), ["first"])

    def test_shapes_whose_heights_are_chosen_later(self):
        """Contour lines know their height by an attribute, which the panel offers once they are there."""
        lines = self.folder / "lines.geojson"
        line = {"type": "LineString", "coordinates": [[0, 0], [50, 80], [100, 100]]}
        feature = {"type": "Feature", "properties": {"ELEV": 4.0}, "geometry": line}
        lines.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
        ops.surface_add(filepath=str(lines))
        self.assertEqual(self.names(), ["lines"])
        lines.write_text('{"type": "FeatureCollection", "features": [')
        self.refused(ops.surface_add, "lines.geojson", filepath=str(lines))
        self.assertEqual(self.names(), ["lines"])

    def test_every_source_gives_the_same(self):
        """The same surface from a points file, a points object, a mesh file, a mesh object and its
        modifier."""
        mesh = sheet("mesh", lambda x, y: 5.0 + 0.05 * x)
        cloud = bpy.data.objects.new("cloud", bpy.data.meshes.new("cloud"))
        cloud.data.from_pydata(POINTS.tolist(), [], [])
        self.scene.collection.objects.link(cloud)
        flat = sheet("modified", 0.0)
        bend = flat.modifiers.new("up", "DISPLACE")
        bend.direction, bend.mid_level, bend.strength = "Z", 0.0, 7.5
        (self.folder / "p.csv").write_bytes(points_text(POINTS))
        corners = [v.co[:] for v in mesh.data.vertices]
        triangles = [p.vertices[:] for p in mesh.data.polygons]
        (self.folder / "m.off").write_bytes(off_text(corners, np.array(triangles)))
        ops.surface_add(name="floor")
        self.rock().region = outline("r", SQUARE)
        self.rock().edge_length = 20.0
        floor = self.rock().surfaces[0]
        floor.source, floor.method, floor.use_value = "NONE", "constant", True
        self.assertEqual(floor.value, 0.0)
        cases = (
            ("POINTS_FILE", {"filepath": str(self.folder / "p.csv")}),
            ("POINTS_OBJECT", {"object": cloud}),
            ("MESH_FILE", {"filepath": str(self.folder / "m.off")}),
            ("MESH_OBJECT", {"object": mesh}),
            ("MESH_OBJECT", {"object": flat}),
        )
        ops.surface_add(name="top")
        for source, settings in cases:
            top = self.rock().surfaces[1]
            top.source = source
            top.method = "plane"
            for key, value in settings.items():
                setattr(top, key, value)
            ops.build()
            self.assertAlmostEqual(self.volumes()["top block"] / 75e3, 1.0, places=6, msg=source)
            self.assertEqual(top.interface["realmodel_surface"], "top")

    def test_formats_are_detected_and_files_refused(self):
        (self.folder / "p.csv").write_bytes(points_text(POINTS))
        ops.surface_add(filepath=str(self.folder / "p.csv"))
        row = self.rock().surfaces[0]
        self.assertEqual((row.name, row.source), ("p", "POINTS_FILE"))
        (self.folder / "bad.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 x 0\n3 0 1 2\n")
        before = inventory()
        self.refused(ops.surface_add, r"bad\.off:5.*3 finite", filepath=str(self.folder / "bad.off"))
        self.refused(ops.surface_add, "file not found", filepath=str(self.folder / "none.csv"))
        self.refused(ops.surface_add, "active object is no mesh", use_object=True)
        self.assertEqual((inventory(), self.names()), (before, ["p"]))

    def test_what_is_missing_is_said(self):
        self.refused(ops.build, "there is no rock mass")
        ops.rock_add()
        self.refused(ops.build, "rock 'rock mass': it has no surface")
        ops.surface_add(name="S0")
        self.refused(ops.build, "surface 'S0'.*no file with its points")
        self.rock().surfaces[0].source = "MESH_OBJECT"
        self.refused(ops.build, "surface 'S0'.*it has no object")
        empty = bpy.data.objects.new("empty", bpy.data.meshes.new("empty"))
        self.rock().surfaces[0].object = empty
        self.refused(ops.build, "object 'empty' has no faces")

    def test_a_rule_changes_the_blocks(self):
        stack(0.0, 10.0, 5.0)
        rock = self.rock()
        self.assertEqual(self.names(), ["S0", "S2", "S1"])
        ops.surface_move(direction="DOWN")  # the sheet at 10 becomes older than the one at 5
        ops.build()
        self.assertAlmostEqual(self.volumes()["S1 block"], 5e4, places=5)
        rock.surfaces[2].rule = "conformable"
        ops.build()
        self.assertAlmostEqual(self.volumes()["S1 block"], 1e5, places=5)

    def test_the_stage_follows_the_youngest_surface(self):
        stack(0.0, 10.0)
        ops.build()
        select(sheet("pit", 5.0))
        ops.surface_add(use_object=True)
        self.assertEqual(self.model.stage, 2)
        ops.build()
        self.assertEqual(self.model.stage, 2)
        self.assertAlmostEqual(volume(bpy.data.objects["S1 block"].data), 5e4, places=3)
        ops.surface_copy()
        self.assertEqual(self.model.stage, 3)
        ops.surface_remove()
        self.assertEqual(self.model.stage, 2)
        row = self.rock().surfaces.add()  # as a script does
        row.name, row.source, row.object = "late", "MESH_OBJECT", sheet("late", 20.0)
        ops.build()
        self.assertEqual(self.model.stage, 3)

    def test_a_stage_that_was_chosen_stays_when_a_surface_is_added(self):
        stack(0.0, 10.0, 20.0)
        ops.build()
        self.model.stage = 1
        select(sheet("late", 30.0))
        ops.surface_add(use_object=True)
        ops.build()
        self.assertEqual(self.model.stage, 1)
        ops.rock_remove()
        self.assertEqual(self.model.stage, 0)

    def test_hide(self):
        stack(0.0, 10.0)
        ops.build()
        self.model.display = "SURFACES"
        row = self.rock().surfaces[1]
        self.assertFalse(row.interface.hide_get())
        ops.surface_hide()
        self.assertTrue(row.interface.hide_get())

    def test_every_setting_has_its_properties(self):
        """Of a file of points and of methods, each is a property or several, and keeps what it is set to."""
        ops.surface_add(name="S0")
        row = self.rock().surfaces[0]
        examples = {"method": lambda s: list(s.words)[-1], "whole": lambda s: 3, "text": lambda s: "text"}
        examples["word"] = examples["method"]
        examples["truth"] = lambda s: not s.default
        examples["number"] = examples["length"] = lambda s: 7.25 if s.high is None else s.high - 0.25
        for settings in (ROCK, SURFACE):
            target = self.rock() if settings is ROCK else row
            for key, setting in settings.items():
                if not setting.label or setting.parts or setting.kind == "where":
                    continue
                given = examples.get(setting.kind, lambda s: "7")
                method_settings.set_value(target, key, settings, given(setting))
                found = method_settings.value(target, key, settings)
                self.assertEqual(str(found).rstrip("0."), str(given(setting)), key)
                if setting.default is None and setting.switch is not None:
                    method_settings.set_value(target, key, settings, None)
                    self.assertIsNone(method_settings.value(target, key, settings), key)

    def test_a_fitted_variogram_fills_the_fields(self):
        ops.open_sample(sample="two_layers")
        ops.build()
        row = self.rock().surfaces[1]
        found = shown_models.whole(bpy.context.scene).interpolations[1].variogram
        self.assertTrue(found.fitted)
        volumes = self.volumes()
        row.fit_variogram = False
        given = method_settings.options_of(row)
        anisotropy = given.pop("anisotropy", None)
        part = found.settings().get("structures", [found.settings()])[0]
        self.assertEqual(given["variogram"]["range"], part["range"])
        self.assertEqual(given["variogram"]["sill"], found.sill)
        self.assertEqual(anisotropy, part.get("anisotropy"))
        row.use_neighbours, row.neighbours = True, NEIGHBOURS_OF_FITTED
        ops.build()
        for name, built in self.volumes().items():
            self.assertAlmostEqual(built, volumes[name], delta=1e-6 * built)
        row.fit_variogram = True
        row.variogram_range = 1.0
        row.fit_variogram = False  # what was built last had the same variogram, but did not fit it
        self.assertEqual(row.variogram_range, 1.0)

    def test_options_there_and_back(self):
        nested = {"nugget": 0.1, "structures": [{"model": "spherical", "range": 60.3, "sill": 4.0}]}
        cases = (
            (
                "kriging",
                {
                    "neighbours": 12,
                    "octants": 2,
                    "radius": 33.3,
                    "anisotropy": {"ratio": 2.2, "azimuth": 30.0},
                },
            ),
            ("kriging", {"variogram": {"model": "gaussian", "range": 60.1, "sill": 4.4, "nugget": 0.1}}),
            ("universal_kriging", {"variogram": nested, "drift": "quadratic"}),
            ("idw", {"power": 3.3, "extrapolate": "none"}),
            ("spline", {"smoothing": 0.123456789}),
            ("dsi", {"weight": 2.0, "border": "S0", "above": -3.5}),
            ("plane", {"dip": 12.5, "dip_direction": 200.0}),
            ("constant", {"value": -7.7}),
            ("parallel", {"to": "S0", "thickness": 2.2, "thickness_method": "kriging"}),
        )
        self.assertLessEqual({method for method, _ in cases}, set(METHODS))
        ops.rock_add()
        for method, options in cases:
            row = self.rock().surfaces.add()
            method_settings.set_options(row, method, options)
            self.assertEqual(method_settings.options_of(row), options, method)

    def test_reading_of_a_points_file_is_kept(self):
        table = "well;top;east;north\n" + "".join(f"w;{z};{x};{y}\n" for x, y, z in POINTS)
        (self.folder / "p.csv").write_text(table)
        (self.folder / "p.toml").write_text(
            'format = 1\nname = "x"\nunits = "ft"\n[[rock]]\nname = "r"\n'
            "region = [[0, 0], [100, 0], [100, 100], [0, 100]]\nedge_length = 25\nbase_elevation = 0\n"
            '[[rock.surface]]\nname = "S"\npoints = "p.csv"\nmethod = "plane"\n'
            'columns = ["east", "north", "top"]\n'
        )
        load_project(self.folder / "p.toml")
        ops.open_project(filepath=str(self.folder / "p.toml"))
        self.assertEqual(self.model.units, "ft")
        ops.build()
        self.assertAlmostEqual(self.volumes()["base block"], 75e3, places=3)

    def test_another_file_is_chosen(self):
        paths = [self.folder / name for name in ("first.csv", "second.csv")]
        for path in paths:
            path.write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in POINTS))
        ops.surface_add(filepath=str(paths[0]))
        surface = self.rock().surfaces[0]
        given = {"row": surface.path_from_id(), "key": "filepath"}
        ops.file_choose(filepath=str(paths[1]), **given)
        self.assertEqual(surface.filepath, str(paths[1]))
        self.refused(ops.file_choose, "file not found", filepath=str(self.folder / "none.csv"), **given)
        self.refused(ops.file_choose, "no setting 'rocks.name'", row="rocks", key="name", none=True)
        self.save_and_open()
        surface = self.rock().surfaces[0]
        surface.filepath = "//first.csv"
        ops.file_choose(filepath=str(paths[1]), **given)  # stays relative
        self.assertEqual(surface.filepath, "//second.csv")
        ops.file_choose(none=True, **given)
        self.assertEqual(surface.filepath, "")


class Library(PanelCase):
    def without_properties(self):
        self.model.library.clear()
        for row in self.model.rocks[0].surfaces:
            row.property_id = 0

    def test_another_id_goes_to_all_that_has_the_property(self):
        stack(0.0, 10.0)
        ops.library_add(name="Sand")
        self.model.rocks[0].surfaces[1].property_id = 1
        ops.build()
        material = bpy.data.objects["S1 block"].data.materials[0]
        self.model.library[0].id = 7
        self.assertEqual(self.model.rocks[0].surfaces[1].property_id, 7)
        self.assertEqual(self.model.results[0].property_id, 7)
        self.assertEqual(material["realmodel_property"], 7)
        self.assertEqual(bpy.data.objects["S1 block"]["realmodel_property"], 7)
        ops.build()
        self.assertEqual(bpy.data.objects["S1 block"].data.materials[0], material)
        for taken in (2, 0, -1):  # another entry's, and what is no ID
            self.model.library[0].id = taken
            self.assertEqual([entry.id for entry in self.model.library], [7, 2, 3])

    def test_add_edit_remove(self):
        stack(0.0, 10.0)
        self.without_properties()
        ops.library_add(name="Sand")
        ops.library_add(name="Clay")
        self.assertEqual([(e.id, e.name) for e in self.model.library], [(1, "Sand"), (2, "Clay")])
        self.model.rocks[0].surfaces[1].property_id = 1
        ops.build()
        material = bpy.data.objects["S1 block"].data.materials[0]
        self.assertEqual((material.name, material["realmodel_property"]), ("Sand", 1))
        self.model.library[0].color = (1.0, 0.0, 0.0)
        self.assertEqual(tuple(material.diffuse_color), (1.0, 0.0, 0.0, 1.0))
        self.model.library[0].name = "Gravel"
        self.assertEqual(material.name, "Gravel")
        self.model.active_property = 0
        ops.library_remove()
        self.assertEqual([e.name for e in self.model.library], ["Clay"])
        self.assertEqual(self.model.rocks[0].surfaces[1].property_id, 0)
        ops.library_remove()
        self.refused(ops.library_remove, "the library is empty")

    def test_files_there_and_back(self):
        source = SAMPLES / "haut_barr" / "library.toml"
        ops.library_import(filepath=str(source))
        target = self.folder / "l.toml"
        ops.library_export(filepath=str(target))
        self.assertEqual(list(load_library(target)), list(load_library(source)))
        self.refused(ops.library_export, r"ends in \.toml", filepath=str(self.folder / "l.txt"))
        (self.folder / "bad.toml").write_text('[[property]]\nid = 1\nname = "x"\ncolor = "red"\n')
        count = len(self.model.library)
        self.refused(ops.library_import, r"bad\.toml:4.*red", filepath=str(self.folder / "bad.toml"))
        self.assertEqual(len(self.model.library), count)

    def test_import_merges_by_id(self):
        ops.library_add(name="mine")
        ops.library_add(name="other")
        (self.folder / "l.toml").write_text('[[property]]\nid = 2\nname = "theirs"\n')
        ops.library_import(filepath=str(self.folder / "l.toml"))
        self.assertEqual([e.name for e in self.model.library], ["mine", "theirs"])
        ops.library_import(filepath=str(self.folder / "l.toml"), replace=True)
        self.assertEqual([e.name for e in self.model.library], ["theirs"])

    def test_assign_to_selected_blocks(self):
        stack(0.0, 10.0, 20.0)
        self.without_properties()
        self.refused(ops.assign_property, "the library is empty")
        ops.library_add(name="Sand")
        ops.build()
        select()
        self.refused(ops.assign_property, "no block is selected")
        select(bpy.data.objects["S2 block"])
        ops.assign_property()
        item = bpy.data.objects["S2 block"]
        self.assertEqual((item["realmodel_property"], item.data.materials[0].name), (1, "Sand"))
        self.assertEqual([s.property_id for s in self.model.rocks[0].surfaces], [0, 0, 1])
        self.assertEqual(bpy.data.objects["S2"]["realmodel_property"], 1)
        ops.build()
        self.assertEqual(bpy.data.objects["S2 block"].data.materials[0].name, "Sand")

    def test_choosing_a_property_for_a_surface(self):
        stack(0.0, 10.0)
        ops.library_add(name="Sand")
        ops.surface_property(property_id="3")
        self.assertEqual(self.model.rocks[0].surfaces[1].property_id, 3)


class Results(PanelCase):
    def test_table_csv_and_selection(self):
        stack(0.0, 10.0, 30.0)
        for operator in (ops.copy_table, ops.clear):
            self.refused(operator, "there is no model yet")
        ops.build()
        rows = list(csv.DictReader(io.StringIO(results.as_text(self.scene))))
        self.assertEqual([row["block"] for row in rows], ["S1 block", "S2 block"])
        self.assertEqual([float(row["volume"]) for row in rows], [1e5, 2e5])
        self.assertAlmostEqual(float(rows[1]["share"]), 2 / 3)
        pasted = [line.split("\t") for line in results.as_text(self.scene, "\t").splitlines()]
        self.assertEqual([line[0] for line in pasted], ["block", "S1 block", "S2 block"])
        self.assertEqual({len(line) for line in pasted}, {len(results.CSV_HEADINGS)})
        self.model.active_result = 1
        self.assertEqual([o.name for o in self.scene.objects if o.select_get()], ["S2 block"])
        self.assertEqual(bpy.context.view_layer.objects.active.name, "S2 block")

    def test_slivers_are_counted_apart(self):
        """A sheet that looks out of the one below in the east, and at one corner of its mesh."""

        def height(x, y):
            return 10.0 if x > 50.0 else 0.05 if (x, y) == (10.0, 10.0) else -5.0

        select(sheet("low", 0.0, n=10), sheet("high", height, n=10))
        ops.from_selected()
        ops.build()
        (row,) = self.model.results
        self.assertEqual((row.components, row.slivers), (2, 1))

    def test_export_and_report(self):
        stack(0.0, 10.0)
        self.refused(ops.export, "there is no model yet", filepath=str(self.folder / "m.npz"))
        ops.build()
        ops.export(filepath=str(self.folder / "m.npz"))
        with np.load(self.folder / "m.npz") as model:
            self.assertEqual(model["block_volume"].tolist(), [1e5])
            self.assertEqual(str(model["cell_kind"]), "columns")
        ops.report(filepath=str(self.folder / "r.json"))
        report = json.loads((self.folder / "r.json").read_text())
        self.assertTrue(report["validation"]["passed"])
        ops.report(filepath=str(self.folder / "t.csv"))
        self.assertEqual((self.folder / "t.csv").read_text(), results.as_text(self.scene))
        for operator, name in ((ops.export, "m.xyz"), (ops.export, "m"), (ops.report, "r.txt")):
            self.refused(operator, "", filepath=str(self.folder / name))
        self.refused(ops.export, "no folder", filepath=str(self.folder / "none" / "m.npz"))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["m.npz", "r.json", "t.csv"])

    def test_every_format_of_models_is_exported(self):
        stack(0.0, 10.0)
        ops.build()
        for known in MODEL.formats():
            file = self.folder / f"m{known.ending}"
            if known.needs is not None and importlib.util.find_spec(known.needs[0]) is None:
                said = f"needs {known.needs[0]}, .* -m pip install {known.needs[0]}"
                self.refused(ops.export, said, filepath=str(file))
                continue
            ops.export(filepath=str(file))
            self.assertTrue(file.exists(), known.ending)
        self.assertTrue((self.folder / "m.foam" / "constant" / "polyMesh" / "owner").is_file())

    def test_export_after_opening_and_of_whole_blocks(self):
        stack(0.0, 10.0)
        self.model.cells = "BLOCKS"
        ops.build()
        self.save_and_open()
        ops.export(filepath=str(self.folder / "m.npz"))
        with np.load(self.folder / "m.npz") as model:
            self.assertEqual(str(model["cell_kind"]), "columns")

    def test_clear(self):
        items = stack(0.0, 10.0)
        ops.build()
        ops.clear()
        self.assertEqual(sorted(o.name for o in self.scene.objects), ["S0", "S1"])
        self.assertEqual(items[0]["realmodel"], "interface")
        ops.build()
        self.assertAlmostEqual(volume(bpy.data.objects["S1 block"].data), 1e5, delta=1.0)
