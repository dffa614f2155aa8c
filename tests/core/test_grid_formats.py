# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids in the formats of other programs. Those in tests/data/grids were written by others: irap.gri,
irap_binary.gri and zmap.dat by xtgeo 4.27, surfer_*.grd by GDAL 3 (rasterio)."""

from pathlib import Path

import numpy as np
import pytest
from realmodel.core import InputRefused, PointFile
from realmodel.core.readers import read_point_file

GRIDS = Path(__file__).parents[1] / "data" / "grids"


def expected(rotation=0.0):
    """4 columns of 10, 3 rows of 20 from (1000, 2000), heights 0.5, 1.5, ... column after column; none in the
    middle row of the second column."""
    column, row = (index.ravel() for index in np.meshgrid(np.arange(4), np.arange(3), indexing="ij"))
    angle = np.radians(rotation)
    x = 1000 + 10 * column * np.cos(angle) - 20 * row * np.sin(angle)
    y = 2000 + 10 * column * np.sin(angle) + 20 * row * np.cos(angle)
    points = np.column_stack([x, y, 3 * column + row + 0.5])
    return points[(column != 1) | (row != 1)]


def by_height(points):
    return points[np.argsort(points[:, 2])]


@pytest.mark.parametrize("name", sorted(path.name for path in GRIDS.iterdir()))
def test_grids_of_other_programs(name):
    points, warnings = read_point_file(PointFile(GRIDS / name))
    assert by_height(points) == pytest.approx(expected(30.0 if name.startswith("irap") else 0.0), rel=1e-7)
    assert warnings == []


def test_the_format_of_a_grid_is_detected_from_its_content(tmp_path):
    for number, path in enumerate(sorted(GRIDS.iterdir())):
        (tmp_path / f"{number}.txt").write_bytes(path.read_bytes())
        assert len(read_point_file(PointFile(tmp_path / f"{number}.txt"))[0]) == 11


def test_depths_and_units_are_honored():
    given = PointFile(GRIDS / "surfer_7.grd", z_axis="down", units={"xy": "km", "z": "ft"})
    points, _ = read_point_file(given, "m")
    found = expected() * [1000, 1000, -0.3048]
    assert by_height(points)[::-1] == pytest.approx(found)


def test_a_long_row_of_digits_takes_no_time(write):
    """The expression for a number tried each way to divide the digits among its two parts."""
    path = write("p.csv", f"{'9' * 200_000}x 1 2\n")
    with pytest.raises(InputRefused):
        read_point_file(PointFile(path))


def test_cps3(write):
    path = write(
        "g.cps",
        '! made by hand\nFSASCI 0 1 "COMPUTED" 0 1.0E+30 0\nFSATTR 0 0\nFSLIMI 100 120 0 5 1 6\nFSNROW 2 3\n'
        "FSXINC 10 5\n->top\n1 2\n3 1.0E+30 5\n6\n",
    )
    points, _ = read_point_file(PointFile(path))
    places = [(100, 5, 1), (110, 5, 3), (120, 5, 5), (100, 0, 2), (120, 0, 6)]
    assert sorted(map(tuple, points.tolist())) == sorted(places)


def test_arrays_of_points(tmp_path):
    points = np.array([[0.0, 0, 1], [1, 0, np.nan], [2, 5, 3]])
    np.save(tmp_path / "p.npy", points.astype(np.float32))
    assert read_point_file(PointFile(tmp_path / "p.npy"))[0].tolist() == [[0, 0, 1], [2, 5, 3]]
    np.save(tmp_path / "q.npy", points[:, :2])
    with pytest.raises(InputRefused, match=r"^[^ ]*q\.npy: an array of shape \(3, 2\) of float64"):
        read_point_file(PointFile(tmp_path / "q.npy"))
    of_python_2 = (tmp_path / "p.npy").read_bytes().replace(b"(3, 3)", b"(3L,3)")
    (tmp_path / "r.npy").write_bytes(of_python_2)  # no warning of NumPy's
    assert len(read_point_file(PointFile(tmp_path / "r.npy"))[0]) == 2
    np.save(tmp_path / "o.npy", np.array([{}], object), allow_pickle=True)
    with pytest.raises(InputRefused, match="damaged array"):
        read_point_file(PointFile(tmp_path / "o.npy"))


@pytest.mark.parametrize(
    ("name", "old", "new", "match"),
    [
        ("zmap.dat", b"3, 4,", b"3, 400000000,", r"need 1200000000 elevations; there are 12"),
        ("zmap.dat", b"3, 4,", b"0, 4,", r"zmap.dat:4: rows must be a whole number from 1"),
        ("zmap.dat", b"2.50000000", b"2.5x", r"zmap.dat:7: not an elevation: '2.5x'"),
        ("zmap.dat", b"\n@\n", b"\n", r"the header has no second @|needs"),
        ("irap.gri", b"4 30.0", b"99999999 30.0", r"need 299999997 elevations; there are 12"),
        ("irap.gri", b"6.500000", b"six", r"irap.gri:5: not an elevation: 'six'"),
        ("irap_binary.gri", b"\0\0\0\4A", b"\0\1\0\4A", r"bytes and more; there are 172"),
        ("surfer_text.grd", b"4 3", b"4 4", r"need 16 elevations; there are 12"),
        ("surfer_text.grd", b"1000 1030", b"1030 1000", r"surfer_text.grd:3: the grid must go from a lower"),
        ("surfer_6.grd", b"DSBB\4", b"DSBB\5", r"need 116 bytes; there are 104"),
        ("surfer_7.grd", b"DATA", b"DATE", r"no section DATA"),
    ],
)
def test_damaged_grids_are_refused_with_the_place(tmp_path, name, old, new, match):
    raw = (GRIDS / name).read_bytes()
    assert old in raw
    (tmp_path / name).write_bytes(raw.replace(old, new, 1))
    with pytest.raises(InputRefused, match=match):
        read_point_file(PointFile(tmp_path / name))


@pytest.mark.parametrize("name", sorted(path.name for path in GRIDS.iterdir()))
def test_grids_that_are_cut_off_are_refused(tmp_path, name):
    raw = (GRIDS / name).read_bytes().rstrip()
    whole = len(read_point_file(PointFile(GRIDS / name))[0])
    for length in range(40, len(raw) - 8, 7):
        (tmp_path / name).write_bytes(raw[:length])
        try:
            points, _ = read_point_file(PointFile(tmp_path / name))
        except InputRefused:
            continue
        assert length >= len(raw) - 26, (length, whole, len(points))  # digits of the last number
