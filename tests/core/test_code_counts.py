# SPDX-License-Identifier: GPL-3.0-or-later
"""The codes of field data are counted: holes, rows, lengths."""

from itertools import pairwise

import numpy as np
import pytest
from realmodel.core import Boreholes, DipFile, MapFile, ObservationFile, count_codes
from realmodel.core.readers.tables.unit_names import UnitNames, fits

_MAP = """{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"UNIT": "Qa"}, "geometry": {"type": "Polygon",
 "coordinates": [[[0, 0], [9, 0], [9, 9], [0, 0]]]}},
{"type": "Feature", "properties": {"UNIT": "Ss"}, "geometry": {"type": "Polygon",
 "coordinates": [[[0, 0], [9, 9], [0, 9], [0, 0]]]}}]}"""


@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("ft", 1 / 0.3048)])
def test_any_logs(tmp_path, unit, factor):
    """Whatever the logs: each code has the holes, rows and lengths that were written."""
    rng = np.random.default_rng(11)
    for _ in range(10):
        rows, length, holes, count = [], {}, {}, {}
        for hole in range(rng.integers(1, 6)):
            depths = np.cumsum(np.r_[0.0, rng.uniform(1.0, 9.0, rng.integers(2, 9))]).round(2).tolist()
            last = ""
            for begin, end in pairwise(depths):
                last = code = str(rng.choice([c for c in ("Ss", "Qa", "LC", "x y") if c != last]))
                rows.append(f"B{hole};{begin};{end};{code}")
                length[code] = length.get(code, 0.0) + end - begin
                holes.setdefault(code, set()).add(hole)
                count[code] = count.get(code, 0) + 1
        (tmp_path / "i.csv").write_text("hole;from;to;block\n" + "\n".join(rows) + "\n")
        collars = [f"B{n};{n};{n % 2};5" for n in range(6)]
        (tmp_path / "c.csv").write_text("hole;x;y;z\n" + "\n".join(collars) + "\n")
        files = Boreholes(collars=tmp_path / "c.csv", intervals=tmp_path / "i.csv", units="m")
        codes = {entry.code: entry for entry in count_codes(files, units=unit)}
        assert codes.keys() == count.keys()
        for code, entry in codes.items():
            assert (entry.holes, entry.rows) == (len(holes[code]), count[code])
            assert entry.length == pytest.approx(length[code] * factor, rel=1e-9)


def test_of_all_kinds(tmp_path):
    (tmp_path / "p.csv").write_text("hole,x,y,z,surface,depth\nA,0,0,9,Top,1\nB,5,0,9,Top,2\nB,5,0,9,Qa,3\n")
    (tmp_path / "o.csv").write_text("x,y,z,block\n0,0,1,Qa\n1,0,1,Ss\n")
    (tmp_path / "d.csv").write_text("x,y,dip,dip_direction,surface\n0,0,10,90,Top\n")
    (tmp_path / "m.geojson").write_text(_MAP)
    counted = count_codes(
        Boreholes(picks=tmp_path / "p.csv"),
        ObservationFile(tmp_path / "o.csv"),
        DipFile(tmp_path / "d.csv"),
        MapFile(tmp_path / "m.geojson", block="UNIT"),
    )
    assert {entry.code: (entry.holes, entry.rows) for entry in counted} == {
        "Top": (2, 3),
        "Qa": (1, 3),
        "Ss": (0, 2),
    }


@pytest.mark.parametrize(
    ("pattern", "code", "is_fit"),
    [
        ("Qal*", "qal-2", True),
        ("Qal*", "Sand", False),
        ("S?nd", "Sand", True),
        ("/^Q[0-9]+$/", "q12", True),
        ("/^Q[0-9]+$/", "q12a", False),
        ("/a|b/", "xbx", True),
    ],
)
def test_patterns_of_codes(pattern, code, is_fit):
    assert fits(pattern, code) == is_fit


def test_names_come_before_patterns_and_these_in_their_order():
    names = UnitNames(
        ["Silt", "Sand", "Clay"], ["Silt", "Sand", "Clay"], names={"S 9": "Clay", "S*": "Sand", "*": ""}
    )
    meant = [names.block(code) for code in ("Silt", "silt", "S 9", "s-9", "S1", "sst")]
    assert meant == ["Silt", "Silt", "Clay", "Clay", "Sand", "Sand"]
    assert names.says_nothing("anything") and names.says_nothing("lost core")
    assert UnitNames(names={"Sand?": "Clay"}).meaning("Sandy") == "Sandy"  # an uncertain code is no pattern
