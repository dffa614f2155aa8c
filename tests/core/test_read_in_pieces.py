# SPDX-License-Identifier: GPL-3.0-or-later
"""Files read, and surfaces compared, piece by piece: the same values wherever they are kept, in memory that
does not grow."""

import errno
import json
import os
import sqlite3
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from large_files import BY_PLACE, FORMATS, MESHES, SHAPES, write_mesh, write_points
from realmodel.core import InputRefused, MeshFile, OutputFailed, PointFile
from realmodel.core.base.mapped_arrays import ROWS_AT_ONCE, MappedArrays
from realmodel.core.base.text import (
    BYTES_AT_ONCE,
    FileBytes,
    content_of,
    encoding_of,
    pieces_of,
    read_text,
    text_content,
    text_lines,
)
from realmodel.core.readers import read_mesh, read_point_file

IN_PIECES = [name for name in MESHES if name.endswith((".off", ".ply"))]  # other meshes are read whole
WHOLE = (*SHAPES, "utf-16.csv", "old.asc", "old.ply")  # shapes, UTF-16, and lines of old Macs
COMMON = f"""
import json, resource, sys, tracemalloc
from pathlib import Path
sys.path[:0] = {[str(ROOT / "addon"), str(Path(__file__).parent)]}
from large_files import *
from realmodel.core import PointFile, Surface
from realmodel.core.base.mapped_arrays import MappedArrays, read_mapped
from realmodel.core.readers import read_point_file
from realmodel.core.readers.tables import points as tables
from realmodel.distributed.tile_inputs import _read
from realmodel.core.surfaces.surface_input import SurfaceInput
tables._MOST_THREADS = 1  # each has a piece of its own
folder = Path(sys.argv[1])
"""


def in_a_process(script, *arguments):
    """What a script of its own prints, as JSON."""
    done = subprocess.run(
        [sys.executable, "-c", COMMON + script, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", FORMATS)
def test_points_are_the_same_in_a_file(tmp_path, name):
    """Larger than a piece; and each height, and only these, at its place."""
    file, expected = write_points(name, 390, 410, tmp_path)
    points, warnings = read_point_file(PointFile(file, units={"z": "ft"}, z_axis="down"))
    assert np.array_equal(points[:, :2], expected[:, :2])
    assert np.array_equal(points[:, 2], expected[:, 2] * 0.3048 * -1.0)
    with MappedArrays(tmp_path / "arrays") as arrays:
        given = PointFile(file, units={"z": "ft"}, z_axis="down")
        kept, warnings_of_kept = read_point_file(given, gather=arrays.gather)
        assert isinstance(kept, np.memmap) and kept.tobytes() == points.tobytes()
        assert warnings_of_kept == warnings


@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_is_the_same_in_a_file(tmp_path, name):
    """Larger than a piece: of rows where these are gathered, of bytes where the mesh is read whole."""
    size = (300, 310) if name in IN_PIECES else (130, 140)
    file, vertices, triangles = write_mesh(name, *size, tmp_path)
    assert len(triangles) > ROWS_AT_ONCE * 2 or (
        name not in IN_PIECES and triangles.nbytes + vertices.nbytes > BYTES_AT_ONCE
    )
    mesh = read_mesh(file)
    if name in BY_PLACE:
        assert np.array_equal(np.unique(vertices, axis=0), mesh.vertices)
        assert np.array_equal(mesh.vertices[mesh.triangles], vertices[triangles])
    else:
        assert np.array_equal(mesh.vertices, vertices) and np.array_equal(mesh.triangles, triangles)
    assert mesh.face_of_triangle is None
    given = MeshFile(file, units="ft", z_axis="down")
    in_model, _ = mesh.in_model(given, "m")
    with MappedArrays(tmp_path / "arrays") as arrays:
        kept = read_mesh(file, rows=arrays.rows)
        for one, other in ((kept.vertices, mesh.vertices), (kept.triangles, mesh.triangles)):
            assert isinstance(one, np.memmap) == (name in IN_PIECES) and one.dtype == other.dtype
            assert one.tobytes() == other.tobytes()
        assert kept.in_model(given, "m", arrays.gather)[0].tobytes() == in_model.tobytes()


def test_shapes_of_several_kinds(tmp_path):
    """Points come first, whatever their order in the file."""
    _, z = write_points("c.gpkg", 15, 20, tmp_path)
    with sqlite3.connect(tmp_path / "c.gpkg") as base:
        for k in range(250):
            shape = b"GP" + bytes([0, 1]) + struct.pack("<ibi3d", 0, 1, 1001, k, -k, k / 4)
            base.execute("INSERT INTO contours VALUES (?)", [shape])
    base.close()
    k = np.arange(250.0)
    expected = np.concatenate([np.column_stack([k, -k, k / 4]), z])
    points, warnings = read_point_file(PointFile(tmp_path / "c.gpkg", nodata=0.25))
    assert np.array_equal(points, expected[expected[:, 2] != 0.25])
    assert (expected[:, 2] == 0.25).sum() == 1
    assert warnings == [f"{tmp_path / 'c.gpkg'}: left out: 1 point without a value"]


def test_nodes_whose_numbers_do_not_ascend(tmp_path):
    """Triangles, and quadrangles between them, which come last; some are concave."""
    _, vertices, triangles = write_mesh("m.off", 20, 21, tmp_path)
    tags = np.random.default_rng(1).permutation(len(vertices)) * 3 + 1
    nodes = [f"{tag} {x} {y} {z}" for tag, (x, y, z) in zip(tags, vertices.tolist(), strict=True)]
    faces = [[*face, face[0] + 2] if n % 9 == 0 else face for n, face in enumerate(triangles.tolist())]
    elements = [f"{n} {len(f) - 1} 0 {' '.join(map(str, tags[f]))}" for n, f in enumerate(faces, 1)]
    file = tmp_path / "m.msh"
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", len(nodes), *nodes, "$EndNodes"]
    text += ["$Elements", len(elements), *elements, "$EndElements"]
    file.write_text("\n".join(map(str, text)))
    expected = [
        [f[0], f[k], f[k + 1]] for size in (3, 4) for f in faces if len(f) == size for k in range(1, size - 1)
    ]
    used, mesh = np.unique(expected), read_mesh(file)
    assert np.array_equal(mesh.vertices, vertices[used])
    count = sum(len(f) == 3 for f in faces)
    assert np.array_equal(used[mesh.triangles[:count]], expected[:count])
    corners = [np.unique(used[mesh.triangles[k : k + 2]]) for k in range(count, len(expected), 2)]
    assert np.array_equal(corners, [np.unique(expected[k : k + 2]) for k in range(count, len(expected), 2)])


def test_larger_faces_among_those_of_a_drawing(tmp_path):
    """Triangles, and faces of four corners."""
    _, vertices, triangles = write_mesh("m.off", 26, 27, tmp_path)
    text = ["0\nSECTION\n2\nENTITIES"]
    expected = []
    for number, (a, b, c) in enumerate(vertices[triangles].tolist()):
        corners = [a, b, c] if number % 7 else [a, b, c, (np.array(a) + c - b).tolist()]
        given = [*corners, corners[-1]][:4]
        values = (
            f"{10 * (axis + 1) + k}\n{place[axis]}" for k, place in enumerate(given) for axis in range(3)
        )
        text += ["0\n3DFACE", *values]
        expected += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    file = tmp_path / "m.dxf"
    file.write_text("\n".join([*text, "0\nENDSEC\n0\nEOF\n"]))
    mesh = read_mesh(file)
    assert mesh.vertices[mesh.triangles].tolist() == expected
    assert np.array_equal(mesh.vertices, np.unique(mesh.vertices, axis=0))
    assert mesh.face_of_triangle[:4].tolist() == [0, 0, 1, 2]


def test_names_of_points_that_are_no_numbers(write):
    """And numbers that are written in several ways: these are names, too."""
    points = {"a b": "0 0 1", "01": "0 10 1", "1": "10 0 1", "7": "10 10 2", "4": "5 5 9", "x": "0 3 3"}
    pnts = "".join(f'<P id="{name}">{place}</P>' for name, place in points.items())
    faces = "<F>01 1 7</F><F i='1'>no such</F><F>4 x 1 9</F>"
    text = f"<LandXML><Surfaces><Surface name='s'><Pnts>{pnts}</Pnts>{faces}</Surface></Surfaces></LandXML>"
    mesh = read_mesh(write("m.xml", text))
    assert mesh.triangles.tolist() == [[0, 1, 2], [3, 4, 1]]
    assert mesh.vertices[0].tolist() == [10, 0, 1]  # the first that a face uses
    for missing in ("2", "001", "0", "8"):
        with pytest.raises(InputRefused, match=f"surface 's': '1 7 {missing}' cannot be read"):
            read_mesh(write("m.xml", text.replace("<F>01 1 7<", f"<F>1 7 {missing}<")))


def test_larger_faces_late_in_a_mesh(tmp_path):
    """The triangles know their faces from the first larger one on, and before."""
    vertices = "".join(f"{n % 7} {n % 11} 0\n" for n in range(60_000))
    faces = "3 0 1 2\n" * 70_000 + "4 0 1 2 3\n" + "3 3 4 5\n" * 30_000
    file = tmp_path / "m.off"
    file.write_text(f"OFF\n60000 100001 0\n{vertices}{faces}")
    with MappedArrays(tmp_path / "arrays") as arrays:
        for mesh in (read_mesh(file), read_mesh(file, rows=arrays.rows)):
            assert len(mesh.triangles) == 100_002 and len(mesh.vertices) == 60_000
            assert np.array_equal(mesh.face_of_triangle, np.insert(np.arange(100_001), 70_001, 70_000))
        file.write_text(f"OFF\n60000 200003 0\n{vertices}{faces}3 3 4 60000\n{faces}")
        with pytest.raises(InputRefused, match=r"m\.off:160004: face 100002 has a corner that is no vertex"):
            read_mesh(file, rows=arrays.rows)


def test_numbers_of_vertices_that_jump(write):
    """Gaps, numbers that come late, and numbers that come again in another surface."""
    head = "GOCAD TSurf 1\nHEADER {name:s}\nTFACE\n"
    first = "".join(f"VRTX {number} {k} {k % 2} 0\n" for k, number in enumerate([3, 4, 5, 9, 10, 2]))
    other = "ATOM 1 10\nVRTX 4 7 7 7\nTRGL 3 4 5\nTRGL 9 2 1\nEND\n"
    again = head + "VRTX 1 9 9 9\nVRTX 2 8 9 9\nVRTX 3 9 8 9\nTRGL 1 2 3\nEND\n"
    mesh = read_mesh(write("m.ts", head + first + other + again))
    assert mesh.triangles.tolist() == [[0, 5, 1], [2, 4, 3], [6, 7, 8]]
    for missing in (1, 6, 8, 11):
        text = head + first + f"TRGL 3 4 {missing}\nEND\n"
        with pytest.raises(InputRefused, match=rf"m\.ts:10: 'TRGL 3 4 {missing}' cannot be read"):
            read_mesh(write("m.ts", text))


MEMORY = """
def peak(name, scale):
    if name in MESHES:
        surface = Surface("S", mesh=write_mesh(name, 90 * scale, 90 * scale, folder)[0])
    else:
        surface = Surface("S", points=PointFile(write_points(name, 200 * scale, 200 * scale, folder)[0]))
    with MappedArrays(folder / "arrays") as arrays:
        surface = SurfaceInput("rock", surface, None, None, [], "m")
        tracemalloc.start()
        _read(arrays.folder, (0, surface))
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return found
print(json.dumps([peak(sys.argv[2], scale) for scale in (1, 2, 3)]))  # the first one loads modules
"""


@pytest.mark.parametrize("name", [name for name in (*FORMATS, *IN_PIECES) if name not in WHOLE])
def test_memory_does_not_grow_with_the_file(tmp_path, name):
    """As a worker reads it; more than twice the points or triangles, both more than a few pieces."""
    _, small, large = in_a_process(MEMORY, tmp_path, name)
    assert large < 1.25 * small, (small, large)


LIMITED = """
def limited(file):
    status = Path("/proc/self/status").read_text()
    now = int(status.split("VmData:")[1].split()[0]) * 1024
    resource.setrlimit(resource.RLIMIT_DATA, (now + 100_000_000,) * 2)
    surface = SurfaceInput("rock", Surface("S", points=PointFile(file)), None, None, [], "m")
    with MappedArrays(folder / "arrays") as arrays:
        found = _read(arrays.folder, (0, surface))
        count = len(arrays.opened(found.surface.points))
    try:
        surface.read()
        return count, "fits"
    except MemoryError:
        return count, "does not fit"
file, points = write_points("6.grd", 2000, 4000, folder)
expected = len(points)
del points
print(json.dumps([expected, *limited(file)]))
"""


needs_a_limit = pytest.mark.skipif(
    not Path("/proc/self/status").is_file(), reason="a limit that counts no mapped files"
)


@needs_a_limit
def test_a_raster_is_read_in_less_memory_than_its_points_take(tmp_path):
    expected, count, whole = in_a_process(LIMITED, tmp_path)
    assert count == expected and 24 * count > 150_000_000
    assert whole == "does not fit"


JOINED = """
from realmodel.core import Project, Rock, build_surfaces
from realmodel.core.base.work import run
from realmodel.core.tiles.windows import _joined
import numpy as np

def surfaces(count, arrays):
    # every second one written with other digits
    found = []
    for number in range(count):
        vertices, triangles = map(arrays.keep, lattice(300, 300))
        if number % 2:
            x, *others = vertices.T
            vertices = arrays.keep(np.column_stack([np.nextafter(x, 1e9), *others]))
        found.append(Surface(str(number), vertices, triangles))
    return build_surfaces(Project("p", [Rock("r", found)])).rock_inputs

def joined(inputs, arrays):
    return run(lambda work: _joined(work, inputs, arrays.keep, borders=True))

with MappedArrays(folder / "arrays") as arrays:
    joined(surfaces(2, arrays), arrays)  # the libraries and threads are there then
    given = surfaces(20, arrays)
    status = Path("/proc/self/status").read_text()
    now = int(status.split("VmData:")[1].split()[0]) * 1024
    resource.setrlimit(resource.RLIMIT_DATA, (now + 150_000_000, -1))
    [entry], text = joined(given, arrays)
    expected = lattice(300, 300)
    print(json.dumps([text, [all(map(np.array_equal, shape, expected)) for shape in entry.surfaces]]))
"""


@needs_a_limit
def test_borders_are_joined_in_less_memory_than_the_surfaces_take(monkeypatch, tmp_path):
    """All at once they take more than 400 MB when they are checked."""
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    text, are_joined = in_a_process(JOINED, tmp_path)
    assert text.startswith("plan coordinates merged that differ only by rounding: 300;")
    assert are_joined == [True] * 20


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="a system that cannot reserve room")
def test_room_on_a_full_disk(monkeypatch, tmp_path):
    """Is warnings when the room is made, not when it is written to; disks that reserve nothing do no harm."""

    def refused(number):
        def reserve(*_):
            raise OSError(number, os.strerror(number))

        return reserve

    with MappedArrays(tmp_path / "arrays") as arrays:
        monkeypatch.setattr(os, "posix_fallocate", refused(errno.ENOSPC))
        with pytest.raises(OutputFailed, match="No space left on device; make room"):
            arrays.zeros((5, 2), float)
        monkeypatch.setattr(os, "posix_fallocate", refused(errno.EOPNOTSUPP))
        found = arrays.zeros((5, 2), float)
        found[3] = 7
        assert found.sum() == 14


def test_a_file_as_bytes(tmp_path):
    file = tmp_path / "f"
    given = b"".join(b"line %d\n" % n for n in range(200_000)) + b"end"
    file.write_bytes(given)
    found = FileBytes(file)
    assert len(found) == len(given)
    for part in (slice(0, 5), slice(-4, None), slice(7, 3), slice(1_000_000, 1_000_050), slice(None)):
        assert found[part] == given[part]
    for begin, end in ((0, None), (1_999_990, None), (len(given) - 3, None), (0, 3), (900, 12_000)):
        assert found.find(b"\n", begin, end) == given.find(b"\n", begin, end)
    assert found.find(b"!") == -1
    assert found.count(b"\n", 10, 1_500_000) == given.count(b"\n", 10, 1_500_000)
    pieces = list(pieces_of(found, 7))
    assert b"".join(piece for _, piece in pieces) == given[7:]
    assert all(piece.endswith(b"\n") for _, piece in pieces[:-1]) and len(pieces) > 3
    file.write_bytes(given[:100])
    with pytest.raises(InputRefused, match="was truncated"):
        found[50:200]
    with pytest.raises(InputRefused, match="cannot be read"):
        FileBytes(tmp_path / "missing")


@pytest.mark.parametrize("begin", range(5))
def test_the_encoding_is_that_of_the_whole_file(tmp_path, begin):
    """Letters of several bytes across the ends of pieces."""
    file = tmp_path / "f"
    text = "a" * ((1 << 19) - begin) + "äöü€" * 100 + "b" * (1 << 19)
    file.write_text(text, encoding="utf-8")
    assert encoding_of(FileBytes(file)) == "utf-8"
    file.write_bytes(text.encode() + "ä".encode()[:1])
    assert encoding_of(FileBytes(file)) == "cp1252"
    file.write_bytes("ä".encode("latin-1") + text.encode())
    assert encoding_of(FileBytes(file)) == "cp1252"


def test_lines_of_old_machines(tmp_path):
    file = tmp_path / "f"
    file.write_bytes(b"1 2\r3 4\r")
    assert text_content(file)[:] == b"1 2\n3 4\n"
    file.write_bytes("1 2\r\n".encode("utf-16"))
    assert text_content(file)[:] == b"1 2\r\n"
    lines = [f"{n} \u00e4" for n in range(200_000)]
    ends = ("\r", "\n", "\r\n")
    for text in ("\r\n".join(lines), "".join(line + ends[n % 3] for n, line in enumerate(lines)), "a\r", ""):
        for encoding in ("utf-8", "utf-16", "latin-1"):
            file.write_bytes(text.encode(encoding))
            assert [line for _, some, _ in text_lines(file) for line in some] == (
                read_text(file).split("\n") if text else []
            )
            assert all(len(some) < 150_000 for _, some, _ in text_lines(file))


@pytest.mark.parametrize("codec", ["utf-16-le", "utf-16-be"])
def test_text_in_utf_16(tmp_path, codec):
    file = tmp_path / "f"
    text = "\ufeffa\U0001f30d\u20acb\n"
    file.write_bytes(text.encode(codec))
    assert content_of(file)[:] == text[1:].encode()
    for damaged in (text.encode(codec)[:-1], text.encode(codec) + "\ud83c".encode(codec, "surrogatepass")):
        file.write_bytes(damaged)
        with pytest.raises(InputRefused, match="damaged UTF-16 text"):
            content_of(file)


def test_decimal_commas_late_in_a_large_table(tmp_path):
    """What is read is read once more, and nothing of the first attempt is left."""
    rows = "1 2 3\n" * 150_000 + "1 2 4,5\n"
    file = tmp_path / "p.txt"
    file.write_text(rows)
    with MappedArrays(tmp_path / "arrays") as arrays:
        points, _ = read_point_file(PointFile(file), gather=arrays.gather)
        assert len(points) == 150_001 and points[-1].tolist() == [1, 2, 4.5]


def test_what_is_wrong_late_in_a_file_has_its_line(tmp_path):
    file = tmp_path / "p.csv"
    file.write_text("x,y,z\n" + "1,2,3\n" * 200_000 + "1,2,three\n" + "1,2,3\n" * 200_000)
    with pytest.raises(InputRefused, match=r"p\.csv:200002: z is not a number: 'three'"):
        read_point_file(PointFile(file))
    file = tmp_path / "g.asc"
    heights = "1 2 3\n" * 200_000 + "1 x 3\n" + "1 2 3\n" * 199_999
    file.write_text("ncols 3\nnrows 400000\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + heights)
    with pytest.raises(InputRefused, match=r"g\.asc:200006: not an elevation: 'x'"):
        read_point_file(PointFile(file))
