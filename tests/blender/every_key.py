# SPDX-License-Identifier: GPL-3.0-or-later
"""A project file with every key that there is, and the files that it names."""

import json
import sqlite3
import struct
from pathlib import Path

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
boreholes = {collars="collars.csv", picks="picks.csv", intervals="log.csv", units="ft",\
  columns={hole="BHID"}, logs=["b.las"]}
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
observed = true
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
terrain = "top"

[[rock.series]]
name = "folded"
dips = "in_space.csv"
resolution = 7.5
thickness = "parallel"
error = 0.5
dip_error = 3.0
range = 900.0

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

[[fault]]
name = "F6"
points = "scattered.csv"
dips = "of_fault.csv"
extend = 4.4
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
name = "lens"
reach = 3.75
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
    scattered = "".join(f"{400 + y},{y},{y * y % 7}\n" for y in range(0, 90, 10))
    (folder / "scattered.csv").write_text("x,y,z\n" + scattered)
    (folder / "of_fault.csv").write_text("x,y,z,dip,strike,polarity\n440,40,1,70.5,45,1\n470,70,2,61,44,1\n")
    feature = {"type": "Feature", "properties": {"NAME": "F4", "dip": 50.5, "strike": 1}}
    feature["geometry"] = {"type": "LineString", "coordinates": [[1450, 0], [1460.1, 260]]}
    (folder / "faults.geojson").write_text(json.dumps(feature))
    (folder / "fault.off").write_text("OFF\n3 1 0\n450 0 -9\n450 80 -9\n480.1 40 99\n3 0 1 2\n")
    corners = "5 5 5\n10.3 5 5\n5 10 5\n5 5 10\n"
    (folder / "salt.off").write_text(f"OFF\n4 4 0\n{corners}3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
    (folder / "library.toml").write_text(
        '[[property]]\nid = 4\nname = "Clay"\nrock = "clay"\nage = "Eocene"\nstructure = "bedded"\n'
        'color = "#102030"\ndensity = 2123.4\ndescription = "grün"\nporosity = 0.25\npermeability = 120.5\n',
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
    (folder / "b.las").write_text(
        "~V\n VERS. 2.0 :\n WRAP. NO :\n~W\n NULL. -999.25 :\n WELL. b1 :\n~C\n DEPT.FT :\n GR.GAPI :\n~A\n"
        "0 50\n10 60\n20 70\n"
    )
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
    (folder / "mesh.off").write_text("OFF\n4 2 0\n118 -2 1\n156 -2 1\n156 28 2\n118 28 2\n3 0 1 2\n3 0 2 3\n")


LOG = ((0, 8, "in holes only"), (9, 30, "smooth"), (30, 34, "D"), (34, 34.5, "lens"), (35, 36, "B"))


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
