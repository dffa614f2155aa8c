# SPDX-License-Identifier: GPL-3.0-or-later
"""Files damaged at random are either read or refused in one line; nothing else ever comes out."""

import io
import os
import struct
from pathlib import Path

import numpy as np
import pytest
from damages import damaged_bytes
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from realmodel.core import (
    Boreholes,
    BuildFailed,
    InputRefused,
    MeshFile,
    PointFile,
    load_library,
    load_project,
)
from realmodel.core.readers import read_mesh, read_picks, read_point_file, read_region
from realmodel.core.readers.fault_input import read_fault_points
from test_mesh_dialects import GOCAD, STRINGS, WELL, datamine, legacy
from test_named_objects import binary_dxf, dxf_blocks, dxf_meshes, glb, gmsh
from test_point_formats import CPS3_LINES, EARTHVISION, OPENWORKS, PETREL

PROJECT = b"""format = 1
name = "x"
library = "library.toml"
[[rock]]
name = "r"
region = [[0, 0], [1, 0], [1, 1]]
holes = [[[0.5, 0.2], [0.6, 0.2], [0.6, 0.3]]]
edge_length = 0.5
base_elevation = -1.0
[[rock.surface]]
name = "S0"
points = "p.csv"
method = "kriging"
neighbours = 4
variogram = {model = "spherical", range = 60, sill = 4, nugget = 0}
anisotropy = {ratio = 2, azimuth = 30}
[[rock.surface]]
name = "S1"
mesh = "m.off"
rule = "erosional"
property = 3
"""
LIBRARY = b'[[property]]\nid = 3\nname = "Clay"\ncolor = "#102030"\ndensity = 2.0\n'
POINTS = b'x,y,z,"note"\n0,0,1,a\n1,0,2\n0.5,1e3,-3,"b, c"\n# end\n'
OFF = b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 .5\n0 1 1e-3\n3 0 1 2\n4 0 1 2 3\n"
REGION = b'{"type":"Feature","geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}}'
PIECES = [b"9" * 400, b"9" * 5000, b"[" * 5000, b"\x00", b"\xff", b"\xef\xbb\xbf", b"\r\n"]
PIECES += rb"""nan -1 1e999 [ ] { " ''' # = [[rock]] true , ; . null 0x1 1_0 rock.x inf \u0041""".split()


OBJ = b"# a mesh\nv 0 0 1\nv 1 0 2.5\nvn 0 0 1\nv 1 1 -3e-1\nv 0 1 0\ng one\nf 1//1 2//1 3//1\nf -4 3 4\n"
TSURF = b"GOCAD TSurf 1\nHEADER {\n}\nTFACE\nVRTX 1 0 0 1\nPVRTX 2 1 0 2.5 7\nVRTX 3 1 1 0\nTRGL 1 2 3\nEND\n"
PLY = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
PLY += b"element face 2\nproperty list uchar int vertex_indices\nend_header\n"
PLY += b"0 0 1\n1 0 2.5\n1 1 -3e-1\n0 1 0\n3 0 1 2\n3 0 2 3\n"
BINARY_PLY = PLY.partition(b"0 0 1")[0].replace(b"ascii", b"binary_little_endian")
BINARY_PLY += struct.pack("<12f", *range(12)) + 2 * struct.pack("<B3i", 3, 0, 1, 2)
STL = b"solid a\n" + 2 * (
    b"facet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 2.5\nvertex 1 1 -3e-1\nendloop\nendfacet\n"
)
STL += b"endsolid a\n"
BINARY_STL = bytes(80) + struct.pack("<I", 2) + 2 * struct.pack("<12fH", *range(12), 0)

GRID = b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1.5\nNODATA_value -9\n1 2 3\n4 -9 6e0\n"


GRIDS = Path(__file__).parents[1] / "data" / "grids"
CPS3 = b'FSASCI 0 1 "COMPUTED" 0 1.0E+30 0\nFSATTR 0 0\nFSLIMI 0 2 0 1 1 6\nFSNROW 2 3\nFSXINC 1 1\n->GRID\n'
CPS3 += b"1 2\n3 1e30\n5.5 6\n"


def array_file(values):
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


def read_points_of(file):
    return read_point_file(PointFile(file))[0]


DXF = b"0\nSECTION\n2\nENTITIES\n0\n3DFACE\n8\nA\n10\n0\n20\n0\n30\n1\n11\n1\n21\n0\n31\n2\n12\n1\n22\n1\n32\n3\n"  # noqa: E501
DXF += b"13\n0\n23\n1\n33\n4\n0\nENDSEC\n0\nEOF\n"
MSH = b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n"  # noqa: E501
MSH += b"$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n"
BINARY_MSH = b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n$Nodes\n"
BINARY_MSH += struct.pack("<4Q3iQ3Q9d", 1, 3, 1, 3, 2, 1, 0, 3, 1, 2, 3, 0, 0, 0, 1, 0, 0, 0, 1, 0)
BINARY_MSH += b"\n$EndNodes\n$Elements\n" + struct.pack("<4Q3iQ4Q", 1, 1, 1, 1, 2, 1, 2, 1, 1, 1, 2, 3)
BINARY_MSH += b"\n$EndElements\n"
LANDXML = b'<LandXML><Units><Metric linearUnit="meter"/></Units><Surfaces><Surface name="a"><Pnts><P id="1">0 0 1</P>'  # noqa: E501
LANDXML += (
    b'<P id="2">1 0 1</P><P id="3">0 1 1</P></Pnts><Faces><F>1 2 3</F></Faces></Surface></Surfaces></LandXML>'
)
VTP = (
    b'<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt32"><PolyData><Piece>'
)
VTP += (
    b'<Points><DataArray type="Float32" NumberOfComponents="3" format="appended" offset="0"/></Points><Polys>'
)
VTP += b'<DataArray type="Int32" Name="connectivity" format="ascii">0 1 2</DataArray>'
VTP += b'<DataArray type="Int32" Name="offsets" format="binary">BAAAAAMAAAA=</DataArray></Polys></Piece></PolyData>'  # noqa: E501
VTP += b'<AppendedData encoding="raw">_' + struct.pack("<I9f", 36, 0, 0, 0, 1, 0, 0, 0, 1, 0)
VTP += b"</AppendedData></VTKFile>"
VTU = VTP.replace(b"PolyData", b"UnstructuredGrid").replace(b"Polys", b"Cells")
VTU = VTU.replace(b"</Cells>", b'<DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells>')
WKT = b"POLYGON ((0 0, 4 0, 4 3, 0 3.5, 0 0), (1 1, 2 1, 2 2, 1 1))\n"


STICKS = b"1 2 3\n1 2 5.5\n999.000 999.000 999.000\n\n4 5 6\n4 5 7\n999 999 999\n"
LEAPFROG = b"%ARANZ-1.0\n\n[index]\nTri Integer 3 2;\nLocation Double 3 4;\n\n[binary]" + bytes(12)
LEAPFROG += struct.pack("<6i12d", 0, 1, 2, 0, 2, 3, *range(12))
ONE = {"a": (np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 2]]), np.array([[0, 1, 2]]))}


def named_surface(file):
    return read_mesh(MeshFile(file, layer="a"))


READERS = {
    "p.toml": (PROJECT, load_project),
    "library.toml": (LIBRARY, load_library),
    "p.csv": (POINTS, read_points_of),
    "g.asc": (GRID, read_points_of),
    **{path.name: (path.read_bytes(), read_points_of) for path in sorted(GRIDS.iterdir())},
    "c.cps3": (CPS3, read_points_of),
    "p.petrel": (PETREL.format(plan="m", height="ft").encode(), read_points_of),
    "h.ijxyz": (OPENWORKS.encode(), read_points_of),
    "s.dat": (EARTHVISION.format(unit="feet").encode(), read_points_of),
    "f.cps": (CPS3_LINES.encode(), read_points_of),
    "a.npy": (array_file(np.arange(12.0).reshape(4, 3)), read_points_of),
    "f.pol": (STICKS, lambda file: read_fault_points(PointFile(file))),
    "m.off": (OFF, read_mesh),
    "m.obj": (OBJ, read_mesh),
    "m.ts": (TSURF, read_mesh),
    "a.ply": (PLY, read_mesh),
    "b.ply": (BINARY_PLY, read_mesh),
    "a.stl": (STL, read_mesh),
    "b.stl": (BINARY_STL, read_mesh),
    "m.dxf": (DXF, read_mesh),
    "m.msh": (MSH, read_mesh),
    "b.msh": (BINARY_MSH, read_mesh),
    "l.msh": (LEAPFROG, read_mesh),
    "m.xml": (LANDXML, read_mesh),
    "m.vtp": (VTP, read_mesh),
    "m.vtu": (VTU, read_mesh),
    "blocks.dxf": (dxf_blocks(ONE), named_surface),
    "binary.dxf": (binary_dxf(ONE), named_surface),
    "meshes.dxf": (dxf_meshes(ONE), named_surface),
    "m.glb": (glb(ONE), named_surface),
    "4.msh": (gmsh(4.0)(ONE), named_surface),
    "5.vtk": (legacy("POLYDATA", 5.1, False), read_mesh),
    "b.vtk": (legacy("UNSTRUCTURED_GRID", 3.0, True), read_mesh),
    "pt.dm": (datamine(("PID", "XP", "YP", "ZP"), [[1, 0, 0, 1], [2, 1, 0, 2]], 8), read_points_of),
    "s.str": (STRINGS.encode(), lambda file: read_point_file(PointFile(file, layer="1"))),
    "v.ts": (GOCAD.encode(), lambda file: read_point_file(PointFile(file, layer="tops"))),
    "w.wl": (WELL.encode(), lambda file: read_picks(Boreholes(picks=file))),
    "r.geojson": (REGION, read_region),
    "r.wkt": (WKT, read_region),
}

MILD = [b" ", b"0", b"1", b"2", b"5"]

pieces = st.one_of(st.sampled_from(MILD), st.sampled_from(PIECES), st.binary(max_size=4))
edits = st.lists(st.tuples(st.floats(0, 1), st.integers(0, 2), pieces), min_size=1, max_size=3)


def damaged(text, changes):
    for where, length, piece in changes:
        at = int(where * len(text))
        text = text[:at] + piece + text[at + length :]
    return text


@pytest.fixture
def folder(write, tmp_path):
    for name, (text, _) in READERS.items():
        write(name, text)
    return tmp_path


@pytest.mark.parametrize("name", READERS)
def test_read_or_refused(folder, name):
    text, read = READERS[name]
    outcomes = {"read": 0, "refused": 0}

    @settings(
        max_examples=200,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(edits)
    def try_it(changes):
        path = folder / f"damaged-{os.getpid()}-{name}"
        path.write_bytes(damaged(text, changes))
        try:
            result = read(path)
        except InputRefused as error:
            outcomes["refused"] += 1
            assert len(str(error).splitlines()) == 1
            assert len(str(error)) < 1000
            assert error.file is not None
            assert str(error).count(path.name) == 1  # no refusal stands within another
        else:
            outcomes["read"] += 1
            if read is read_points_of:
                assert np.isfinite(result).all()
                assert result.shape[1] == 3
            if read is read_mesh:
                assert np.isfinite(result.vertices).all()
                assert result.triangles.min() >= 0
                assert result.triangles.max() < len(result.vertices)

    try_it()
    assert outcomes["read"] >= 5, outcomes
    assert outcomes["refused"] >= 50, outcomes


@pytest.mark.parametrize(("ending", "driver"), [("gpkg", "GPKG"), ("shp", "ESRI Shapefile")])
def test_maps_are_read_or_refused(tmp_path, ending, driver):
    """Files of GDAL, cut off or with bytes changed. SQLite's messages may have bytes of the damage."""
    pyogrio, shapely = pytest.importorskip("pyogrio"), pytest.importorskip("shapely")
    area = shapely.Polygon([(0, 0), (4, 0), (4, 3), (0, 3.5)], [[(1, 1), (2, 1), (2, 2)]])
    file = tmp_path / f"a.{ending}"
    pyogrio.raw.write(
        file,
        geometry=np.array([shapely.to_wkb(area)], object),
        field_data=[],
        fields=[],
        geometry_type="Polygon",
        crs="EPSG:25832",
        driver=driver,
    )
    try:
        read_region(file)
    except BuildFailed as error:
        pytest.skip(str(error))
    outcomes = {"read": 0, "refused": 0}
    for raw in damaged_bytes(file.read_bytes()):
        file.write_bytes(raw)
        try:
            read_region(file)
            outcomes["read"] += 1
        except InputRefused as error:
            assert len(str(error).splitlines()) == 1
            outcomes["refused"] += 1
    assert outcomes["read"] >= 5, outcomes
    assert outcomes["refused"] >= 50, outcomes
