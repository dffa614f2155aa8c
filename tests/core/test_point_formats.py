# SPDX-License-Identifier: GPL-3.0-or-later
"""Points as other programs write them, by layouts that are public: headers, units, nulls, encodings, sheets.
What is written comes back the same, or is refused or warned of with the key that decides."""

import random

import numpy as np
import pytest
from realmodel.core import InputRefused, PointFile, UsageError, read_mesh, read_points
from realmodel.core.base.packages import vendored
from realmodel.core.base.units import METERS
from realmodel.core.readers.contents import column_names, column_values, layer_names
from realmodel.core.readers.point_input import read_raster_heights

PETREL = """# Petrel Points with attributes
# Unit in X and Y direction: {plan}
# Unit in depth: {height}
VERSION 1
BEGIN HEADER
X
Y
Z
FLOAT,Dip angle
STRING,Name
END HEADER
451234.5 6782345 -2345.6 12 "Well 1"
451334.5 6782345 -2340.6 -999 "B"
451234.5 6782445 -2335.6 9 "B"
"""
OPENWORKS = """@File_Version: 4
@Coordinate_Type_is: 3
#End_of_Horizon_ASCII_Header_
326.0 1160.0 536881.63 6729209.97 -1.0
326.0 1161.0 536891.05 6729218.18 -1.5
EOD
"""
EARTHVISION = """# Type: scattered data
# Version: 6
# Format: free
# Field: 1 x
# Field: 2 y
# Field: 3 z {unit}
# Field: 4 column integer
# Field: 5 row integer
# Projection: Local Rectangular
# Units: {unit}
# End:
# Grid_size: 281 x 441
464112.48 5932425.04 -1599.99 210 154
464137.48 5932425.04 -1598.5 211 154
"""
CPS3_LINES = """FFASCI  0  1  COMPUTED  0  0.1E+31  0
FFATTR  0  0
->fault 1
451234.5 6782345.0 -2345.6
451334.5 6782345.0 -2340.6
->fault 2
451234.5 6782445.0 0.1E+31
451234.5 6782445.0 -2335.6
"""


def test_petrel_points(write):
    read = read_points(write("p.txt", PETREL.format(plan="m", height="ft")))
    assert read.xyz[:, :2].tolist() == [[451234.5, 6782345], [451334.5, 6782345], [451234.5, 6782445]]
    np.testing.assert_allclose(read.xyz[:, 2], np.array([-2345.6, -2340.6, -2335.6]) * 0.3048)
    assert read.columns["Dip angle"].tolist()[::2] == [12, 9] and np.isnan(read.columns["Dip angle"][1])
    assert read.columns["Name"].tolist() == ["Well 1", "B", "B"]
    assert len(read.warnings) == 1 and "says ft for 'Z'" in read.warnings[0] and "units" in read.warnings[0]
    chosen = read_points(write("p.txt", PETREL.format(plan="m", height="ft")), where={"Name": "B"})
    assert chosen.xyz[:, 1].tolist() == [6782345, 6782445]
    read = read_points(write("p.txt", PETREL.format(plan="US ft", height="ft")), file_units="m")
    assert read.xyz[0].tolist() == [451234.5, 6782345, -2345.6]
    assert len(read.warnings) == 2 and all("'units'" in text for text in read.warnings)
    with pytest.raises(InputRefused, match=r"unit 'parsec' .*set units"):
        read_points(write("p.txt", PETREL.format(plan="m", height="parsec")))


def test_a_null_of_petrel_as_a_depth(write):
    text = PETREL.format(plan="m", height="m").replace("-2340.6", "-999.0")
    read = read_points(write("p.txt", text))
    assert read.xyz[:, 2].tolist() == [-2345.6, -2335.6]
    assert read.columns["Name"].tolist() == ["Well 1", "B"]
    assert any("nodata" in warning for warning in read.warnings)


def test_openworks(write):
    read = read_points(write("h.dat", OPENWORKS))
    assert read.xyz.tolist() == [[536881.63, 6729209.97, -1.0], [536891.05, 6729218.18, -1.5]]
    assert read.columns["J"].tolist() == [1160, 1161]
    rows = "\n".join(OPENWORKS.splitlines()[3:5])
    with pytest.raises(InputRefused, match=r"indices of a grid.*columns = \[3, 4, 5\]"):
        read_points(write("h.dat", rows))
    assert read_points(write("h.dat", rows), columns=[3, 4, 5]).xyz.tolist() == read.xyz.tolist()


def test_earthvision(write):
    read = read_points(write("s.dat", EARTHVISION.format(unit="meters")))
    assert read.xyz[1].tolist() == [464137.48, 5932425.04, -1598.5] and not read.warnings
    assert read.columns["column"].tolist() == [210, 211]
    read = read_points(write("s.dat", EARTHVISION.format(unit="feet")))
    np.testing.assert_allclose(read.xyz[1], np.array([464137.48, 5932425.04, -1598.5]) * 0.3048)
    assert "ft" in read.warnings[0]


def test_cps3_lines_and_irap_points(write):
    places = [[451234.5, 6782345, -2345.6], [451334.5, 6782345, -2340.6], [451234.5, 6782445, -2335.6]]
    read = read_points(write("f.cps", CPS3_LINES))
    assert read.xyz.tolist() == places
    assert "1e+30" in read.warnings[0]
    rows = ["451234.5 6782345.0 -2345.6", "451334.5 6782345.0 -2340.6", "999.0 999.0 999.0"]
    rows += ["451234.5 6782445.0 -2335.6", "999.0 999.0 999.0"]
    read = read_points(write("f.pol", "\n".join(rows)))
    assert read.xyz.tolist() == places and read.columns["stick"].tolist() == [1, 1, 2]
    read = read_points(write("f.pol", "\n".join([*rows[:2] * 200, *rows[2:]])))
    assert len(read.xyz) == 401


SHEET = [["Id", "Rechtswert", "Hochwert", "Höhe [m]", "Date", "Share"], ["a", 1.5, 2.5, 3, None, 0.25]]


def workbook(path, **sheets):
    openpyxl = vendored("openpyxl", "openpyxl", "this test", by_its_name=True)
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_sheets_of_workbooks(tmp_path):
    file = workbook(tmp_path / "w.xlsx", Tops=[["My wells"], [], *SHEET, [], ["#b", 4, 5, -6]], Notes=[["x"]])
    read = read_points(file)
    assert read.xyz.tolist() == [[1.5, 2.5, 3], [4, 5, -6]] and not read.warnings
    assert read.columns["Id"].tolist() == ["a", "#b"] and np.isnan(read.columns["Share"][1])
    assert layer_names(file) == ["Tops", "Notes"] and column_names(file, "Tops")[1] == "Rechtswert"
    assert column_values(file, "Id") == ["a", "#b"]
    two = workbook(tmp_path / "two.xlsx", A=SHEET, B=[["X", "Y", "Z"], [7, 8, 9]], Empty=[])
    with pytest.raises(InputRefused, match=r'layer = "..."; it has A, B, Empty'):
        read_points(two)
    assert read_points(two, layer="b").xyz.tolist() == [[7, 8, 9]]
    with pytest.raises(InputRefused, match="no sheet 'C'; it has A, B"):
        read_points(two, layer="C")
    bad = workbook(tmp_path / "bad.xlsx", A=[["X", "Y", "Z"], [], [7, 8, "bad"]])
    with pytest.raises(InputRefused, match=r"bad.xlsx:3: z is not a number: 'bad'"):
        read_points(bad)
    (tmp_path / "old.xls").write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600))
    with pytest.raises(InputRefused, match=r"save it as .xlsx"):
        read_points(tmp_path / "old.xls")
    (tmp_path / "cut.xlsx").write_bytes(file.read_bytes()[:900])
    with pytest.raises(InputRefused, match="not a workbook that can be read"):
        read_points(tmp_path / "cut.xlsx")


def test_a_raster_that_does_not_say_its_null(write):
    file = write("g.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 2\n101 102\n103 -9999\n")
    read = read_points(file)
    assert read.xyz[:, 2].tolist() == [101, 102, 103] and "nodata" in read.warnings[0]
    z = read_raster_heights(PointFile(file), np.array([[1.0, 1.0], [3.0, 1.0], [2.0, 3.0]]))
    np.testing.assert_array_equal(z, [103, np.nan, 101.5])


def test_vertices_of_meshes_are_points(write):
    file = write("m.off", "OFF\n3 1 0\n0 0 5\n1 0 6\n0 1 7\n3 0 1 2\n")
    assert read_points(file).xyz.tolist() == [[0, 0, 5], [1, 0, 6], [0, 1, 7]]


def test_ends_of_lines_behind_a_long_line(write):
    rows = [f"{451000 + n}.5 6782345.0 {999 if n == 7 else -n}.0" for n in range(400)]
    file = write("f.txt", "\n".join([*rows, "999.0 999.0 999.0", *rows[:2], "999.0 999.0 999.0"]))
    assert len(read_points(file).xyz) == 402


def test_keys_of_read_points(write):
    file = write("p.csv", "a;b;c\n1;2;3\n")
    with pytest.raises(UsageError, match="no key 'colums'; there are columns, where"):
        read_points(file, colums=[1, 2, 3])
    with pytest.raises(UsageError, match="unknown unit 'feet'"):
        read_points(file, file_units="feet")
    with pytest.raises(UsageError, match="unknown unit 'yard'"):
        read_points(file, units="yard")
    assert read_points(file, "ft", file_units={"z": "m"}, columns=["c", "b", "a"]).xyz[0, 2] == pytest.approx(
        1 / 0.3048
    )


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("1 451000 5932000 -1600\n2 451100 5932000 -1601\n3 451200 5932000 -1602\n", "columns"),  # numbered
        ("326 1160 536881.6 6729209.9 -1\n327 1160 536891.0 6729218.1 -1.5\n", "columns"),
        ("X Y Z\n0 451000 5932000 -1600\n1 451100 5932000 -1601\n", "columns"),
        ("Well Name X Y Z Phi\nW1 451000 5932000 -1600 7\nW2 451100 5932000 -1601 7\n", "columns"),
        ("# X Y Z\n451000 5932000 -1600 7\n451100 5932000 -1601 7\n", "columns"),
        ("A 451000 5932000 -1600\nB 451100 5932000 -1601\n", "columns"),
        ("x y z\n451000 5932000 -999.25\n451100 5932000 -999.25\n", "nodata"),
        ("lon,lat,z\n8.2,45.1,100\n8.3,45.2,110\n", "columns"),
        ("x,y,depth\n1,2,1600\n1,3,1605\n", "z_axis"),
        ("x,y,Z (depth)\n1,2,1600\n1,3,1605\n", "z_axis"),
        ("x,y,tvdss\n1,2,1600\n1,3,1605\n", "z_axis"),
        ("x,y,z,elevation\n1,2,1600,12\n1,3,1605,12\n", "columns"),
        ("a,b,c\n1,2,1600\n1,3,1605\n", "columns"),
        ("451000 5932000 -1600 7\n451100 5932011 -1601 7\n", "columns"),
        ("x,y,Z (fathoms)\n1,2,1600\n", "units"),
        ("x (deg),y (deg),z\n1,2,1600\n", "units"),
        ("x (m),y (ft),z (m)\n1,2,1600\n", "units"),
        ("# Z unit: furlongs\nx,y,z\n1,2,1600\n", "units"),
        ("x;y;z\n451,234;932,425;1,599\n", "decimal"),
    ],
)
def test_no_guess_without_a_word(write, text, word):
    try:
        said = read_points(write("p.csv", text)).warnings
    except InputRefused as error:
        said = [str(error)]
    assert any(word in sentence for sentence in said), said


@pytest.mark.parametrize(
    "text",
    [
        "# X Y Z\n1.5 2.5 3\n",
        "#\tX\tY\tZ\n1\t1.5\t2.5\t3\n",
        "Survey XYZ\nProject: North\nEasting Northing RL Code\n1.5 2.5 3 TOP\n",
        "sep=;\nX;Y;Z\n1,5;2,5;3\n",
        "X,Y,Z\nkm,km,m\n0.0015,0.0025,3\n",
        "> one\n1.5 2.5 3\n> two\n",
        "\tX\tY\tZ\na\t1.5\t2.5\t3\n",
    ],
)
def test_headers_of_other_programs(write, text):
    assert read_points(write("p.csv", text)).xyz.tolist() == [[1.5, 2.5, 3]]


@pytest.mark.parametrize(
    "text",
    [
        "INLINE :  100 XLINE :  7   1.0  2.0  3.5\nINLINE :  101 XLINE :  8   4.0  5.0  6.5\n",
        "INLINE: 100 XLINE: 7 1.0 2.0 3.5\nINLINE: 101 XLINE: 8 4.0 5.0 6.5\n",
        "INLINE-  100 XLINE-  7 1.0 2.0 3.5\nINLINE-  101 XLINE-  8 4.0 5.0 6.5\n",
        "/ Geosoft\n/ X Y Z\nLine 10\n 1.0 2.0 3.5\nTie 20\n 4.0 5.0 6.5\n",
        "2\n1.0 2.0 3.5 255 0 0\n4.0 5.0 6.5 255 0 0\n",
        "//X Y Z R G B\n2\n1.0 2.0 3.5 255 0 0\n4.0 5.0 6.5 255 0 0\n",
        '"x" "y" "z"\n"1" 1 2 3.5\n"2" 4 5 6.5\n',
        "x y z\n1,0 2,0 3,5\n4,0 5,0 6,5\n",
        "Point,Northing,Easting,Elevation\n7,2,1,3.5\n9,5,4,6.5\n",
    ],
)
def test_points_of_other_programs(write, text):
    assert read_points(write("p.txt", text)).xyz.tolist() == [[1, 2, 3.5], [4, 5, 6.5]]


@pytest.mark.parametrize(
    "rows",
    [
        "451,234.5;5,932,425;1,599",
        "451.234,5;5.932.425;1.599",
        "451'234.5;5'932'425;1'599",
        "451 234,5;5 932 425;1 599",
        '"451,234.5","5,932,425","1,599"',
        "451\u202f234,5;5\u202f932\u202f425;1\u202f599",
    ],
)
def test_separators_of_thousands(write, rows):
    separator = ";" if ";" in rows else ","
    text = f"n{separator}x{separator}y{separator}z\na{separator}{rows}\n"
    assert read_points(write("p.csv", text)).xyz.tolist() == [[451234.5, 5932425, 1599]]


NAMES = [
    "x y z|X Y Z|Easting Northing Elevation|EASTING NORTHING RL|Rechtswert Hochwert Höhe",
    "Ostwert Nordwert Höhe|UTM32_E UTM32_N Z_NN|LV95_X LV95_Y Z|x_rd y_rd z_nap|X_MGA94 Y_MGA94 RL",
    "este norte cota|coord_x coord_y coord_z|X_UTM Y_UTM Z|POINT_X POINT_Y POINT_Z|E N RL|RD_X RD_Y Maaiveld",
    "abscisse ordonnée altitude|x-coord y-coord elev|UTM_E UTM_N Altitude|MapX MapY Z|X_Lambert Y_Lambert Z",
]
UNITS = {
    "m": "m metre Meter metres METERS",
    "ft": "ft feet Foot FEET",
    "km": "km",
    "us-ft": "ftUS US-ft us_ft",
}
FORMS = ("{} ({})", "{} [{}]", "{}_{}", "{}, {}", "{}")
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252", "cp850")


@pytest.mark.parametrize("seed", range(150))
def test_any_dialect_of_a_table(write, seed):
    """Random points in a random dialect: names, units, separator, decimals, ends of lines, encoding, nulls,
    comments, further columns."""
    draw = random.Random(seed)
    xyz = np.array(
        [[451000 + 100 * k, 5932000 + draw.randrange(900), -draw.randrange(100, 900)] for k in range(9)]
    )
    xyz = xyz + 0.25
    separator, decimal = draw.choice(
        [(";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", "."), ("|", ".")]
    )
    names = draw.choice("|".join(NAMES).split("|")).split(" ")
    unit = draw.choice(list(UNITS))
    form = draw.choice([form for form in FORMS if not ("," in form and separator == ",")])
    headings = [form.format(name, draw.choice(UNITS[unit].split())) for name in names]
    of_header = form != "{}"
    encoding = draw.choice(ENCODINGS)
    order = draw.sample(range(5), 5)  # of x, y, z, a text and a number
    headings += ["Schicht", "wert"]
    rows = [
        [*map(repr, row), draw.choice(["Löß", "Grès", "a b"]), f"{n}.5"] for n, row in enumerate(xyz.tolist())
    ]
    null = draw.choice([None, "-999.25", "-9999", "1e30", "-99999.0"])
    if null:
        rows.insert(draw.randrange(9), [*rows[0][:2], null, "null", "7.0"])
    lines = [separator.join(headings[n] for n in order)]
    if draw.random() < 0.3 and not of_header:
        lines.insert(0, f"# Units: {draw.choice(UNITS[unit].split())}")
        of_header = True
    for row in rows:
        lines.append(separator.join(row[n].replace(".", decimal) if n != 3 else row[n] for n in order))
        if draw.random() < 0.1:
            lines.append(draw.choice(["# a comment", "! a comment", "", "% so"]))
    text = draw.choice(["\n", "\r\n", "\r"]).join([*lines, ""])
    read = read_points(write("p.csv", text.encode(encoding)))
    scale = float(METERS[unit]) if of_header else 1.0
    np.testing.assert_allclose(read.xyz, xyz * scale, rtol=1e-15)
    texts = [row[3] for row in rows if row[3] != "null"]
    assert read.columns["Schicht"].tolist() == texts
    assert len(read.columns["wert"]) == len(xyz)
    assert any("nodata" in warning for warning in read.warnings) == (null is not None)
    assert any("units" in warning for warning in read.warnings) == (of_header and unit != "m")


def test_lines_of_cps3_have_numbers(write):
    text = "FFASCI 0 1\nFFATTR 0 0\n->1\n1 2 3\n4 5 6\n->2\n7 8 9\n->3\n1 1 1\n"
    assert read_points(write("f.cps", text)).columns["stick"].tolist() == [1, 1, 2, 3]


def test_numbers_of_fortran_and_minus_signs(write):
    text = "x y z\n1.5D+03 2.0d0 \N{MINUS SIGN}3.\n-1.D-01 .5D1 4\n"
    assert read_points(write("f.xyz", text)).xyz.tolist() == [[1500, 2, -3], [-0.1, 5, 4]]
    named = read_points(write("n.csv", "x,y,z,name\n1.5D0,2,3,W1D-2\n1,2,3,2D4\n"))
    assert named.columns["name"].tolist() == ["W1D-2", "2D4"]


def test_what_is_not_read_is_called_by_its_name(write, tmp_path):
    beginnings = {
        "DWG": b"AC1032\0\0",
        "FBX": b"Kaydara FBX Binary  \0",
        "STEP": b"ISO-10303-21;\n",
        "LAZ": b"LASF\0\0",
        "Storm": b"STORMGRID_BINARY\n\n3 2 10 10\n0 20 0 10\n\0\0",
        "ROFF": b"roff-bin\0#ROFF file#\0",
        "PetroMod": b"Content=Map,DataUnitDistance=meter\0\0",
        "PDF": b"%PDF-1.4\n",
        "gzip": b"\x1f\x8b\x08\0",
        "bzip2": b"BZh91AY&SY",
        "RAR": b"Rar!\x1a\x07\x01\0",
        "7z": b"7z\xbc\xaf\x27\x1c",
        "tar": b"points.csv" + bytes(247) + b"ustar",
        "zip": b"PK\3\4" + bytes(26) + b"points.csv",
        "Git LFS": b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
        "web": b"\n<!DOCTYPE html><html></html>",
    }
    for name, beginning in beginnings.items():
        for ending in (".csv", ".dxf"):
            (path := tmp_path / f"f{ending}").write_bytes(beginning)
            for read in (read_points, read_mesh):
                with pytest.raises(InputRefused, match=f"{name}.*; "):
                    read(path)


def test_a_depth_is_said_to_be_read_upward_whatever_its_sign(write):
    for sign in ("", "-"):
        (said,) = read_points(write("d.csv", f"x,y,depth\n0,0,{sign}5\n1,0,{sign}7\n0,1,{sign}6\n")).warnings
        assert "z_axis" in said
