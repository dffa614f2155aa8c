# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of heights of any size in each format that is read piece by piece, and what is in them."""

import base64
import sqlite3
import struct
import zlib
from contextlib import closing

import numpy as np
from test_map_points import shapefile
from test_rasters import tifffile

STEP = 10.0  # from one height to the next
NONE = -99999.0  # no height
EAST, SOUTH = 500.0, 1000.0  # of the first column, of the last row


def heights(rows, columns):
    """(rows, columns) numbers of two decimals, from north to south, with some that mean no height."""
    row, column = np.mgrid[0:rows, 0:columns]
    z = ((row * 7919 + column * 104729) % 40009) / 4 - 5000  # exact in 32 bits, too
    z[(row * 31 + column * 17) % 113 == 0] = NONE
    return z


def points(z, from_south=False):
    """(P, 3) what is to be read of heights, as their rows stand in the file."""
    rows, columns = np.nonzero(z != NONE)
    y = SOUTH + (len(z) - 1 - rows) * STEP
    found = np.column_stack([EAST + columns * STEP, y, z[rows, columns]])
    return found[np.lexsort((found[:, 0], found[:, 1]))] if from_south else found


def _opened(path):
    """For text, in the encoding and with the line ends that its name says."""
    encoding = "utf-16" if path.name.startswith("utf-16") else "utf-8"
    return path.open("w", encoding=encoding, newline="\r" if path.name.startswith("old") else "\n")


def _text(head, z, path):
    with _opened(path) as file:
        file.write(head)
        np.savetxt(file, z, fmt="%.2f")


def _ascii_grid(z, path):
    rows, columns = z.shape
    head = f"ncols {columns}\nnrows {rows}\nxllcenter {EAST}\nyllcenter {SOUTH}\n"
    _text(f"{head}cellsize {STEP}\nNODATA_value {NONE}\n", z, path)


def _ends(z):
    rows, columns = z.shape
    return EAST, EAST + (columns - 1) * STEP, SOUTH, SOUTH + (rows - 1) * STEP


def _zmap(z, path):
    rows, columns = z.shape
    ends = ", ".join(map(str, _ends(z)))
    head = f"!\n@made GRID, GRID, 1\n20, {NONE}, , 2, 1\n{rows}, {columns}, {ends}\n0, 0, 0\n@\n"
    _text(head.replace("@made GRID,", "@made,"), z.T.reshape(-1, 1), path)


def _cps3(z, path):
    rows, columns = z.shape
    ends = " ".join(map(str, _ends(z)))
    head = f"FSASCI 0 1 COMPUTED 0 {NONE}\nFSLIMI {ends} -5000 5000\nFSNROW {rows} {columns}\n"
    _text(f"{head}FSXINC {STEP} {STEP}\n", z.T.reshape(-1, 1), path)


def _blank(z, value):
    return np.where(z == NONE, value, z)[::-1]


def _irap_text(z, path):
    rows, columns = z.shape
    west, east, south, north = _ends(z)
    head = f"-996 {rows} {STEP} {STEP}\n{west} {east} {south} {north}\n{columns} 0 {west} {south}\n"
    _text(f"{head}0 0 0 0 0 0 0\n", _blank(z, 9999900.0), path)


def _irap_binary(z, path):
    rows, columns = z.shape
    west, east, south, north = _ends(z)
    with path.open("wb") as file:
        file.write(struct.pack(">3i6fi", 32, -996, rows, west, east, south, north, STEP, STEP, 32))
        file.write(struct.pack(">2i3fi", 16, columns, 0, west, south, 16))
        file.write(struct.pack(">9i", 28, 0, 0, 0, 0, 0, 0, 0, 28))
        for row in _blank(z, 9999900.0).astype(">f4"):
            size = struct.pack(">i", row.nbytes)
            file.write(size + row.tobytes() + size)


def _surfer_text(z, path):
    rows, columns = z.shape
    west, east, south, north = _ends(z)
    head = f"DSAA\n{columns} {rows}\n{west} {east}\n{south} {north}\n-5000 5000\n"
    with path.open("w") as file:
        file.write(head)
        np.savetxt(file, _blank(z, 1.70141e38), fmt="%.6g")


def _surfer_6(z, path):
    rows, columns = z.shape
    head = struct.pack("<4s2h6d", b"DSBB", columns, rows, *_ends(z), -5000, 5000)
    path.write_bytes(head + _blank(z, 1.70141e38).astype("<f4").tobytes())


def _surfer_7(z, path):
    rows, columns = z.shape
    grid = struct.pack("<2i8d", rows, columns, EAST, SOUTH, STEP, STEP, -5000, 5000, 0, 1.70141e38)
    values = _blank(z, 1.70141e38).astype("<f8").tobytes()
    sections = ((b"DSRB", struct.pack("<i", 1)), (b"GRID", grid), (b"DATA", values))
    path.write_bytes(b"".join(name + struct.pack("<i", len(part)) + part for name, part in sections))


def _tiff(**options):
    def write(z, path):
        place = (33922, 12, 6, (0, 0, 0, EAST - STEP / 2, SOUTH + (len(z) - 0.5) * STEP, 0), True)
        tags = [(33550, 12, 3, (STEP, STEP, 0), True), place, (42113, 2, 0, str(NONE), True)]
        given = {"photometric": "minisblack", "extratags": tags, "metadata": None, **options}
        tifffile.imwrite(path, z.astype("f4"), **given)

    return write


def _table(z, path):
    with _opened(path) as file:
        np.savetxt(file, points(z), fmt="%.2f", delimiter=";", header="X;Y;Z", comments="")


def _lines(z):
    """The points as those of lines."""
    found = points(z)
    return np.split(found, range(300, len(found), 300))


def _shapefile(z, path):
    body = bytearray()
    for line in _lines(z):
        record = struct.pack("<i4d3i", 13, 0, 0, 0, 0, 1, len(line), 0) + line[:, :2].tobytes()
        record += struct.pack("<2d", 0, 0) + line[:, 2].tobytes()
        body += struct.pack(">2i", 1, len(record) // 2) + record
    head = struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + len(body)) // 2)
    path.write_bytes(head + struct.pack("<2i8d", 1000, 13, *8 * [0]) + body)


def _geopackage(z, path):
    head = b"GP" + bytes([0, 1]) + struct.pack("<i", 0)
    with closing(sqlite3.connect(path)) as base:
        base.execute("CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT)")
        base.execute("INSERT INTO gpkg_geometry_columns VALUES ('contours', 'shape')")
        base.execute("CREATE TABLE contours (shape BLOB)")
        for line in _lines(z):
            shape = head + struct.pack("<b2i", 1, 1002, len(line)) + line.tobytes()
            base.execute("INSERT INTO contours VALUES (?)", [shape])
        base.commit()


RASTERS = {
    "g.asc": _ascii_grid,
    "old.asc": _ascii_grid,
    "g.zmap": _zmap,
    "g.cps3": _cps3,
    "text.irap": _irap_text,
    "binary.irap": _irap_binary,
    "text.grd": _surfer_text,
    "6.grd": _surfer_6,
    "7.grd": _surfer_7,
}
TIFFS = {
    "strips.tif": _tiff(rowsperstrip=16),
    "strip.tif": _tiff(rowsperstrip=1 << 20),
    "tiles.tif": _tiff(tile=(64, 64), compression="zlib"),
}
TABLES = {"p.csv": _table, "utf-16.csv": _table, "p.npy": lambda z, path: np.save(path, points(z))}
FROM_SOUTH = ("text.irap", "binary.irap", "text.grd", "6.grd", "7.grd")
SHAPES = {"c.gpkg": _geopackage, **({"c.shp": _shapefile} if shapefile is not None else {})}
FORMATS = {**RASTERS, **(TIFFS if tifffile is not None else {}), **TABLES, **SHAPES}


def write_points(name, rows, columns, folder):
    """A file of heights in the format of FORMATS; the file, and the points in it."""
    z = heights(rows, columns)
    path = folder / name
    path.unlink(missing_ok=True)
    FORMATS[name](z, path)
    return path, points(z, name in FROM_SOUTH)


def lattice(rows, columns):
    """Vertices (V, 3) and triangles (T, 3) over a grid of points; heights have two decimals, and few are
    below zero."""
    row, column = np.mgrid[0:rows, 0:columns]
    z = ((row * 7919 + column * 104729) % 40009) / 4 - 50
    vertices = np.column_stack([EAST + column.ravel() * STEP, SOUTH + row.ravel() * STEP, z.ravel()])
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    a, b, c, d = corner, corner + 1, corner + columns + 1, corner + columns
    both = np.stack([np.column_stack([a, b, c]), np.column_stack([a, c, d])], axis=1)
    return vertices, both.reshape(-1, 3).astype(np.int32)


def _off(vertices, triangles, file):
    file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
    np.savetxt(file, vertices, fmt="%.2f")
    np.savetxt(file, triangles, fmt="3 %d %d %d")


def _obj(vertices, triangles, file):
    np.savetxt(file, vertices, fmt="v %.2f %.2f %.2f")
    np.savetxt(file, triangles + 1, fmt="f %d %d %d")


def _tsurf(vertices, triangles, file):
    file.write("GOCAD TSurf 1\nHEADER {\nname: top\n}\nTFACE\n")
    numbered = np.column_stack([np.arange(1, len(vertices) + 1), vertices])
    np.savetxt(file, numbered, fmt="VRTX %d %.2f %.2f %.2f")
    np.savetxt(file, triangles + 1, fmt="TRGL %d %d %d")
    file.write("END\n")


def _stl_text(vertices, triangles, file):
    file.write("solid top\n")
    vertex = "vertex %.2f %.2f %.2f\n"
    facet = f"facet normal 0 0 1\nouter loop\n{3 * vertex}endloop\nendfacet"
    np.savetxt(file, vertices[triangles].reshape(-1, 9), fmt=facet)
    file.write("endsolid top\n")


def _ply_text(vertices, triangles, file):
    file.write(_ply_head("ascii", vertices, triangles))
    np.savetxt(file, vertices, fmt="%.2f")
    np.savetxt(file, triangles, fmt="3 %d %d %d")


def _ply_head(kind, vertices, triangles):
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    faces = f"element face {len(triangles)}\nproperty list uchar int vertex_indices\n"
    return f"ply\nformat {kind} 1.0\nelement vertex {len(vertices)}\n{axes}{faces}end_header\n"


def _ply_binary(vertices, triangles, path):
    table = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    table["count"], table["corners"] = 3, triangles
    head = _ply_head("binary_little_endian", vertices, triangles).encode()
    path.write_bytes(head + vertices.astype("<f8").tobytes() + table.tobytes())


def _stl_binary(vertices, triangles, path):
    facet = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    facet["corners"] = vertices[triangles]
    path.write_bytes(b"made".ljust(80) + struct.pack("<I", len(triangles)) + facet.tobytes())


def _dxf(vertices, triangles, file):
    file.write("999\nmade\n0\nSECTION\n2\nENTITIES\n")
    corner = "".join(f"{10 + k}\n%.2f\n{20 + k}\n%.2f\n{30 + k}\n%.2f\n" for k in range(3))
    fourth = "13\n%.2f\n23\n%.2f\n33\n%.2f"
    corners = vertices[triangles[:, [0, 1, 2, 2]]].reshape(-1, 12)
    np.savetxt(file, corners, fmt=f"0\n3DFACE\n8\nA\n{corner}{fourth}")
    file.write("0\nENDSEC\n0\nEOF\n")


def _polyface(vertices, triangles, file):
    file.write("0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n70\n64\n")
    np.savetxt(file, vertices, fmt="0\nVERTEX\n10\n%.2f\n20\n%.2f\n30\n%.2f\n70\n192")
    np.savetxt(file, triangles + 1, fmt="0\nVERTEX\n70\n128\n71\n%d\n72\n%d\n73\n%d")
    file.write("0\nSEQEND\n0\nENDSEC\n0\nEOF\n")


def _landxml(vertices, triangles, file):
    file.write('<?xml version="1.0"?>\n<LandXML xmlns="a"><Surfaces><Surface name="top"><Pnts>\n')
    numbered = np.column_stack([np.arange(1, len(vertices) + 1), vertices[:, [1, 0, 2]]])
    np.savetxt(file, numbered, fmt='<P id="%d">%.2f %.2f %.2f</P>')
    file.write("</Pnts><Faces>\n")
    np.savetxt(file, triangles + 1, fmt="<F>%d %d %d</F>")
    file.write("</Faces></Surface></Surfaces></LandXML>\n")


def _gmsh_2(vertices, triangles, file):
    file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(vertices)}\n")
    np.savetxt(file, np.column_stack([np.arange(1, len(vertices) + 1), vertices]), fmt="%d %.2f %.2f %.2f")
    file.write(f"$EndNodes\n$Elements\n{len(triangles)}\n")
    numbered = np.column_stack([np.arange(1, len(triangles) + 1), triangles + 1])
    np.savetxt(file, numbered, fmt="%d 2 2 1 1 %d %d %d")
    file.write("$EndElements\n")


def _gmsh_4(vertices, triangles, path):
    tags, faces = np.arange(1, len(vertices) + 1), np.arange(1, len(triangles) + 1)
    with path.open("wb") as file:
        file.write(b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n$Nodes\n")
        file.write(struct.pack("<4Q3iQ", 1, len(tags), 1, len(tags), 2, 1, 0, len(tags)))
        file.write(tags.astype("<u8").tobytes() + vertices.astype("<f8").tobytes())
        file.write(b"\n$EndNodes\n$Elements\n")
        file.write(struct.pack("<4Q3iQ", 1, len(faces), 1, len(faces), 2, 1, 2, len(faces)))
        file.write(np.column_stack([faces, triangles + 1]).astype("<u8").tobytes() + b"\n$EndElements\n")


def _vtk(write):
    """A file of VTK; write: adds an array, and returns what stands in its element, and its attributes."""

    def written(vertices, triangles, path):
        appended = bytearray()

        def array(name, kind, values, more=""):
            attributes, text = write(values, appended)
            return f'<DataArray Name="{name}" type="{kind}" {more} {attributes}>{text}</DataArray>\n'

        ends = np.arange(3, 3 * len(triangles) + 1, 3)
        points = array("Points", "Float64", vertices.astype("<f8"), 'NumberOfComponents="3"')
        cells = array("connectivity", "Int32", triangles.astype("<i4")) + array("offsets", "Int64", ends)
        kinds = array("types", "UInt8", np.full(len(triangles), 5, np.uint8))
        compressor = 'compressor="vtkZLibDataCompressor"' if write is _vtk_packed else ""
        text = f'<VTKFile type="UnstructuredGrid" header_type="UInt64" {compressor}><UnstructuredGrid>\n'
        text += f"<Piece><Points>{points}</Points><Cells>{cells}{kinds}</Cells></Piece></UnstructuredGrid>\n"
        with path.open("wb") as file:
            file.write(text.encode())
            if appended:
                file.write(b'<AppendedData encoding="raw">_' + appended + b"</AppendedData>")
            file.write(b"</VTKFile>\n")

    return written


def _vtk_text(values, _appended):
    return 'format="ascii"', " ".join(map(str, values.ravel().tolist()))


def _vtk_base64(values, _appended):
    content = struct.pack("<Q", values.nbytes) + values.tobytes()
    return 'format="binary"', base64.b64encode(content).decode()


def _vtk_packed(values, appended):
    at, content = len(appended), values.tobytes()
    blocks = [zlib.compress(content[k : k + 32768]) for k in range(0, len(content), 32768)]
    appended += struct.pack(f"<{3 + len(blocks)}Q", len(blocks), 32768, 0, *map(len, blocks))
    appended += b"".join(blocks)
    return f'format="appended" offset="{at}"', ""


TEXT_MESHES = {
    "m.off": _off,
    "m.obj": _obj,
    "old.obj": _obj,
    "m.ts": _tsurf,
    "utf-16.ts": _tsurf,
    "m.dxf": _dxf,
    "polyface.dxf": _polyface,
    "m.xml": _landxml,
    "2.msh": _gmsh_2,
    "text.stl": _stl_text,
    "text.ply": _ply_text,
    "old.ply": _ply_text,
}
BY_PLACE = ("m.dxf", "polyface.dxf", "text.stl", "binary.stl")  # vertices in the order of their coordinates
BINARY_MESHES = {
    "binary.ply": _ply_binary,
    "binary.stl": _stl_binary,
    "4.msh": _gmsh_4,
    "text.vtu": _vtk(_vtk_text),
    "base64.vtu": _vtk(_vtk_base64),
    "packed.vtu": _vtk(_vtk_packed),
}
MESHES = {**TEXT_MESHES, **BINARY_MESHES}


def write_mesh(name, rows, columns, folder):
    """A file of a mesh in the format of MESHES; the file, its vertices and triangles."""
    mesh, path = lattice(rows, columns), folder / name
    if name in BINARY_MESHES:
        BINARY_MESHES[name](*mesh, path)
    else:
        with _opened(path) as file:
            TEXT_MESHES[name](*mesh, file)
    return path, *mesh
