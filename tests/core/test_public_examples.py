# SPDX-License-Identifier: GPL-3.0-or-later
"""Classes of public example files that were refused for another reason, or read wrongly; the files here are
our own reconstructions."""

import zipfile

import numpy as np
import pytest
from realmodel.core import propose_project, read_boreholes, read_mesh, read_points
from realmodel.core.base.errors import InputRefused
from realmodel.core.base.packages import vendored
from realmodel.core.readers import read_shapes
from realmodel.core.readers.table_kind import table_kind
from realmodel.core.settings.data_files import MapLayer


@pytest.fixture
def put(tmp_path):
    def written(name, text):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return written


GEO_EAS = "Heights of the top\n4\nXlocation\nYlocation\nZ, m\nPorosity\n 0. 1.5 20 .06\n 10. .5 2.1e1 .1\n"


def test_tables_of_geo_eas(put):
    read = read_points(put("top.dat", GEO_EAS))
    assert read.xyz.tolist() == [[0, 1.5, 20], [10, 0.5, 21]]
    assert list(read.columns) == ["Porosity"]
    with pytest.raises(InputRefused, match=r"no column z; it has Xlocation, Ylocation, Depth1, Porosity"):
        read_points(put("other.dat", GEO_EAS.replace("Z, m", "Depth1")))


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("MD;INC;AZI\n0;0;0\n50;1;90\n", "the first three are no coordinates; it has MD, INC, AZI"),
        (",MD,DIP,AZI\n0,0,0,0\n1,50,0,0\n", r"it has \(no name\), MD, DIP, AZI"),
        ("DEPT (M),DT (US/M),RHOB\n1,2,3\n2,3,4\n", "the first three are no coordinates"),
        ("Formation;Top;Ref\nSand;1;2\nClay;2;3\n", "no column is named x, y or z; it has Formation"),
        ("Name;LocationX;LocationY\nA;1;2\nB;2;3\n", "no column z; it has Name, LocationX, LocationY"),
        ("Top;MD\nSand;3\nClay;9.5\n", "there are no points in it; a row of points has three numbers"),
        ("\n".join(" ".join(["1.5"] * 100) for _ in range(100)), "its 100 columns, as many as a grid"),
    ],
)
def test_tables_without_coordinates_say_what_they_have(put, text, what):
    with pytest.raises(InputRefused, match=what):
        read_points(put("t.csv", text))


def test_a_column_for_each_surface(put):
    wide = "x,y,top_A,top_B,base_B,note\n0,0,10,5,1,a\n10,0,11,,1,b\n0,10,12,7,1,c\n"
    path = put("tops.csv", wide)
    advice = r'set columns = \["x", "y", "top_A"\], and so on with top_B, base_B$'
    with pytest.raises(InputRefused, match=advice):
        read_points(path)
    read = read_points(path, columns=["x", "y", "top_B"])
    assert read.xyz.tolist() == [[0, 0, 5], [0, 10, 7]]
    assert any("left out: 1 point without a value" in text for text in read.warnings)
    with pytest.raises(InputRefused, match="z is not a number: ''"):  # a blank that native code does not know
        read_points(put("z.csv", "x,y,z\n1,2,3\n1,2,\u2003\n"))
    with pytest.raises(InputRefused, match="y is not a number: ''"):
        read_points(put("y.csv", "x,y,z\n1,2,3\n1,,3\n"))


def test_names_of_points_are_no_holes(put):
    rows = "".join(f"{n},{n % 7},{n},Sand\n{n},{n % 5},{n},Clay\n" for n in range(20))
    with pytest.raises(InputRefused, match="its columns do not say"):
        table_kind(put("contacts.csv", "X,Y,Z,name\n" + rows))
    assert table_kind(put("contacts.csv", "X,Y,Z,name\n" + rows), {"block": "name"}) == "observations"
    collars = "".join(f"{n},{n % 7},{n},B{n}\n" for n in range(20))
    assert table_kind(put("collars.csv", "X,Y,Z,name\n" + collars)) == "collars"
    wells = "".join(f"{n % 3},{n},{-n},W{n % 3}\n" for n in range(20))
    with pytest.raises(InputRefused, match="'well' has many rows with other places, so they are no collars"):
        table_kind(put("wells.csv", "X,Y,Z,Well\n" + wells))
    vertical = "".join(f"{n % 3},7,{-n},W{n % 3}\n" for n in range(20))
    with pytest.raises(InputRefused, match="so they are no collars"):
        table_kind(put("vertical.csv", "X,Y,Z,Well\n" + vertical))


def test_structures_in_holes_are_no_survey(put):
    survey = "hole_id,depth,dip,azimuth\nA,10,-60,90\nA,20,-61,91\n"
    assert table_kind(put("survey.csv", survey)) == "survey"
    with pytest.raises(InputRefused, match="structures seen in holes, no survey"):
        table_kind(put("joints.csv", survey.replace("azimuth", "azimuth,defect").replace("0,9", "0,Joint,9")))


STRINGS = "smp , 8-Feb-94, ,Sample string file,\n0, 1.0, 2.0, 3.0, 1.0, 4.0, 3.0\n7, 100.0, 10.0, 5.0,\n"


def test_strings_of_surpac_by_their_content(put):
    read = read_points(put("strings.txt", STRINGS + "7, 100.0, 20.0, 6.0,\n0, 0.0, 0.0, 0.0, END\n"))
    assert read.xyz.tolist() == [[10, 100, 5], [20, 100, 6]]


POINTS_VTU = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>
<Piece NumberOfPoints="2" NumberOfCells="2"><Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 1 1 0 2</DataArray></Points><Cells>
<DataArray type="Int32" Name="connectivity" format="ascii">0 1</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">1 2</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">1 1</DataArray>
</Cells></Piece></UnstructuredGrid></VTKFile>
"""


def test_points_of_an_unstructured_grid(put):
    assert read_points(put("p.vtu", POINTS_VTU)).xyz.tolist() == [[0, 0, 1], [1, 0, 2]]


def test_a_3mf_is_named(tmp_path):
    with zipfile.ZipFile(tmp_path / "part.3mf", "w") as archive:
        archive.writestr("[Content_Types].xml", "<Types/>")
        archive.writestr("3D/3dmodel.model", "<model unit='millimeter'/>")
    for read in (read_mesh, read_points):
        with pytest.raises(InputRefused, match="it is a 3MF, which is not read; save it as STL"):
            read(tmp_path / "part.3mf")


def test_multipatches_are_named(tmp_path):
    shapefile = vendored("shapefile", "pyshp", "reading shapefiles")
    with shapefile.Writer(tmp_path / "tin.shp", shapefile.MULTIPATCH) as writer:
        writer.field("id", "N")
        triangle = [(0, 0, 1), (1, 0, 2), (0, 1, 3)]
        writer.multipatch([triangle], partTypes=[shapefile.TRIANGLE_STRIP])
        writer.record(1)
    with pytest.raises(InputRefused, match="its shapes are multipatches, which are not read"):
        read_shapes(MapLayer(tmp_path / "tin.shp"))


AGS = """"GROUP","LOCA"
"HEADING","LOCA_ID","LOCA_NATE","LOCA_NATN","LOCA_GL"
"UNIT","","m","m","m"
"TYPE","ID","2DP","2DP","2DP"
"DATA","B1","10","10","5"
"DATA","B2","110","10","6"

"GROUP","GEOL"
"HEADING","LOCA_ID","GEOL_TOP","GEOL_BASE","GEOL_DESC","GEOL_GEO2"
"UNIT","","m","m","",""
"TYPE","ID","2DP","2DP","X","PA"
"DATA","B1","0","3","clay","A"
"DATA","B2","0","9","sand","B"
"""


def test_the_second_code_of_ags(put):
    assert read_boreholes(put("a.ags", AGS)).intervals["block"].tolist() == ["A", "B"]
    first = AGS.replace("GEOL_DESC", "GEOL_GEOL").replace('"clay"', '""').replace('"sand"', '""')
    assert read_boreholes(put("a.ags", first)).intervals["block"].tolist() == ["A", "B"]
    other = put("a.ags", AGS.replace("GEOL_GEO2", "GEOL_STAT"))
    read = read_boreholes(other)
    assert len(read.intervals) == 0
    assert any("no column names the units of its intervals" in text for text in read.warnings)
    with pytest.raises(InputRefused, match=r"name the column of units: .*it has .*GEOL_DESC, GEOL_STAT"):
        propose_project(boreholes=other)
    assert read_boreholes(other, columns={"block": "GEOL_STAT"}).intervals["block"].tolist() == ["A", "B"]


def test_heights_that_ags_lacks_are_named(put):
    with pytest.raises(InputRefused, match=r"has no z \(LOCA_GL is empty\)"):
        read_boreholes(put("a.ags", AGS.replace('"5"', '""').replace('"6"', '""')))
    without = AGS.replace(',"LOCA_GL"', "").replace(',"5"', "").replace(',"6"', "")
    with pytest.raises(InputRefused, match=r"no column z; .*it has LOCA_ID, LOCA_NATE, LOCA_NATN"):
        read_boreholes(put("a.ags", without))


def test_a_curve_of_las_without_a_point(put):
    text = "~V\nVERS. 2.0:\n~W\nWELL. A:\nNULL. -999:\n~C\nMD   :DEPTH\nGR.API :gamma\n~A\n1 5\n2 6\n3 7\n"
    collars = put("c.csv", "hole,x,y,z\nA,0,0,0\n")
    logs = read_boreholes(collars=collars, logs=put("a.las", text)).logs
    assert np.array_equal(logs["GR (API)"], [5, 6, 7])


def test_the_end_of_a_hole_is_no_surface(put):
    collars = put("c.csv", "hole,x,y,z\nA,0,0,100\nB,100,0,100\nC,0,100,100\n")
    rows = "".join(f"{hole},Sand,10\n{hole},Clay,30\n{hole},TD,50\n" for hole in "ABC")
    picks = put("p.csv", "hole,surface,depth\n" + rows)
    read = read_boreholes(collars=collars, picks=picks)
    assert set(read.picks["surface"].tolist()) == {"Sand", "Clay"}
    assert [problem.line for problem in read.problems] == [4, 7, 10]
    assert all("'TD' is the end of the hole" in problem.text for problem in read.problems)
    found = propose_project(boreholes={"collars": collars, "picks": picks}).proposal.order
    assert "TD" not in found
