# SPDX-License-Identifier: GPL-3.0-or-later
"""ESRI ASCII grids and GeoTIFF as points, and as the grid of method "grid"."""

from itertools import zip_longest

import numpy as np
import pytest
from damages import damaged_bytes
from realmodel.core import (
    BuildFailed,
    InputRefused,
    PointFile,
    Project,
    Rock,
    Surface,
    build,
    interpolate,
    load_project,
)
from realmodel.core.base.packages import vendored
from realmodel.core.readers import read_point_file
from realmodel.core.readers.rasters.geotiff import read_geotiff
from stacks import places

HEAD = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\n"
CELLS = [[105, 215, 1], [115, 215, 2], [125, 215, 3], [105, 205, 4], [125, 205, 6]]

try:
    tifffile = vendored("tifffile", "tifffile", "this test")
except BuildFailed:
    tifffile = None
needs_tifffile = pytest.mark.skipif(tifffile is None, reason="addon/realmodel/vendor has no tifffile")


@pytest.mark.parametrize(
    "text",
    [
        HEAD + "NODATA_value -9999\n1 2 3\n4 -9999 6\n",
        HEAD.upper() + "nodata_value -9999\r\n1 2 3 4\r\n-9999\r\n6",
        "nrows 2\nncols 3\nyllcenter 205\nxllcenter 105\ndx 10\ndy 10\nnodata_value -9999\n1 2 3 4\n-9999 6",
        HEAD.replace("100", "100,0") + "NODATA_value -9999\n1,0 2 3\n4 -9999 6\n",
        HEAD + "NODATA_value nan\n1 2 3\n4 nan 6\n",  # by GDAL, of a raster without heights there
        HEAD + "1 2 3\n4 -NaN 6\n",
        HEAD + "NODATA_value Null\n1 2 3\n4 null 6\n",
        HEAD + "NODATA_value void\n1 2 3\n4 void 6\n",
    ],
)
def test_ascii_grids(write, text):
    points, warnings = read_point_file(PointFile(write("g.asc", text)))
    assert points.tolist() == CELLS
    assert warnings == []


def test_an_ascii_grid_that_begins_without_a_height(write):
    points, _ = read_point_file(PointFile(write("g.asc", HEAD + "NODATA_value nan\nnan nan 3\n4 nan 6\n")))
    assert points[:, 2].tolist() == [3, 4, 6]


@needs_tifffile
def test_a_geotiff_in_another_system_than_the_project(tmp_path):
    path = tmp_path / "g.tif"
    keys = (1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 25832)
    tags = [(33550, 12, 3, (25.0, 25.0, 0.0), True), (33922, 12, 6, (0.0, 0, 0, -10.0, 110.0, 0), True)]
    tifffile.imwrite(path, np.full((5, 5), 7.0), extratags=[*tags, (34735, 3, len(keys), keys, True)])
    rock = Rock(
        "r",
        [Surface("s", points=path, method="plane")],
        region=[(0, 0), (100, 0), (100, 100), (0, 100)],
        edge_length=50.0,
        base_elevation=0.0,
    )
    for crs, said in (("EPSG:25833", 1), ("EPSG:25832", 0), (None, 0)):
        model = build(Project("p", [rock], crs=crs))
        assert sum("is in EPSG:25832" in str(warning) for warning in model.warnings) == said


def test_surfer_and_zmap_grids_with_nan(write):
    surfer = "DSAA\n3 2\n105 125\n205 215\nnan nan\n4 NAN 6\n1 2 3\n"
    of_other_lines = "DSAA\n3\n2 105 125\n\n205,215,1 6\n4 NAN 6 1\n2 3\n"
    zmap = "! Created by {}\n@g, GRID, 2\n 20, nan, , 7, 1\n 2, 3, {}\n0.0, 0.0, 0.0\n@\n1 4\n2 nan\n3 6\n"
    edges = zmap.format("GDAL.", "100, 130, 200, 220")  # GDAL gives those of its pixels
    middles = zmap.format("others", "105, 125, 205, 215")
    for text in (surfer, of_other_lines, edges, middles):
        points, _ = read_point_file(PointFile(write("g.dat", text)))
        assert sorted(points.tolist()) == sorted(CELLS)


@pytest.mark.parametrize("parts", ["\n\n\n\n\n", " \n \n\n", "       ", "\n\n\n\n\n\n\n\n"])
def test_a_surfer_header_stands_on_any_lines(write, parts):
    head = "".join(
        map(
            "".join,
            zip_longest(("DSAA", "3", "2", "105", "125", "205", "215", "1", "6"), parts, fillvalue=" "),
        )
    )
    points, _ = read_point_file(PointFile(write("g.grd", head + "\n4 nan 6\n1 2 3\n")))
    assert sorted(points.tolist()) == sorted(CELLS)
    line = (head + "\n4").count("\n") + 1
    with pytest.raises(InputRefused, match=rf"g.grd:{line}: not an elevation: 'x'"):
        read_point_file(PointFile(write("g.grd", head + "\n4 nan x\n1 2 3\n")))


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (HEAD + "1 2 3\n4 x 6\n", 7, "not an elevation: 'x'"),
        (HEAD + "1 2 3\nnan x 6\n", 7, "not an elevation: 'x'"),
        (HEAD + "1 2 3\n4 5\n", None, "6 elevations; there are 5"),
        (HEAD + "1 2 3\n4 5 6 7\n", None, "6 elevations; there are 7"),
        (HEAD + "NODATA_value 1\n1 1 1\n1 1 1\n", None, "no cell of the raster has an elevation"),
        ("ncols 3\nnrows 2.5\nxllcorner 1\n", 2, "nrows must be a whole number"),
        ("ncols 3\nrows 2\n", 2, "unknown key 'rows'"),
        ("ncols 3\nnrows\n", 2, "nrows needs one number"),
        ("ncols 3\nnrows 2\nxllcorner 0\ncellsize 1\n1 2 3 4 5 6\n", None, "neither yllcorner nor yllcenter"),
        ("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0\n1 2 3 4 5 6\n", 5, "cellsize above 0"),
        ("ncols 3\nxllcorner 0\n1 2 3\n", None, "no nrows"),
    ],
)
def test_ascii_grids_refused(write, text, line, words):
    path = write("g.asc", text)
    with pytest.raises(InputRefused) as raised:
        read_point_file(PointFile(path))
    assert words in str(raised.value)
    assert (raised.value.file, raised.value.line) == (path, line)


def test_a_raster_has_no_columns(write):
    with pytest.raises(InputRefused, match="'where' has no effect"):
        read_point_file(PointFile(write("g.asc", HEAD + "1 2 3\n4 5 6\n"), where={"val": 1}))


def test_a_raster_in_feet(write):
    path = write("g.asc", HEAD + "1 2 3\n4 -9999 6\n")
    points, _ = read_point_file(PointFile(path, units={"z": "ft"}, nodata=-9999))
    np.testing.assert_allclose(points, np.array(CELLS) * [1, 1, 0.3048])


def test_a_raster_is_a_grid_of_method_grid(write):
    """Bilinear heights of a tilted plane between the cells' centers are the plane's."""
    rows = [" ".join(f"{2 * (5 + 10 * c) - (45 - 10 * r):.1f}" for c in range(6)) for r in range(5)]
    text = "ncols 6\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\n" + "\n".join(rows)
    write("dtm.asc", text)
    path = write(
        "p.toml",
        'format = 1\nname = "x"\n[[rock]]\nname = "r"\nregion = [[10, 10], [50, 10], [50, 40], [10, 40]]\n'
        'edge_length = 7\nbase_elevation = -100\n[[rock.surface]]\nname = "S0"\npoints = "dtm.asc"\n'
        'method = "grid"\n',
    )
    vertices = build(load_project(path)).surface_vertices
    np.testing.assert_allclose(vertices[:, 2], 2 * vertices[:, 0] - vertices[:, 1], atol=1e-9)


PLACE = [(33550, 12, 3, (2.0, 3.0, 0.0), True), (33922, 12, 6, (0, 0, 0, 100.0, 200.0, 0.0), True)]


def write_tiff(path, z, place=PLACE, extra=(), **options):
    tifffile.imwrite(path, z, photometric="minisblack", extratags=[*place, *extra], metadata=None, **options)
    return path


@needs_tifffile
@pytest.mark.parametrize("kind", ["u1", "i2", "u2", "i4", "f4", "f8"])
@pytest.mark.parametrize(
    "options",
    [
        {"rowsperstrip": 7},
        {"tile": (16, 32), "byteorder": ">"},
        {"rowsperstrip": 5, "compression": "zlib", "bigtiff": True},
        {"tile": (64, 48), "compression": "zlib", "byteorder": ">"},
    ],
)
def test_tiff_of_every_make(tmp_path, kind, options):
    z = (40 + 30 * np.random.default_rng(1).normal(size=(83, 51)).clip(-1, 1)).astype(kind)
    raster = read_geotiff(write_tiff(tmp_path / "z.tif", z, **options))
    assert np.array_equal(raster.z, z)
    points = raster.points(tmp_path / "z.tif")
    assert points[0].tolist() == [101.0, 198.5, float(z[0, 0])]
    assert points[-1].tolist() == [100 + 2 * 50.5, 200 - 3 * 82.5, float(z[-1, -1])]


_FREE_TAG = 65100  # tifffile writes a predictor only where it does it itself


def compressed_lzw(data):
    """LZW as TIFF 6.0, section 13 has it."""
    out, held, bits = bytearray(), 0, 0
    table, width, word = {}, 9, b""

    def put(code):
        nonlocal held, bits
        bits, held = bits << width | code, held + width
        while held >= 8:
            held -= 8
            out.append(bits >> held & 255)
        bits &= (1 << held) - 1

    def code_of(word):
        return word[0] if len(word) == 1 else table[word]

    put(256)
    for byte in data:
        longer = word + bytes([byte])
        if len(longer) == 1 or longer in table:
            word = longer
            continue
        put(code_of(word))
        table[longer] = 258 + len(table)
        width = max(9, (258 + len(table)).bit_length())
        if 258 + len(table) == 4095:
            put(256)
            table, width = {}, 9
        word = bytes([byte])
    put(code_of(word))
    width = max(width, (259 + len(table)).bit_length())
    put(257)
    if held:
        out.append(bits << (8 - held) & 255)
    return bytes(out)


def shuffled(z):
    """Floating-point numbers as predictor 3 has them: bytes by weight, each less the one before."""
    size = z.dtype.itemsize
    planes = z.astype(z.dtype.newbyteorder(">")).view(np.uint8).reshape(len(z), -1, size)
    planes = planes.transpose(0, 2, 1).reshape(len(z), -1)
    return np.diff(planes, axis=1, prepend=np.uint8(0)).astype(np.uint8).tobytes()


@needs_tifffile
@pytest.mark.parametrize(("kind", "predictor"), [("i2", 1), ("i2", 2), ("f4", 1), ("f4", 2), ("f4", 3)])
def test_lzw_and_predictors(tmp_path, kind, predictor):
    """What the packages at hand cannot write without a compiled one: laid into an uncompressed file."""
    z = np.round(np.random.default_rng(2).normal(size=(40, 50)).cumsum(axis=1) * 8).astype(kind)
    plain = {
        1: z.tobytes(),
        2: np.diff(z.view(f"u{z.itemsize}"), axis=1, prepend=z.view(f"u{z.itemsize}")[:, :1] * 0).tobytes(),
        3: shuffled(z) if kind == "f4" else b"",
    }[predictor]
    data = compressed_lzw(plain)
    extra = [(_FREE_TAG, 3, 1, predictor, True)]
    stored = np.zeros((40, 50), kind)
    path = write_tiff(tmp_path / "z.tif", stored, extra=extra, rowsperstrip=40)
    with tifffile.TiffFile(path) as tiff:
        tags = tiff.pages[0].tags
        offset = tiff.pages[0].dataoffsets[0]
        places = {name: tags[name].valueoffset for name in ("Compression", "StripByteCounts")}
    raw = bytearray(path.read_bytes())
    tag = raw.find(_FREE_TAG.to_bytes(2, "little") + b"\3\0\1\0\0\0")
    raw[tag : tag + 2] = (317).to_bytes(2, "little")
    assert len(data) <= len(plain) + 100
    raw[places["Compression"] : places["Compression"] + 2] = (5).to_bytes(2, "little")
    raw[places["StripByteCounts"] : places["StripByteCounts"] + 4] = len(data).to_bytes(4, "little")
    raw[offset : offset + len(data)] = data
    path.write_bytes(raw)
    assert np.array_equal(read_geotiff(path).z, z)


@needs_tifffile
def test_nodata_scale_and_place(tmp_path):
    z = np.array([[1, 2], [-32768, 4]], np.int16)
    turned = [(34264, 12, 16, (0, 2, 0, 10, 3, 0, 0, 20, 0, 0, 0, 0, 0, 0, 0, 1), True)]
    scale = '<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.5</Item></GDALMetadata>'
    extra = [(42113, 2, 0, "-32768", True), (42112, 2, 0, scale, True)]
    path = write_tiff(tmp_path / "z.tif", z, place=turned, extra=extra)
    points, _ = read_point_file(PointFile(path))
    assert points.tolist() == [[11, 21.5, 0.5], [11, 24.5, 1.0], [13, 24.5, 2.0]]

    at_corners = [(34735, 3, 8, (1, 1, 0, 1, 1025, 0, 1, 2), True)]
    points, _ = read_point_file(PointFile(write_tiff(tmp_path / "p.tif", z, extra=at_corners), nodata=-32768))
    assert points[:, :2].tolist() == [[100, 200], [102, 200], [102, 197]]

    bare = write_tiff(tmp_path / "w.tif", z, place=[])
    with pytest.raises(InputRefused, match="has no georeference"):
        read_point_file(PointFile(bare))
    (tmp_path / "w.tfw").write_text("2\n0\n0\n-3\n101\n198.5\n")
    points, _ = read_point_file(PointFile(bare, nodata="none"))
    assert points[:, :2].tolist() == [[101, 198.5], [103, 198.5], [101, 195.5], [103, 195.5]]

    lowest = np.array([[np.finfo(np.float32).min, 2], [3, 4]], np.float32)
    for written in ("-3.4028234663852886e+38", "-3.402823e+38"):
        path = write_tiff(tmp_path / "f.tif", lowest, extra=[(42113, 2, 0, written, True)])
        assert len(read_point_file(PointFile(path))[0]) == 3


@needs_tifffile
def test_tiff_refused(tmp_path):
    path = tmp_path / "z.tif"
    for z, words in (
        (np.zeros((4, 5, 3), np.uint8), "3 numbers per pixel"),
        (np.zeros((4, 5), np.complex64), "of 64 bits are not supported"),
    ):
        photometric = {} if z.ndim == 2 else {"planarconfig": "contig"}
        tifffile.imwrite(path, z, photometric="minisblack", extratags=PLACE, **photometric)
        with pytest.raises(InputRefused, match=words):
            read_geotiff(path)
    whole = write_tiff(path, np.ones((40, 50), np.float32), compression="zlib").read_bytes()
    for raw in damaged_bytes(whole, 8):
        path.write_bytes(raw)
        try:
            read_geotiff(path)
        except InputRefused as error:
            assert "\n" not in str(error)


def test_without_tifffile(monkeypatch, write):
    monkeypatch.setattr(
        "importlib.import_module", lambda name: (_ for _ in ()).throw(ModuleNotFoundError(name=name))
    )
    with pytest.raises(BuildFailed, match=r"tifffile.*scripts/build\.sh"):
        read_point_file(PointFile(write("z.tif", b"II*\0")))


@pytest.mark.skipif(not places.REAL_DATA.is_dir(), reason=places.DATA_ABSENT)
@needs_tifffile
def test_real_rasters():
    """Hamersley's elevation, and pleasant's lake floor, which is compressed by LZW."""
    points, _ = read_point_file(PointFile(places.REAL_DATA / "hamersley" / "dtm_rp.tif"))
    assert points.shape == (40079, 3)
    assert (points[:, 2].min(), points[:, 2].max()) == (297, 1175)
    at = interpolate(points, points[:100, :2], method="grid")
    np.testing.assert_allclose(at.z, points[:100, 2], atol=1e-6)
    points, _ = read_point_file(PointFile(places.REAL_DATA / "pleasant" / "pleasant_bathymetry.tif"))
    assert points.shape == (153 * 205, 3)
    assert points[:, 2].max() == pytest.approx(7.58682251, abs=1e-7)
    _, warnings = read_point_file(PointFile(places.REAL_DATA / "pleasant" / "dem40m.tif"))
    assert "degrees" in warnings[0]
