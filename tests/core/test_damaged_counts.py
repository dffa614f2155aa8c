# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that announce what is not there are refused or read at once, and take no memory for it."""

import time
import tracemalloc
from itertools import islice

import numpy as np
import pytest
from damages import damaged_bytes, wrong_counts
from realmodel.core import Boreholes, InputRefused, PointFile
from realmodel.core.readers import read_mesh, read_picks, read_point_file
from realmodel.core.readers.fault_input import read_fault_points
from test_damaged_files import MSH, READERS
from test_rasters import PLACE, needs_tifffile, tifffile

MOST_SECONDS, MOST_BYTES = 0.5, 200e6  # for one file
MOST_FILES = 100

POLYFACE = (
    """0|SECTION|2|ENTITIES|0|POLYLINE|70|64|71|3|72|1|0|VERTEX|70|192|10|0|20|0|30|1|0|VERTEX|70|192
|10|1|20|0|30|2|0|VERTEX|70|192|10|1|20|1|30|3|0|VERTEX|70|128|71|1|72|2|73|3|0|SEQEND|0|POLYLINE|70|16|71|2
|72|2|0|VERTEX|70|64|10|5|0|VERTEX|70|64|10|6|0|VERTEX|70|64|10|5|20|1|0|VERTEX|70|64|10|6|20|1|0|SEQEND|0
|ENDSEC|0|EOF|""".replace("\n", "")
    .replace("|", "\n")
    .encode()
)
MSH_2 = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
MSH_2 += b"$Elements\n2\n1 15 2 0 1 1\n2 2 2 0 1 1 2 3\n$EndElements\n"
PICKS = b"hole,surface,depth\nB1,S0,20.5\nB1,S1,12\nB2,S0,31\nB2,S1,\n"
COLLARS = b"hole,x,y,z\nB1,0,0,100\nB2,50,0,101.5\n"
SURVEY = b"hole,depth,azimuth,dip\nB1,0,0,-90\nB1,20,45,-80\nB2,0,90,-85\n"
STICKS = b"x,y,z,stick\n0,0,1,a\n0,0,-5,a\n1,0,1,b\n1,0.1,-5,b\n"


def of_holes(damaged):
    def read(file):
        tables = {"picks": PICKS, "collars": COLLARS, "survey": SURVEY}
        for name, content in tables.items():
            if name != damaged:
                file.with_name(f"{name}.csv").write_bytes(content)
        paths = {name: file if name == damaged else file.with_name(f"{name}.csv") for name in tables}
        return read_picks(Boreholes(**paths))

    return read


MORE = {
    "polyface.dxf": (POLYFACE, read_mesh),
    "old.msh": (MSH_2, read_mesh),
    "picks.txt": (PICKS, of_holes("picks")),
    "collars.txt": (COLLARS, of_holes("collars")),
    "survey.txt": (SURVEY, of_holes("survey")),
    "sticks.csv": (STICKS, lambda file: read_fault_points(PointFile(file))),
}


def outcome(file, raw, read):
    """Whether it was read. Whatever it holds, there is one line, soon, and little memory is taken."""
    file.write_bytes(raw)
    tracemalloc.start()
    began = time.process_time()
    try:
        read(file)
        return "read"
    except InputRefused as error:
        assert len(str(error).splitlines()) == 1
        assert error.file is not None
        return "refused"
    finally:
        seconds, (_, peak) = time.process_time() - began, tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert seconds < MOST_SECONDS, raw
        assert peak < MOST_BYTES, raw


@pytest.mark.parametrize("name", [*READERS, *MORE])
def test_wrong_counts(tmp_path, name):
    content, read = {**READERS, **MORE}[name]
    found = [outcome(tmp_path / name, raw, read) for raw in wrong_counts(content)]
    assert found.count("refused") >= 5


@pytest.mark.parametrize("name", MORE)
def test_random_damage(tmp_path, name):
    content, read = MORE[name]
    found = [outcome(tmp_path / name, raw, read) for raw in islice(damaged_bytes(content), MOST_FILES)]
    assert found.count("refused") >= 20
    (tmp_path / name).write_bytes(content)
    read(tmp_path / name)


@needs_tifffile
@pytest.mark.parametrize("options", [{"rowsperstrip": 3}, {"tile": (16, 16), "compression": "zlib"}])
def test_geotiff(tmp_path, options):
    z = np.arange(80.0, dtype=np.float32).reshape(8, 10)
    tifffile.imwrite(
        tmp_path / "z.tif", z, photometric="minisblack", extratags=PLACE, metadata=None, **options
    )
    content = (tmp_path / "z.tif").read_bytes()

    def read(file):
        return read_point_file(PointFile(file))

    raws = [*islice(damaged_bytes(content), MOST_FILES), *wrong_counts(content, 120)]
    found = [outcome(tmp_path / "z.tif", raw, read) for raw in raws]
    assert min(found.count(what) for what in ("read", "refused")) >= 20


@pytest.mark.parametrize("kind", ["vtu", "msh"])
@pytest.mark.parametrize("binary", [False, True])
def test_meshes_of_meshio(tmp_path, kind, binary):
    """Of other layouts than those above: compressed, in base64, and Gmsh's old binary one."""
    meshio = pytest.importorskip("meshio")
    mesh = meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))])
    file = tmp_path / f"m.{kind}"
    mesh.write(file, "vtu" if kind == "vtu" else "gmsh22", binary=binary)
    content = file.read_bytes()
    raws = [*islice(damaged_bytes(content), MOST_FILES), *wrong_counts(content)]
    found = [outcome(file, raw, read_mesh) for raw in raws]
    assert found.count("refused") >= 20


def test_a_count_of_nodes_that_are_not_there_is_refused(tmp_path):
    (tmp_path / "m.msh").write_bytes(MSH.replace(b"2 1 0 3\n", b"2 1 0 4000000000\n"))
    with pytest.raises(InputRefused, match="4000000000 entries are announced, the file is cut off"):
        read_mesh(tmp_path / "m.msh")
