# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of all formats that files are read in. The first bytes of a file decide its format, its ending
only where they say nothing. Menus, file filters and messages about endings follow from the table."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..base.errors import InputRefused
from ..base.text import as_utf8, reading
from .gdal_files import (
    RASTER_ENDINGS,
    SHAPE_ENDINGS,
    begins_as_gdal_raster,
    begins_as_gdal_shapes,
    gdal_layers,
    read_gdal_raster,
    read_gdal_shapes,
)
from .holes.ags import begins_as_ags, read_ags
from .holes.diggs import begins_as_diggs, read_diggs
from .holes.las import begins_as_las, read_las
from .holes.well_tops import begins_as_well_tops, read_well_tops
from .maps.geojson import begins_as_geojson, read_geojson
from .maps.geopackage import geopackage_layers, is_geopackage, read_geopackage
from .maps.shapefile_reader import is_shapefile, read_shapefile
from .maps.wkt import begins_as_wkt_file, read_wkt
from .meshes.datamine import begins_as_datamine, read_datamine
from .meshes.dxf import begins_as_dxf, read_dxf
from .meshes.gltf_mesh import begins_as_gltf, read_gltf
from .meshes.gmsh_mesh import begins_as_msh, read_msh
from .meshes.gocad import begins_as_gocad, read_gocad
from .meshes.landxml import begins_as_landxml, read_landxml
from .meshes.leapfrog import begins_as_leapfrog, read_leapfrog
from .meshes.obj_mesh import begins_as_obj, read_obj
from .meshes.off import begins_as_off, read_off
from .meshes.ply_mesh import begins_as_ply, begins_as_ply_points, read_ply, read_ply_points
from .meshes.stl_mesh import begins_as_stl, read_stl
from .meshes.surpac import begins_as_dtm, begins_as_str, read_dtm, read_str
from .meshes.vtk_legacy import begins_as_vtk, begins_as_vtm, read_vtk, read_vtm
from .meshes.vtk_mesh import begins_as_vtk_xml, read_vtk_xml
from .objects.geo_object import as_a_whole
from .objects.geoh5_file import begins_as_geoh5, open_geoh5
from .objects.omf_file import begins_as_omf, open_omf
from .rasters.ascii_grid import is_ascii_grid, read_ascii_grid
from .rasters.column_grids import is_cps3_grid, is_zmap_grid, read_cps3_grid, read_zmap_grid
from .rasters.geotiff import is_tiff, read_geotiff
from .rasters.irap_grid import is_irap_grid, read_irap_grid
from .rasters.surfer_grid import is_surfer_grid, read_surfer_grid
from .tables.dialects import DIALECTS
from .tables.dialects.workbook import begins_as_workbook, sheet_names
from .tables.points import begins_as_array, read_point_array, read_point_rows
from .tables.sticks import (
    begins_as_charisma_sticks,
    begins_as_sticks,
    read_charisma_sticks,
    read_sticks,
)

_HEAD = 4096  # bytes; comments may come before the first line
RASTER, ARRAY, OBJECTS, SHAPES = "raster", "array", "objects", "shapes"
MESH, STICKS, TABLE, HOLES = "mesh", "sticks", "table", "holes"


@dataclass(frozen=True)
class FileFormat:
    """A format that files are read in.

    holds: what is in them. begins(head, size): whether a file of so many bytes that begins with these is one.
    read: the arguments follow from `holds`; it raises InputRefused, which names the file and where in it.
    by_ending: a file that is not recognized by its beginning is one, too, if its name has this extension.
    layers(file): the names among which `layer` chooses, of layers of shapes or sheets; None: a file has only
    one. What names objects holds OBJECTS. downward_dip: of boreholes, the sign of downward dips if the format
    defines it.
    """

    label: str
    endings: tuple[str, ...]
    holds: str
    begins: Callable[[bytes, int], bool]
    read: Callable[..., Any]
    by_ending: bool = False
    layers: Callable[[Path], list[str]] | None = None
    downward_dip: str | None = None


FORMATS = (
    FileFormat("GeoTIFF", (".tif", ".tiff"), RASTER, is_tiff, read_geotiff),
    FileFormat("ESRI ASCII grid", (".asc",), RASTER, is_ascii_grid, read_ascii_grid),
    FileFormat("Surfer grid", (".grd",), RASTER, is_surfer_grid, read_surfer_grid),
    FileFormat("ZMAP+", (".zmap", ".dat"), RASTER, is_zmap_grid, read_zmap_grid),
    FileFormat("CPS-3", (".cps3", ".cps"), RASTER, is_cps3_grid, read_cps3_grid),
    FileFormat("IRAP classic", (".gri", ".irap"), RASTER, is_irap_grid, read_irap_grid),
    FileFormat("NumPy array", (".npy",), ARRAY, begins_as_array, read_point_array),
    FileFormat("OMF", (".omf",), OBJECTS, begins_as_omf, open_omf),
    FileFormat("geoh5", (".geoh5",), OBJECTS, begins_as_geoh5, open_geoh5),
    FileFormat("GeoPackage", (".gpkg",), SHAPES, is_geopackage, read_geopackage, layers=geopackage_layers),
    FileFormat("shapefile", (".shp",), SHAPES, is_shapefile, read_shapefile),
    FileFormat("glTF", (".glb", ".gltf"), OBJECTS, begins_as_gltf, as_a_whole(read_gltf), by_ending=True),
    FileFormat(
        "GeoJSON",
        (".geojson", ".json", ".geojsonl", ".geojsons"),
        SHAPES,
        begins_as_geojson,
        read_geojson,
        by_ending=True,
    ),
    FileFormat("well-known text", (".wkt",), SHAPES, begins_as_wkt_file, read_wkt),
    FileFormat("OFF", (".off",), MESH, begins_as_off, read_off, by_ending=True),
    FileFormat("PLY points", (".ply",), OBJECTS, begins_as_ply_points, as_a_whole(read_ply_points)),
    FileFormat("PLY", (".ply",), MESH, begins_as_ply, read_ply, by_ending=True),
    FileFormat(
        "GOCAD",
        (".ts", ".vs", ".pl", ".wl", ".gocad"),
        OBJECTS,
        begins_as_gocad,
        as_a_whole(read_gocad),
        by_ending=True,
    ),
    FileFormat(
        "VTK XML", (".vtp", ".vtu"), OBJECTS, begins_as_vtk_xml, as_a_whole(read_vtk_xml), by_ending=True
    ),
    FileFormat("VTK", (".vtk",), OBJECTS, begins_as_vtk, as_a_whole(read_vtk), by_ending=True),
    FileFormat("VTK multiblock", (".vtm",), OBJECTS, begins_as_vtm, as_a_whole(read_vtm)),
    FileFormat("Surpac DTM", (".dtm",), OBJECTS, begins_as_dtm, as_a_whole(read_dtm), by_ending=True),
    FileFormat("Surpac strings", (".str",), OBJECTS, begins_as_str, as_a_whole(read_str), by_ending=True),
    FileFormat("Datamine", (".dm",), OBJECTS, begins_as_datamine, as_a_whole(read_datamine), by_ending=True),
    FileFormat("Gmsh", (".msh",), OBJECTS, begins_as_msh, as_a_whole(read_msh), by_ending=True),
    FileFormat("Leapfrog", (".msh",), OBJECTS, begins_as_leapfrog, as_a_whole(read_leapfrog)),
    FileFormat(
        "LandXML",
        (".xml", ".landxml"),
        OBJECTS,
        begins_as_landxml,
        as_a_whole(read_landxml),
        by_ending=True,
    ),
    FileFormat("DXF", (".dxf",), OBJECTS, begins_as_dxf, as_a_whole(read_dxf), by_ending=True),
    FileFormat("STL", (".stl",), OBJECTS, begins_as_stl, as_a_whole(read_stl), by_ending=True),
    FileFormat("OBJ", (".obj",), OBJECTS, begins_as_obj, as_a_whole(read_obj), by_ending=True),
    FileFormat(
        "Charisma fault sticks",
        (".charisma",),
        OBJECTS,
        begins_as_charisma_sticks,
        as_a_whole(read_charisma_sticks),
    ),
    FileFormat("AGS", (".ags",), HOLES, begins_as_ags, read_ags, downward_dip="positive"),
    FileFormat("DIGGS", (".xml", ".diggs"), HOLES, begins_as_diggs, read_diggs),
    FileFormat("Petrel well tops", (".tops", ".asc", ".txt"), HOLES, begins_as_well_tops, read_well_tops),
    FileFormat("LAS", (".las",), HOLES, begins_as_las, read_las),
    FileFormat("fault sticks", (".pol",), STICKS, begins_as_sticks, read_sticks, by_ending=True),
    *(FileFormat(d.label, d.endings, TABLE, d.begins, read_point_rows) for d in DIALECTS),
    FileFormat("Excel", (".xlsx", ".xlsm"), TABLE, begins_as_workbook, read_point_rows, layers=sheet_names),
    FileFormat(
        "rasters of GDAL", RASTER_ENDINGS, RASTER, begins_as_gdal_raster, read_gdal_raster, by_ending=True
    ),
    FileFormat(
        "shapes of GDAL",
        SHAPE_ENDINGS,
        SHAPES,
        begins_as_gdal_shapes,
        read_gdal_shapes,
        by_ending=True,
        layers=gdal_layers,
    ),
    FileFormat(
        "table of text",
        (".csv", ".xyz", ".txt", ".dat", ".tsv"),
        TABLE,
        lambda head, _size: b"\0" not in head,
        read_point_rows,
    ),
)


# What people give and what is not read: how it begins, what it is, and what to do.
_NOT_READ = (
    (rb"AC10\d\d", "a drawing of AutoCAD (DWG)", "save it as DXF"),
    (rb"Kaydara FBX", "an FBX", "save it as OBJ, PLY or glTF: Blender can"),
    (
        rb"ISO-10303-21",
        "a STEP or IFC file",
        "save its surfaces as OBJ, STL or glTF: FreeCAD and Blender can",
    ),
    (rb"LASF", "a cloud of points (LAS or LAZ)", "save it as text or PLY: CloudCompare and PDAL can"),
    (rb"# \.PCD v", "a cloud of points of PCL (PCD)", "save it as PLY or text: CloudCompare can"),
    (rb"STORM\w*_(?:BINARY|ASCII)", "a grid of Storm", "save it as IRAP classic or ZMAP+: RMS can"),
    (rb"roff-(?:bin|asc)", "a grid of RMS (ROFF)", "save its horizons as IRAP classic or ZMAP+: RMS can"),
    (rb"Content=Map", "a map of PetroMod", "save it as ZMAP+ or CPS-3: PetroMod can"),
    (rb"\{\\rtf", "a text with formatting (RTF)", "save its table as CSV"),
    (
        rb"PK\x03\x04.{26,3900}3D/[\w -]+\.model",
        "a 3MF",
        "save it as STL, and set its unit: 3MF is mostly in millimeters",
    ),
    (rb"%PDF-", "a PDF", "save its table as CSV"),
    (rb"\x1f\x8b|BZh\d|\xfd7zXZ", "compressed by gzip, bzip2 or xz", "unpack it"),
    (rb"Rar!\x1a|7z\xbc\xaf", "an archive (RAR or 7z)", "unpack it"),
    (rb".{257}ustar", "an archive (tar)", "unpack it"),
    (rb"version https://git-lfs", "a Git LFS pointer instead of the file", "fetch it: git lfs pull"),
    (rb"(?i)\s*<(?:!doctype )?html", "a page of the web", "download the file itself"),
)


_ZIPS = (b"PK\3\4", b"PK\5\6")  # also of formats that are read


def format_of(file: str | Path, *holds: str) -> FileFormat | None:
    """The format of a file among those that hold these things: by its beginning, or else by its ending.
    Raises InputRefused where it cannot be read, and for what is known not to be."""
    file = Path(file)
    with reading(file), file.open("rb") as opened:
        head = as_utf8(opened.read(_HEAD))
        size = opened.seek(0, os.SEEK_END)
    for beginning, what, advice in _NOT_READ:
        if re.match(beginning, head, re.DOTALL):
            raise InputRefused(f"it is {what}, which is not read", file=file, advice=advice)
    able = [entry for entry in FORMATS if entry.holds in holds]
    by_ending = (entry for entry in able if entry.by_ending and file.suffix.lower() in entry.endings)
    begins = next((entry for entry in able if entry.begins(head, size)), None)
    if begins is None and head[:4] in _ZIPS and not any(entry.begins(head, size) for entry in FORMATS):
        raise InputRefused("it is an archive (zip), which is not read", file=file, advice="unpack it")
    tables = (entry for entry in able if entry.holds == TABLE)  # of which the refusal is then
    return begins or next(by_ending, next(tables, None))


def endings(*holds: str) -> tuple[str, ...]:
    """Of the names of files that hold these things."""
    able = [entry for what in holds for entry in FORMATS if entry.holds == what]
    return tuple(dict.fromkeys(ending for entry in able for ending in entry.endings))


def labels(*holds: str) -> str:
    """The names of formats of files that hold these things, for messages."""
    return ", ".join(entry.label for what in holds for entry in FORMATS if entry.holds == what)
