# SPDX-License-Identifier: GPL-3.0-or-later
"""A project file opened in the panel and saved again says the same: nothing that it can say is lost."""

import json
import sqlite3
import struct
from pathlib import Path

import bpy
from panel_case import SAMPLES, PanelCase, ops, outline, select, sheet
from realmodel.bl.project import choices, plan_mesh, project_settings, reading_text
from realmodel.core import InputRefused, load_project
from realmodel.core.base.work import run
from realmodel.core.settings.schema import BODY, FAULT, READING, ROCK, SURFACE
from realmodel.core.structures.shapes.reading import read_structures
from realmodel.core.surfaces.prepare import read_rocks

EVERY_KEY = """
format = 1
name = "every key"
units = "ft"
crs = "EPSG:25832"
library = "library.toml"

[[rock]]
name = "first"
region = [[0, 0], [100, 0], [100, 80], [0, 80]]
holes = [[[40, 30], [50, 30], [50, 40]]]
edge_length = 9.7
mesher = "frontal"
base_elevation = -12.1
size = [{ at = "outline", length = 4.1, distance = 2.3 },
  { at = [10.1, 20], length = 2, distance = 1 },
  { at = [[60, 20], [70, 25.5]], length = 2.5, distance = 0 },
  { at = "constraints", length = 3, distance = 1 }]
constraints = ["river.geojson", [[5, 5], [30.3, 60]], [80, 60]]
boreholes = {collars="collars.csv", picks="picks.csv", intervals="log.csv", units="ft", columns={hole="BHID"}}
observations = "seen.csv"
names = { B = "Bottom", D = "distance" }

[[rock.surface]]
name = "kriged"
points = "points.csv"
columns = ["east", "north", "level"]
where = { bed = "A", year = [2019, 2020] }
separator = ";"
decimal = ","
nodata = [-999, "none"]
units = { xy = "ft", z = "m" }
method = "kriging"
neighbours = 0
octants = 2
radius = 500.5
variogram = { nugget = 0.25, structures = [{ model = "spherical", range = 33.3, sill = 4.1 },
  { model = "gaussian", range = 90, sill = 2, anisotropy = { ratio = 1.7, azimuth = 35 } }] }
anisotropy = { ratio = 2.5, azimuth = 30 }
extrapolate = "nearest"
left_out = [[13.5, 29, 6], [1e3, -7.25, 0.1]]
property = 4
block = "Bottom"

[[rock.surface]]
name = "trend"
points = "plain.csv"
dips = "dips.csv"
method = "universal_kriging"
drift = "quadratic"
variogram = { model = "exponential", range = 60.6, sill = 4.4, nugget = 0.1 }
rule = "conformable"
minimum_thickness = 0.35
true_thickness = true
tie = false
correlation = -0.3

[[rock.surface]]
name = "contours"
points = "contours.gpkg"
layer = "second"
height = "5"
where = { kind = "contour" }
units = { z = "m" }

[[rock.surface]]
name = "distance"
points = "plain.csv"
method = "idw"
power = 2.6

[[rock.surface]]
name = "smooth"
points = "plain.csv"
method = "spline"
smoothing = 0.3

[[rock.surface]]
name = "dsi"
points = "plain.csv"
method = "dsi"
weight = 3.3
border = 31
above = "smooth"
below = 90

[[rock.surface]]
name = "plane"
points = "plain.csv"
z_axis = "down"
method = "plane"
dip = 11.1
dip_direction = 200

[[rock.surface]]
name = "level"
method = "constant"
value = 44.4

[[rock.surface]]
name = "parallel"
points = "plain.csv"
method = "parallel"
to = "level"
thickness_method = "plane"

[[rock.surface]]
name = "thick"
method = "parallel"
to = "level"
thickness = 3.21
rule = "discontinuous"

[[rock.surface]]
name = "in holes only"

[[rock]]
name = "by number"
region = { file = "two.geojson", where = { unit = "b" }, units = "ft" }
triangles = 300
mesher = "grid"
map = { file = "two.geojson", block = "unit", units = "ft", ground = "low" }
names = { a = "", b = "low" }

[[rock.surface]]
name = "low"
points = "plain.csv"

[[rock]]
name = "by points"
region = "POLYGON ((400 0, 500 0, 500 80, 400 80, 400 0))"
edge_length = "auto"
base_elevation = -50

[[rock.series]]
name = "folded"
dips = "in_space.csv"
resolution = 7.5

[[rock.surface]]
name = "bed"
series = "folded"
points = "plain.csv"

[[rock.surface]]
name = "mesh"
mesh = "mesh.off"
units = "m"
rule = "base"

[[rock.surface]]
name = "top"
points = "plain.csv"
"""


FAULTS = """
[[fault]]
name = "F1"
points = "sticks.csv"
stick = "s"
extend = 2.25
z_axis = "down"
youngest = "top"
dies_out = true
rocks = ["by points"]

[[fault]]
name = "F2"
mesh = "fault.off"
units = { xy = "ft", z = "m" }
ends_at = ["F1"]

[[fault]]
name = "F3"
trace = [[450.1, 3, 2.5], [452, 33], [449, 70, 0.1]]
dip = 62.3
dip_direction = "se"
elevation = "top"
extend = 3.7
dies_out = true
rocks = ["by points"]

[[fault]]
name = "F4"
trace = "faults.geojson"
where = { NAME = "F4" }
units = "ft"
dip_direction = 250.25
elevation = -3.3

[[fault]]
name = "F5"
trace = "MULTILINESTRING Z ((440 0 1, 440 30 2), (440 35 2, 440 80 2))"
dip = 90
"""

BODIES = """
[[body]]
name = "salt"
mesh = "salt.off"
units = "m"
after = "trend"
property = 4
rock = "first"

[[body]]
name = "tunnel"
mesh = "salt.off"
void = true
"""


def write_files(folder: Path):
    (folder / "project.toml").write_text(EVERY_KEY + FAULTS + BODIES)
    sticks = [(450 + z / 9, y, z, y) for y in (0, 40, 80) for z in (-90, 0, 90)]
    (folder / "sticks.csv").write_text("x,y,z,s\n" + "".join(f"{x!r},{y},{z},{y}\n" for x, y, z, _ in sticks))
    feature = {"type": "Feature", "properties": {"NAME": "F4", "dip": 50.5, "strike": 1}}
    feature["geometry"] = {"type": "LineString", "coordinates": [[1450, 0], [1460.1, 260]]}
    (folder / "faults.geojson").write_text(json.dumps(feature))
    (folder / "fault.off").write_text("OFF\n3 1 0\n450 0 -9\n450 80 -9\n480.1 40 99\n3 0 1 2\n")
    corners = "5 5 5\n10.3 5 5\n5 10 5\n5 5 10\n"
    (folder / "salt.off").write_text(f"OFF\n4 4 0\n{corners}3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
    (folder / "library.toml").write_text(
        '[[property]]\nid = 4\nname = "Clay"\nrock = "clay"\nage = "Eocene"\nstructure = "bedded"\n'
        'color = "#102030"\ndensity = 2123.4\ndescription = "grün"\n',
        encoding="utf-8",
    )
    rows = [(i * 13 % 97, i * 29 % 79, 5 + i % 7) for i in range(40)]
    own = "\n".join(f"{x},5;{y};{z};A;{2019 + n % 3};" for n, (x, y, z) in enumerate(rows))
    (folder / "points.csv").write_text(f"east;north;level;bed;year\n{own}\n")
    plain = [(x + shift, y, 20 + z) for shift in (0, 200, 400) for x, y, z in rows]
    (folder / "plain.csv").write_text("x,y,z\n" + "\n".join(f"{x},{y},{z}" for x, y, z in plain) + "\n")
    (folder / "collars.csv").write_text("BHID,x,y,z\nB1,20,20,60\nB2,70,50,61\nB3,30,70,60.5\n")
    picks = "".join(
        f"B{n},{name},{depth + n}\n"
        for n in (1, 2, 3)
        for name, depth in (("in holes only", 8), ("trend", 30))
    )
    (folder / "picks.csv").write_text("BHID,surface,depth\n" + picks)
    log = "".join(f"B{n},{top},{bottom},{block}\n" for n in (1, 2, 3) for top, bottom, block in LOG)
    (folder / "log.csv").write_text("BHID,from,to,block\n" + log)
    (folder / "dips.csv").write_text("x,y,dip,strike\n20,20,10,0\n70,20.5,20.25,100\n")
    (folder / "in_space.csv").write_text(
        "x,y,z,dip,strike,polarity\n420,20,9,80,0,1\n470,20.5,2,20.25,100,-1\n"
    )
    (folder / "seen.csv").write_text("x,y,z,block\n20,60,55,in holes only\n60,60,2,B\n")
    (folder / "river.geojson").write_text('{"type": "LineString", "coordinates": [[90, 5], [95, 60]]}')
    squares = ",".join(
        f'{{"type": "Feature", "properties": {{"unit": "{unit}"}}, "geometry": {{"type": "Polygon", '
        f'"coordinates": [[[{x}, 0], [{x + 90}, 0], [{x + 90}, 70], [{x}, 70], [{x}, 0]]]}}}}'
        for unit, x in (("a", 700), ("b", 200))
    )
    (folder / "two.geojson").write_text(f'{{"type": "FeatureCollection", "features": [{squares}]}}')
    write_contours(folder / "contours.gpkg")
    (folder / "mesh.off").write_text("OFF\n4 2 0\n390 -5 1\n510 -5 1\n510 90 2\n390 90 2\n3 0 1 2\n3 0 2 3\n")


LOG = ((0, 8, "in holes only"), (9, 30, "smooth"), (30, 34, "D"), (35, 36, "B"))


def write_contours(path):
    """Three contour lines in the second of two layers, their heights in an attribute called 5."""
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
    for layer in ("first", "second"):
        base.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom')", (layer,))
        base.execute(f'CREATE TABLE {layer} (fid INTEGER PRIMARY KEY, geom BLOB, "5" REAL, kind TEXT)')
        for x, height in ((5.0, 3.0), (40.0, 4.5), (90.0, 5.25)):
            line = struct.pack("<BII4d", 1, 2, 2, x, 5.0, x + 3, 75.0)
            blob = b"GP" + struct.pack("<BBi", 0, 1, 0) + line
            base.execute(f"INSERT INTO {layer} VALUES (NULL, ?, ?, 'contour')", (blob, height))
    base.commit()
    base.close()


def said(project):
    """All that a project says, with arrays in the place of files, and equal where it means the same."""
    inputs = run(lambda work: read_rocks(work, project))
    rocks = [entry.rock for entry in inputs]
    faults, bodies, _ = run(lambda work: read_structures(work, project, inputs=inputs))
    return {
        "name": project.name,
        "units": project.units,
        "crs": project.crs,
        "library": [vars(entry) for entry in project.library or ()],
        "rocks": [_rock(rock) for rock in rocks],
        "structures": [_structure(entry) for entry in (*faults, *bodies)],
    }


def _structure(entry):
    shape = {key: getattr(entry, key).tolist() for key in ("vertices", "triangles")}
    keys = ("youngest", "dies_out", "ends_at", "rocks", "after", "property", "void", "rock")
    said = {key: getattr(entry, key) for key in keys if hasattr(entry, key)}
    return {"name": entry.name, **shape, **said}


def _rock(rock):
    return {
        "rings": [ring.tolist() for ring in rock.rings()] if rock.region is not None else None,
        "size": [{**entry, "at": _plain(entry["at"])} for entry in rock.size],
        "constraints": [line.tolist() for line in rock.constraints],
        "surfaces": [_surface(surface) for surface in rock.surfaces],
        "series": [_series(series) for series in rock.series],
        "observations": rock.observed
        and [array.tolist() for array in (rock.observed.places, rock.observed.blocks, rock.observed.holes)],
        **{
            key: getattr(rock, key)
            for key in ("name", "edge_length", "triangles", "mesher", "base_elevation")
        },
    }


def _series(series):
    dips = series.space_dips()
    arrays = dips and [dips.positions.tolist(), dips.normals.tolist()]
    return [series.name, series.kind, series.resolution, arrays]


def _surface(surface):
    return {
        "shape": [
            None if array is None else array.tolist()
            for array in (surface.points, surface.vertices, surface.triangles)
        ],
        "contacts": surface.contact_array().tolist(),
        "left_out": None if surface.left_out is None else [tuple(place) for place in surface.left_out],
        "dips": surface.dips and [surface.dips.positions.tolist(), surface.dips.gradients.tolist()],
        "method": surface.method_options() if surface.interpolated else None,
        **{
            key: getattr(surface, key)
            for key in (
                "name",
                "series",
                "rule",
                "property",
                "block",
                "minimum_thickness",
                "true_thickness",
                "tie",
                "correlation",
            )
        },
    }


def _plain(at):
    return (
        at
        if isinstance(at, str)
        else [list(map(float, p)) if isinstance(p, (list, tuple)) else float(p) for p in at]
    )


class RoundTrip(PanelCase):
    def opened_and_saved(self, path):
        ops.open_project(filepath=str(path))
        saved = self.folder / "saved" / "p.toml"
        saved.parent.mkdir(exist_ok=True)
        ops.save_project(filepath=str(saved))
        return load_project(saved)

    def assert_says_the_same(self, path):
        self.maxDiff = 4000
        before, after = said(load_project(path)), said(self.opened_and_saved(path))
        for one, other in zip(before["rocks"], after["rocks"], strict=True):
            for surface, again in zip(one["surfaces"], other["surfaces"], strict=True):
                self.assertEqual(again, surface)
        self.assertEqual(after, before)

    def test_examples(self):
        for path in sorted(SAMPLES.glob("*/project.toml")):
            with self.subTest(path.parent.name):
                self.assert_says_the_same(path)

    def test_every_key(self):
        self.assertEqual(
            [key for key in (*ROCK, *SURFACE) if f"\n{key} =" not in EVERY_KEY], [], "not in EVERY_KEY above"
        )
        for table, text in ((FAULT, FAULTS), (BODY, BODIES)):
            self.assertEqual([key for key in table if key not in READING and f"\n{key} =" not in text], [])
        write_files(self.folder)
        self.assert_says_the_same(self.folder / "project.toml")

    def test_the_panel_shows_what_the_file_says(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        first, number, _ = self.model.rocks
        self.assertEqual([rock.edges_by for rock in self.model.rocks], ["LENGTH", "TRIANGLES", "AUTO"])
        self.assertEqual(number.triangles, 300)
        self.assertEqual([entry.at for entry in first.sizes], ["OUTLINE", "STORED", "STORED", "CONSTRAINTS"])
        self.assertEqual(plan_mesh.stored_constraints(first), (2, 1))
        surface = first.surfaces[0]
        self.assertEqual((surface.column_x, surface.column_y, surface.column_z), ("east", "north", "level"))
        self.assertEqual(
            [(entry.column, entry.value) for entry in surface.filters],
            [("bed", "A"), ("year", "2019"), ("year", "2020")],
        )
        self.assertEqual((surface.separator, surface.decimal, surface.nodata), (";", ",", "-999, none"))
        self.assertEqual((surface.plan_unit, surface.height_unit), ("ft", "m"))
        self.assertEqual([part.model for part in surface.structures], ["spherical", "gaussian"])
        self.assertTrue(surface.structures[1].use_anisotropy)

    def test_copies_say_the_same(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        for number in range(3):
            self.model.active_rock = number
            ops.rock_copy()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        composed = project_settings.compose(self.scene, depsgraph)
        rocks = said(project_settings.read_project(composed))["rocks"]
        self.assertEqual(len(rocks), 6)
        for rock, copy in zip(rocks[:3], rocks[3:], strict=True):
            self.assertEqual({**copy, "name": rock["name"]}, rock)


class Written(PanelCase):
    """What is set in the panel reaches the build."""

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
        for given in (
            {"columns": [2, 3, "z; up"], "decimal": ","},
            {"columns": ["5", "y", "z"], "units": {"xy": "ft", "z": "ft"}},
            {"where": {"a": "60", "b": [1.5, "x, y"]}, "height": "5", "layer": "l"},
            {"separator": "\t", "nodata": -9999},
            {"separator": " ", "nodata": [-9999, "n/a", ""]},
        ):
            reading_text.fill(row, given)
            self.assertEqual(reading_text.options(row), given)

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
        contacts = {surface.name: len(surface.contact_array()) for surface in self.composed().surfaces}
        self.assertEqual([name for name, count in contacts.items() if count], ["distance"])
        next(surface for surface in rock.surfaces if surface.name == "distance").name = "moved"
        seen = self.composed().observations
        self.assertEqual(sorted(set(seen.blocks)), ["in holes only", "kriged", "moved", "smooth"])
        self.assertEqual(len(seen), 26)

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
        self.assertEqual([len(s.points) for s in self.composed().surfaces], [6, 6])
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
