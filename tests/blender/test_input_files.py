# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of all kinds are read inside Blender, by packages that travel with the add-on; the panel keeps what
a path does not say."""

import sqlite3
import struct
import unittest

import bpy
import numpy as np
from panel_case import PanelCase, ops
from realmodel.bl.display import shown_models
from realmodel.core import BuildFailed, build, load_project
from realmodel.core.base.packages import vendored

PROJECT = """format = 1
name = "x"
[[rock]]
name = "r"
region = {region}
edge_length = 1
base_elevation = 0
constraints = [[[0.5, 0.5], [3.5, 2.5]], [3, 1]]
boreholes = {{ collars = "c.csv", picks = "p.csv" }}
[[rock.surface]]
name = "clay"
method = "plane"
[[rock.surface]]
name = "ground"
points = "dtm.tif"
units = {{ z = "ft" }}
method = "grid"
"""
MESHED = """format = 1
name = "x"
[[rock]]
name = "r"
region = [[0, 0], [4, 0], [4, 4], [0, 4]]
{keys}
size = [{{ at = [2, 2], length = 0.1, distance = 0.2 }}]
base_elevation = 0
[[rock.surface]]
name = "ground"
points = "p.xyz"
method = "plane"
"""
SQUARE = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)]


def packages():
    try:
        return [vendored(name, name, "this test") for name in ("tifffile", "shapefile")]
    except BuildFailed:
        return None


@unittest.skipIf(packages() is None, "addon/realmodel/vendor has no tifffile and pyshp")
class InputFiles(PanelCase):
    def write_inputs(self):
        tifffile, shapefile = packages()
        (self.folder / "c.csv").write_text("hole,x,y,z\nA,0,0,9\nB,4,0,9\nC,0,4,9\n")
        (self.folder / "p.csv").write_text("hole,surface,depth\nA,clay,5\nB,clay,5\nC,clay,5\n")
        place = [(33550, 12, 3, (2.0, 2.0, 0.0), True), (33922, 12, 6, (0, 0, 0, -1.0, 5.0, 0.0), True)]
        heights = np.full((3, 3), 20, np.int16)
        tifffile.imwrite(
            self.folder / "dtm.tif", heights, photometric="minisblack", extratags=place, metadata=None
        )
        with shapefile.Writer(str(self.folder / "a.shp"), shapeType=5) as writer:
            writer.field("NAME", "C", 20)
            writer.poly([list(map(list, SQUARE))])
            writer.record("Hill")
        base = sqlite3.connect(self.folder / "a.gpkg")
        base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
        base.execute("INSERT INTO gpkg_geometry_columns VALUES ('a', 'geom')")
        base.execute("CREATE TABLE a (fid INTEGER PRIMARY KEY, geom BLOB, name TEXT)")
        body = struct.pack("<BIII", 1, 3, 1, 5) + b"".join(struct.pack("<dd", *p) for p in SQUARE)
        base.execute("INSERT INTO a (geom, name) VALUES (?, 'Hill')", (b"GP\0\1" + bytes(4) + body,))
        base.commit()
        base.close()

    def test_every_kind(self):
        self.write_inputs()
        regions = (
            '"a.shp"',
            '{ file = "a.gpkg", layer = "a", where = { name = "Hill" } }',
            '"POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0))"',
        )
        for number, region in enumerate(regions):
            path = self.folder / f"p{number}.toml"
            path.write_text(PROJECT.format(region=region))
            expected = {"base block": 64.0, "ground block": 16 * (20 * 0.3048 - 4)}
            blocks = {block.name: block.volume for block in build(load_project(path)).blocks}
            self.assertEqual({name: round(v, 9) for name, v in blocks.items()}, expected)
            ops.open_project(filepath=str(path))
            ops.build()
            self.assertEqual({name: round(v, 9) for name, v in self.volumes().items()}, expected)
        for name in ("c.csv", "p.csv", "dtm.tif", "a.shp", "a.gpkg"):
            (self.folder / name).unlink()
        ops.build()
        self.assertEqual({name: round(v, 9) for name, v in self.volumes().items()}, expected)

    def test_what_the_panel_does_not_show_is_kept(self):
        """Edge lengths by density, a number of triangles and local lengths of the project file."""
        cases = (
            ('edge_length = "auto"', {}),
            ("triangles = 3000", {}),
            ("edge_length = 1", {"edge_length": 1.0}),
        )
        for number, (keys, expected) in enumerate(cases):
            path = self.folder / f"m{number}.toml"
            path.write_text(MESHED.format(keys=keys))
            (self.folder / "p.xyz").write_text("0 0 1\n4 0 1\n4 4 1\n0 4 1\n2 2 1\n")
            model = build(load_project(path))
            ops.open_project(filepath=str(path))
            ops.build()
            mine = shown_models.whole(bpy.context.scene)
            self.assertTrue(np.array_equal(mine.surface_vertices, model.surface_vertices), keys)
            for key, value in expected.items():
                self.assertEqual(getattr(self.model.rocks[0], key), value)
