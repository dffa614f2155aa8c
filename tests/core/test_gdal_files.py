# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters and shapes in formats that are read by GDAL, and what is said where it is missing."""

import importlib
import shutil

import numpy as np
import pytest
from realmodel.core import InputRefused, MapLayer, PointFile, UsageError
from realmodel.core.readers import read_point_file, read_region, read_shapes
from realmodel.core.readers.contents import layer_names

rasterio = pytest.importorskip("rasterio")
pyogrio = pytest.importorskip("pyogrio")

HEIGHTS = np.array([[1.5, 2.0, -9999.0], [4.0, 5.0, 6.0]], np.float32)
DRIVERS = {
    "dem.img": ("HFA", {}),
    "dem.bil": ("EHdr", {}),
    "dem.rst": ("RST", {}),
    "dem.ers": ("ERS", {}),
}
RING = np.array([[10.0, 20.0], [11.0, 20.0], [11.0, 22.0], [10.0, 22.0]])


def write_raster(path, driver, crs="EPSG:25832", heights=HEIGHTS, place=(1000.0, 2000.0), **options):
    rows, columns = heights.shape[-2:]
    where = rasterio.Affine(10.0, 0.0, place[0], 0.0, -5.0, place[1])
    profile = {"height": rows, "width": columns, "count": 1 if heights.ndim == 2 else len(heights)}
    profile |= {"dtype": heights.dtype, "crs": crs, "transform": where, "nodata": -9999.0}
    with rasterio.open(path, "w", driver=driver, **profile, **options) as dataset:
        dataset.write(heights, *([1] if heights.ndim == 2 else []))


def wkb(ring):
    closed = np.concatenate([ring, ring[:1]])
    head = np.array([3, 1, len(closed)], "<u4").tobytes()
    return b"\x01" + head + closed.astype("<f8").tobytes()


def write_shapes(path, driver, layer="units", append=False, crs="EPSG:25832"):
    pyogrio.raw.write(
        path,
        np.array([wkb(RING), wkb(RING + 5.0)], object),
        [np.array(["sand", "clay"], object)],
        ["unit"],
        layer=layer,
        driver=driver,
        geometry_type="Polygon",
        crs=crs,
        append=append,
    )


@pytest.mark.parametrize("name", DRIVERS)
def test_raster_is_read_at_the_centers_of_its_pixels(tmp_path, name):
    driver, options = DRIVERS[name]
    try:
        write_raster(tmp_path / name, driver, **options)
    except rasterio.errors.RasterioError as error:
        pytest.skip(f"this GDAL does not write it: {error}")
    points, _ = read_point_file(PointFile(tmp_path / name, nodata=-9999))
    expected = [
        (1005, 1997.5, 1.5),
        (1015, 1997.5, 2),
        (1005, 1992.5, 4),
        (1015, 1992.5, 5),
        (1025, 1992.5, 6),
    ]
    assert np.allclose(points, expected, atol=1e-3)


def test_a_dem_of_usgs_is_known_by_its_header(tmp_path):
    """It is a text whose first word may be anything."""
    y, x = np.mgrid[:4, :5]
    write_raster(tmp_path / "a.tif", "GTiff", "EPSG:26713", (100 + x + y).astype("f4"))
    try:
        importlib.import_module("rasterio.shutil").copy(
            tmp_path / "a.tif", tmp_path / "elevations", driver="USGSDEM"
        )
    except rasterio.errors.RasterioError as error:
        pytest.skip(f"this GDAL does not write it: {error}")
    points, _ = read_point_file(PointFile(tmp_path / "elevations"))
    assert sorted(set(points[:, 2].tolist())) == [100.0 + height for height in range(8)]


@pytest.mark.parametrize(
    ("name", "driver"),
    [
        ("a.fgb", "FlatGeobuf"),
        ("a.gml", "GML"),
        ("a.tab", "MapInfo File"),
        ("a.mif", "MapInfo File"),
    ],
)
def test_shapes_are_read_with_their_attributes(tmp_path, name, driver):
    write_shapes(tmp_path / name, driver, layer="a")
    shapes = read_shapes(MapLayer(tmp_path / name, where={"unit": "clay"}))
    (polygon,) = shapes.polygons
    assert set(map(tuple, polygon.rings[0].round(3))) == set(map(tuple, RING + 5.0))
    assert [name.lower() for name in layer_names(tmp_path / name)] == ["a"]


def test_one_of_several_layers(tmp_path):
    file = tmp_path / "a.kml"
    write_shapes(file, "LIBKML", crs="EPSG:4326", layer="one")
    assert layer_names(file) == ["one"]
    with pytest.raises(InputRefused, match="has no layer 'two'"):
        read_shapes(MapLayer(file, "two"))


def test_degrees_are_refused(tmp_path):
    write_shapes(tmp_path / "a.fgb", "FlatGeobuf", crs="EPSG:4326")
    with pytest.raises(InputRefused, match="degrees of longitude"):
        read_region(MapLayer(tmp_path / "a.fgb"))


def test_degrees_of_a_raster_are_said(tmp_path):
    for name, place, is_said in (("a.img", (8.0, 47.0), True), ("b.img", (1000.0, 2000.0), False)):
        write_raster(tmp_path / name, "HFA", crs="EPSG:4326", place=place)
        _, warnings = read_point_file(PointFile(tmp_path / name, nodata=-9999))
        assert any("degrees" in text for text in warnings) == is_said


def test_several_bands_are_refused(tmp_path):
    write_raster(tmp_path / "a.img", "HFA", heights=np.array([HEIGHTS, HEIGHTS]))
    with pytest.raises(InputRefused, match="2 bands"):
        read_point_file(PointFile(tmp_path / "a.img"))


@pytest.mark.parametrize("name", ["a.nc", "a.img", "a.fgb", "a.kml"])
def test_damaged_files_are_refused(tmp_path, name):
    begins = {".nc": b"CDF\x01", ".img": b"EHFA_HEADER_TAG", ".fgb": b"fgb\x03fgb", ".kml": b"<kml"}
    (tmp_path / name).write_bytes(begins[name[1:]] + b"\0\1\2" * 9)
    with pytest.raises(InputRefused, match="GDAL cannot read it"):
        read_point_file(PointFile(tmp_path / name))


def test_missing_library_is_named(tmp_path, monkeypatch):
    write_raster(tmp_path / "a.img", "HFA")
    importing = importlib.import_module

    def without(name, *rest):
        if name == "rasterio":
            raise ImportError(name)
        return importing(name, *rest)

    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(UsageError, match=r"needs rasterio.*realmodel\[gdal\]"):
        read_point_file(PointFile(tmp_path / "a.img"))


def test_file_geodatabase_in_a_zip(tmp_path):
    write_shapes(tmp_path / "a.gdb", "OpenFileGDB")
    shutil.make_archive(str(tmp_path / "a.gdb"), "zip", tmp_path, "a.gdb")
    (polygon,) = read_shapes(MapLayer(tmp_path / "a.gdb.zip", "units", {"unit": "sand"})).polygons
    assert np.array_equal(np.unique(polygon.rings[0], axis=0), np.unique(RING, axis=0))
