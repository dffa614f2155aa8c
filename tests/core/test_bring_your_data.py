# SPDX-License-Identifier: GPL-3.0-or-later
"""Each row of the guide "Bring your data" on small files as that program writes them."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from large_files import FORMATS, write_points
from realmodel.core import (
    InputRefused,
    PointFile,
    build,
    from_gempy,
    from_loop,
    read_boreholes,
    read_mesh,
    read_points,
)
from realmodel.core.readers.fault_input import read_fault_points
from test_damaged_files import LEAPFROG, STICKS
from test_grid_formats import GRIDS, by_height, expected
from test_hole_files import LAS3, ags3, ags4, diggs, well_tops
from test_mesh_dialects import CONTOUR, DTM, GOCAD, SPOT, STRINGS, datamine, drawing
from test_mesh_dialects import WELL as GOCAD_WELL
from test_named_objects import dxf, glb, landxml, obj, stl
from test_peer_projects import BOUNDS, BOX, layer_cake, loop_beds
from test_peer_projects import write as write_rows
from test_point_formats import CPS3_LINES, EARTHVISION, OPENWORKS, PETREL, SHEET, workbook

ROOT = Path(__file__).resolve().parents[2]
SQUARE = np.array([[0.0, 0, 5], [8, 0, 6], [0, 8, 7], [8, 8, 8]]), np.array([[0, 1, 2], [1, 3, 2]])
CAKE = {"basement": 160_000_000, "shale": 160_000_000, "sand": 160_000_000}
TWO = {"Top A": SQUARE, "Top B": (SQUARE[0] - [0, 0, 4], SQUARE[1])}


def assert_meshes(path, parts=TWO):
    for name, (vertices, triangles) in parts.items():
        mesh = read_mesh(path, layer=name)
        np.testing.assert_allclose(mesh.vertices[mesh.triangles], vertices[triangles])


def assert_holes(write, collars, intervals, survey=None):
    """Two holes, 40 deep, of which one is logged from 0 to 10 and to 25; H2 goes down to the east by 60."""
    tables = {"collars": write("collar.csv", collars), "intervals": write("geology.csv", intervals)}
    if survey:
        tables["survey"] = write("survey.csv", survey)
    holes = read_boreholes(**tables)
    assert holes.collars["hole"].tolist() == ["H1", "H2"]
    assert [holes.collars[axis].tolist() for axis in "xyz"] == [[5000, 5100], [9000, 9000], [120, 121.5]]
    assert holes.collars["end"].tolist() == [40, 40]
    assert holes.intervals["from"].tolist() == [0, 10] and holes.intervals["to"].tolist() == [10, 25]
    assert holes.intervals["block"].tolist() == ["CLAY", "SAND"]
    if survey:
        assert holes.survey["azimuth"].tolist() == [90] and abs(holes.survey["dip"]).tolist() == [60]


def rows(*lines):
    return "".join(line + "\n" for line in lines)


def leapfrog(write):
    mesh = read_mesh(write("top.msh", LEAPFROG))
    assert mesh.vertices[3].tolist() == [9, 10, 11] and mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert_meshes(write("m.dxf", dxf(TWO)))
    assert_holes(
        write,
        rows(
            "LocationID,Easting,Northing,GroundLevel,FinalDepth",
            "H1,5000,9000,120,40",
            "H2,5100,9000,121.5,40",
        ),
        rows("HoleId,From,To,Simple_Lith", "H1,0,10,CLAY", "H1,10,25,SAND"),
        rows("HoleId,Depth,Dip,Azimuth", "H2,0,60,90"),
    )


def petrel(write):
    for name in ("zmap.dat", "irap.gri"):
        read = read_points(GRIDS / name)
        assert by_height(read.xyz) == pytest.approx(expected(30.0 if name == "irap.gri" else 0.0), rel=1e-7)
    read = read_points(write("p.txt", PETREL.format(plan="m", height="ft")))
    np.testing.assert_allclose(read.xyz[:, 2], np.array([-2345.6, -2340.6, -2335.6]) * 0.3048)
    assert read.columns["Name"].tolist() == ["Well 1", "B", "B"]
    picks = read_boreholes(write("tops.txt", well_tops())).picks
    np.testing.assert_allclose(picks["elevation"], [-25, -10] * 5)
    sticks, _ = read_fault_points(PointFile(write("f.pol", STICKS)))
    assert [stick[:, 2].tolist() for stick in sticks] == [[3, 5.5], [6, 7]]
    assert read_points(write("f.cps", CPS3_LINES)).xyz[1].tolist() == [451334.5, 6782345, -2340.6]


def rms(write):
    read = read_points(
        write("p.rmsattr", "Discrete Zone\nFloat Phi\n1.5 2.5 -1600 3 0.25\n2.5 2.5 -1601 4 UNDEF\n")
    )
    assert read.xyz.tolist() == [[1.5, 2.5, -1600], [2.5, 2.5, -1601]]
    assert read.columns["Zone"].tolist() == [3, 4]
    assert read_points(write("s.dat", EARTHVISION.format(unit="meters"))).xyz[1, 2] == -1598.5
    assert len(read_points(GRIDS / "irap_binary.gri").xyz) == 11


def charisma_geosoft_and_gslib(write):
    for text in (
        "INLINE :  100 XLINE :  7   1.0  2.0  3.5\nINLINE :  101 XLINE :  8   4.0  5.0  6.5\n",
        "INLINE-  100 XLINE-  7   1.0  2.0  3.5\nINLINE-  101 XLINE-  8   4.0  5.0  6.5\n",
        "INLINE-100 CROSSLINE-7   1.0  2.0  3.5 8\nINLINE-101 CROSSLINE-8   4.0  5.0  6.5 9\n",
        "/ X Y Z\nLine 10\n 1.0 2.0 3.5\nTie 20\n 4.0 5.0 6.5\n",
        "Top of the sand\n3\nX\nY\nElevation\n 1.0 2.0 3.5\n 4.0 5.0 6.5\n",
    ):
        assert read_points(write("h.txt", text)).xyz.tolist() == [[1, 2, 3.5], [4, 5, 6.5]]


def openworks(write):
    read = read_points(write("h.dat", OPENWORKS))
    assert read.xyz.tolist() == [[536881.63, 6729209.97, -1.0], [536891.05, 6729218.18, -1.5]]
    assert read.columns["J"].tolist() == [1160, 1161]


def gocad(write):
    path = write("m.ts", GOCAD)
    read = read_points(path, layer="tops")
    np.testing.assert_allclose(read.xyz, [[10, 20, -304.8], [11, 20, -609.6]])
    assert read.columns["age"][0] == 5
    assert read_points(path, layer="a fault").xyz.tolist() == [[0, 0, 1], [1, 0, 2], [5, 0, 1]]
    assert read_mesh(path).vertices.tolist() == [[0, 0, 1], [1, 0, 2], [0, 1, 3]]
    np.testing.assert_allclose(read_boreholes(write("w.wl", GOCAD_WELL)).picks["elevation"], [30, -30])
    with pytest.raises(InputRefused, match="GOCAD SGrid"):
        read_mesh(write("g.sg", "GOCAD SGrid 1\nHEADER {\nname:g\n}\nEND\n"))


def surpac(write):
    strings, mesh = write("top.str", STRINGS), read_mesh(write("top.dtm", DTM))
    assert mesh.vertices.tolist() == [[10, 100, 5], [20, 100, 6], [10, 110, 7], [20, 110, 8]]
    assert read_points(strings, layer="1").xyz.tolist() == [[10, 100, 5], [20, 100, 6]]
    assert_holes(
        write,
        rows("hole_id,y,x,z,max_depth", "H1,9000,5000,120,40", "H2,9000,5100,121.5,40"),
        rows("hole_id,samp_id,depth_from,depth_to,rock", "H1,1,0,10,CLAY", "H1,2,10,25,SAND"),
        rows("hole_id,depth,dip,azimuth", "H2,0,-60,90"),
    )


def datamine_files(write):
    vertices, triangles = SQUARE
    for ending, size in (("dm", 8), ("csv", 0)):
        for name, fields, values in (
            ("toppt", ("PID", "XP", "YP", "ZP"), np.column_stack([[1, 2, 3, 4], vertices])),
            ("toptr", ("TRIANGLE", "PID1", "PID2", "PID3"), np.column_stack([[1, 2], triangles + 1])),
        ):
            text = rows(*(",".join(map(str, row)) for row in (fields, *values.tolist())))
            path = write(f"{name}.{ending}", datamine(fields, values, size) if size else text)
        mesh = read_mesh(path)
        np.testing.assert_array_equal(mesh.vertices[mesh.triangles], vertices[triangles])
    assert_holes(
        write,
        rows("BHID,XCOLLAR,YCOLLAR,ZCOLLAR,ENDDEPTH", "H1,5000,9000,120,40", "H2,5100,9000,121.5,40"),
        rows("BHID,FROM,TO,ROCK", "H1,0,10,CLAY", "H1,10,25,SAND"),
        rows("BHID,AT,BRG,DIP", "H2,0,90,60"),
    )


def micromine(write):
    assert_meshes(write("m.dxf", dxf(TWO)))
    assert_holes(
        write,
        rows("Hole,East,North,RL,Total Depth", "H1,5000,9000,120,40", "H2,5100,9000,121.5,40"),
        rows("Hole,From,To,Lithology", "H1,0,10,CLAY", "H1,10,25,SAND"),
        rows("Hole,Depth,Azimuth,Dip", "H2,0,90,-60"),
    )


def vulcan(write):
    assert_meshes(write("m.dxf", dxf(TWO)))
    assert_meshes(write("m.obj", obj("o")(TWO)))
    with pytest.raises(InputRefused, match="export it from Vulcan as DXF or OBJ"):
        read_mesh(write("top.00t", b"\1\2\3\0"))
    assert_holes(
        write,
        rows("DHID,EASTING,NORTHING,ELEVATION,TOTAL_DEPTH", "H1,5000,9000,120,40", "H2,5100,9000,121.5,40"),
        rows("DHID,FROM,TO,LITH", "H1,0,10,CLAY", "H1,10,25,SAND"),
        rows("DHID,DEPTH,AZIMUTH,DIP", "H2,0,90,-60"),
    )


def civil_3d(write):
    assert_meshes(write("m.xml", landxml(TWO)))
    feet = landxml(TWO).replace(b'<Metric linearUnit="meter"/>', b'<Imperial linearUnit="foot"/>')
    in_feet = read_mesh(write("f.xml", feet), layer="Top A")
    np.testing.assert_allclose(in_feet.vertices[:, 2], SQUARE[0][:, 2] * 0.3048)
    read = read_points(write("c.dxf", drawing(CONTOUR + SPOT)))
    assert read.xyz.tolist() == [[0, 0, 125], [10, 5, 125], [3, 4, 120]]


def twelve_d(write):
    assert_meshes(write("m.xml", landxml(TWO)))
    grid = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value null\nnull 1 2\n3 4 5\n"
    places = [[1.5, 1.5, 1], [2.5, 1.5, 2], [0.5, 0.5, 3], [1.5, 0.5, 4], [2.5, 0.5, 5]]
    assert by_height(read_points(write("g.asc", grid)).xyz).tolist() == places


def rhino(write):
    for name, content in (("m.obj", obj("o")), ("m.stl", stl), ("m.dxf", dxf), ("m.glb", glb)):
        assert_meshes(write(name, content(TWO)))


def shapes(write):
    line = {"type": "LineString", "coordinates": [[5000, 9000], [5010, 9000]]}
    ring = [[5000, 9000], [5010, 9000], [5010, 9020], [5000, 9000]]
    features = [
        {"type": "Feature", "properties": {"ELEV": 120, "bed": "A"}, "geometry": line},
        {
            "type": "Feature",
            "properties": {"ELEV": 1, "bed": "B"},
            "geometry": {"type": "Polygon", "coordinates": [ring]},
        },
    ]
    path = write("m.geojson", json.dumps({"type": "FeatureCollection", "features": features}))
    read = read_points(path, height="ELEV", where={"bed": "A"})
    assert read.xyz.tolist() == [[5000, 9000, 120], [5010, 9000, 120]]
    for name in ("strip.tif", "g.asc", "c.shp", "c.gpkg"):
        if name in FORMATS:
            file, places = write_points(name, 9, 7, path.parent)
            np.testing.assert_array_equal(read_points(file).xyz, places)
    with pytest.raises(InputRefused, match="degrees of longitude and latitude"):
        crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
        point = {
            "type": "Feature",
            "properties": {},
            "geometry": {"type": "Point", "coordinates": [8, 45, 9]},
        }
        content = {"type": "FeatureCollection", "crs": crs, "features": [point]}
        read_points(write("d.geojson", json.dumps(content)))


def ags(*contents):
    def check(write):
        for content in contents:
            holes = read_boreholes(write("site.ags", content))
            assert holes.collars["end"].tolist() == [40] * 5
            assert holes.intervals["to"].tolist() == [10, 25, 40] * 5

    return check


def diggs_file(write):
    holes = read_boreholes(write("site.xml", diggs()))
    assert holes.collars["end"].tolist() == [40] * 5 and holes.intervals["to"].tolist() == [10, 25, 40] * 5


def las(write):
    holes = read_boreholes(write("a.las", LAS3))
    assert holes.picks["depth"].tolist() == [0.5, 1.5] and holes.survey["depth"].tolist() == [0, 1]
    assert holes.intervals["block"].tolist() == ["sand, fine", "clay", "clay"]


def assert_cake(project):
    assert {block.name: round(block.volume) for block in build(project).blocks} == CAKE


def gempy(write):
    points, dips, stack = layer_cake()
    files = write_rows(write("points.csv", ""), points), write_rows(write("orientations.csv", ""), dips)
    assert_cake(from_gempy(*files, stack=stack, extent=BOX))


def loop(write):
    file = write_rows(write("data.csv", ""), loop_beds())
    assert_cake(from_loop(file, [["sand", "shale"], ["basement"]], bounds=BOUNDS))


def excel(write):
    path = workbook(write("w.xlsx", b""), Tops=SHEET, Other=[["X", "Y", "Z"], [7, 8, 9]])
    assert read_points(path, layer="Tops").xyz.tolist() == [[1.5, 2.5, 3]]
    with pytest.raises(InputRefused, match=r"it has Tops, Other"):
        read_points(path)


PROGRAMS = {
    "Leapfrog": leapfrog,
    "Petrel": petrel,
    "RMS": rms,
    "Charisma, Geosoft, GSLIB": charisma_geosoft_and_gslib,
    "OpenWorks": openworks,
    "GOCAD, SKUA": gocad,
    "Surpac": surpac,
    "Datamine": datamine_files,
    "Micromine": micromine,
    "Vulcan": vulcan,
    "Civil 3D": civil_3d,
    "12d": twelve_d,
    "Rhino": rhino,
    "QGIS": shapes,
    "ArcGIS": shapes,
    "gINT": ags(ags3(), ags4()),
    "HoleBASE": ags(ags4()),
    "OpenGround": ags(ags4()),
    "DIGGS": diggs_file,
    "LAS": las,
    "GemPy": gempy,
    "LoopStructural": loop,
    "Excel": excel,
}


def test_the_rows_are_those_of_the_guide():
    text = (ROOT / "docs" / "guide" / "bring_your_data.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| ([^|]+?) \|", text, re.MULTILINE)[1:] == list(PROGRAMS)


@pytest.mark.parametrize("program", PROGRAMS)
def test_what_a_program_exports_comes_in(write, program):
    PROGRAMS[program](write)
