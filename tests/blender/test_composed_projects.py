# SPDX-License-Identifier: GPL-3.0-or-later
"""What is set in the panel reaches the build."""

import bpy
from every_key import write_files
from panel_case import PanelCase, ops, outline, select, sheet
from realmodel.bl.project import choices, method_settings, project_settings
from realmodel.core import InputRefused, PointFile


class Written(PanelCase):
    def composed(self):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return project_settings.compose(self.scene, depsgraph).project.rocks[0]

    def test_how_a_file_is_read(self):
        (self.folder / "p.csv").write_text("a|b|c|bed\n1|2|3|x\n4|5|-9|x\n6|7|8|y\n")
        ops.rock_add()
        ops.surface_add(filepath=str(self.folder / "p.csv"))
        row = self.model.rocks[0].surfaces[0]
        row.column_x, row.column_y, row.column_z, row.separator, row.nodata = "a", "b", "c", "|", "-9"
        row.height_unit, row.decimal = "ft", "."
        ops.filter_add()
        row.filters[0].column, row.filters[0].value = "bed", "x"
        given = self.composed().surfaces[0].points
        self.assertEqual(
            (list(given.columns), given.where, given.separator, given.nodata, given.units, given.decimal),
            (["a", "b", "c"], {"bed": "x"}, "|", -9, {"z": "ft"}, "."),
        )
        ops.filter_remove(index=0)
        self.refused(ops.filter_remove, "no filter 0", index=0)
        row.nodata = ""
        row.height_unit = "NONE"
        given = self.composed().surfaces[0].points
        self.assertEqual((given.where, given.nodata, given.units), ({}, (), None))
        row.column_y = ""
        with self.assertRaisesRegex(InputRefused, "only some of its columns"):
            self.composed()

    def test_how_a_file_is_read_comes_back_as_it_was(self):
        ops.rock_add()
        ops.surface_add(empty=True)
        row = self.model.rocks[0].surfaces[0]
        for options in (
            {"columns": [2, 3, "z; up"], "decimal": ","},
            {"columns": ["5", "y", "z"], "units": {"xy": "ft", "z": "ft"}},
            {"where": {"a": "60", "b": [1.5, "x, y"]}, "height": "5", "layer": "l"},
            {"separator": "\t", "nodata": -9999},
            {"separator": " ", "nodata": [-9999, "n/a", ""]},
        ):
            file = PointFile("points.csv", **options)
            method_settings.fill_reading(row, file)
            self.assertEqual(method_settings.point_file(row, "points.csv"), file)

    def test_names_are_offered(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        rock = self.model.rocks[0]
        kriged, contours = rock.surfaces[0], rock.surfaces[2]
        self.assertEqual(choices.columns(kriged, bpy.context, ""), ["east", "north", "level", "bed", "year"])
        self.assertEqual(choices.values(kriged.filters[1], bpy.context, ""), ["2019", "2020", "2021"])
        self.assertEqual(choices.columns(contours, bpy.context, ""), ["fid", '"5"', "kind"])
        self.assertEqual(choices.values(contours.filters[0], bpy.context, ""), ["contour"])
        self.assertEqual(choices.layers(contours, bpy.context, ""), ["first", "second"])
        others = [surface.name for surface in rock.surfaces if surface.name != "dsi"]
        self.assertEqual(choices.surfaces(rock.surfaces[5], bpy.context, ""), others)
        kriged.filepath = str(self.folder / "none.csv")
        self.assertEqual(choices.columns(kriged, bpy.context, ""), [])

    def test_smaller_triangles_and_constraints(self):
        ops.open_sample(sample="two_layers", build=False)
        rock = self.model.rocks[0]
        river = outline("river", [(10, 10), (50, 30), (90, 20)], cyclic=False)
        select(river)
        ops.constraint_add()
        ops.size_add()
        rock.sizes[0].length, rock.sizes[0].distance = 1.0, 3.0
        (self.folder / "well.wkt").write_text("POINT (20 50)")
        ops.constraint_read(filepath=str(self.folder / "well.wkt"))
        given = self.composed()
        self.assertEqual([len(line) for line in given.constraints], [1, 2, 2])
        self.assertEqual([entry["length"] for entry in given.size], [1.0, 1.0])
        ops.build()
        finer = len(rock.surfaces[0].interface.data.polygons)
        ops.size_remove(index=0)
        ops.constraint_remove(index=0)
        ops.constraint_remove(index=-1)
        ops.build()
        self.assertGreater(finer, 1.5 * len(rock.surfaces[0].interface.data.polygons))
        self.refused(ops.size_remove, "no entry 0", index=0)
        self.refused(ops.constraint_remove, "no constraint 3", index=3)
        select()
        self.refused(ops.constraint_add, "no lines")
        self.refused(ops.constraint_read, "file not found", filepath=str(self.folder / "none.wkt"))

    def test_triangles_by_number_and_by_points(self):
        ops.open_sample(sample="two_layers", build=False)
        rock = self.model.rocks[0]
        rock.edges_by = "TRIANGLES"
        rock.triangles = 500
        ops.build()
        self.assertAlmostEqual(len(rock.surfaces[0].interface.data.polygons), 500, delta=50)
        rock.edges_by = "AUTO"
        self.assertEqual((self.composed().edge_length, self.composed().triangles), ("auto", None))
        rock.edge_length = 7.0  # as a script sets it
        self.assertEqual((rock.edges_by, self.composed().edge_length), ("LENGTH", 7.0))

    def test_observations_follow_the_names_of_surfaces(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        rock = self.model.rocks[0]
        self.assertIn("distance", self.composed().observations.blocks)
        next(surface for surface in rock.surfaces if surface.name == "distance").name = "moved"
        seen = self.composed().observations
        self.assertEqual(sorted(set(seen.blocks)), ["in holes only", "kriged", "lens", "moved", "smooth"])
        self.assertEqual(len(seen), 32)

    def test_a_map_becomes_observations(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        seen = project_settings.compose(self.scene, depsgraph).project.rocks[1].observed
        self.assertEqual(set(seen.blocks), {"low"})
        self.assertGreater(len(seen), 50)

    def test_boreholes(self):
        write_files(self.folder)
        ops.rock_add()
        rock = self.model.rocks[0]
        rock.region, rock.edge_length = outline("region", [(0, 0), (100, 0), (100, 80), (0, 80)]), 10.0
        ops.boreholes_read(
            filepath=str(self.folder / "picks.csv"), collars="collars.csv", columns="hole = BHID"
        )
        self.assertEqual([s.name for s in rock.surfaces], ["trend", "in holes only"])
        ops.boreholes_read(
            filepath=str(self.folder / "picks.csv"), collars="collars.csv", columns="hole = BHID"
        )
        self.assertEqual([len(s.points) for s in self.composed().surfaces], [3, 3])  # in their place
        for surface in rock.surfaces:
            surface.method = "plane"
        ops.build()
        self.assertEqual([row.name for row in self.model.results], ["in holes only block"])
        # half of what one goes along a hole that dips by 30 degrees is down
        (self.folder / "survey.csv").write_text(
            "BHID,depth,azimuth,dip\nB1,0,90,-30\nB2,0,90,-30\nB3,0,90,-30\n"
        )
        ops.boreholes_read(
            filepath=str(self.folder / "picks.csv"),
            collars="collars.csv",
            survey="survey.csv",
            downward_dip="NEGATIVE",
            columns="hole = BHID",
        )
        points = next(s.points for s in self.composed().surfaces if s.name == "trend")[-3:]
        for got, (x, y, z), depth in zip(
            points, [(20, 20, 60), (70, 50, 61), (30, 70, 60.5)], (31, 32, 33), strict=True
        ):
            for number, expected in zip(got, (x + depth * 0.75**0.5, y, z - depth / 2), strict=True):
                self.assertAlmostEqual(number, expected, places=9)
        self.refused(
            ops.boreholes_read, "columns", filepath=str(self.folder / "picks.csv"), columns="bore = X"
        )
        self.refused(ops.boreholes_read, "file not found", filepath=str(self.folder / "none.csv"))

    def test_nested_variograms(self):
        ops.open_sample(sample="two_layers", build=False)
        rock = self.model.rocks[0]
        row = rock.surfaces[rock.active_surface]
        row.variogram_range, row.variogram_sill, row.variogram_nugget = 50.0, 5.0, 1.0
        ops.structure_add()
        ops.structure_add()
        given = self.composed().surfaces[rock.active_surface].options["variogram"]
        self.assertEqual(
            given,
            {
                "nugget": 1.0,
                "structures": [
                    {"model": "spherical", "range": 50.0, "sill": 4.0},
                    {"model": "spherical", "range": 100.0, "sill": 4.0},
                ],
            },
        )
        ops.build()
        ops.structure_remove(index=1)
        ops.structure_remove(index=0)
        self.assertEqual(row.variogram_range, 50.0)
        self.refused(ops.structure_remove, "no structure 0", index=0)

    def test_a_sheet_has_no_mesh_to_be_shaped(self):
        sheet("a", 1.0)
        sheet("b", 2.0)
        select(bpy.data.objects["a"], bpy.data.objects["b"])
        ops.from_selected()
        ops.size_add()
        self.assertEqual(self.composed().size, [])
