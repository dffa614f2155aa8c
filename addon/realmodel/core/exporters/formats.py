# SPDX-License-Identifier: GPL-3.0-or-later
"""The one table of formats that files are written in. Menus, file filters, the help of the command line, the
messages about endings and the table of docs/reference/output_files.md follow from it."""

from __future__ import annotations

from ..base.formats import Format
from ..drawing import DRAWINGS
from ..drawing.pdf import write_pages
from ..drawing.svg import write_svg_sheets
from .map_files import write_geojson, write_geopackage
from .model_arrays import write_npz
from .objects.geoh5 import write_geoh5
from .objects.ifc import write_ifc
from .objects.omf import write_omf
from .objects.resqml import write_resqml
from .page import write_page
from .regular import write_ascii_grids, write_block_table, write_geotiff, write_vti
from .report import write_report
from .section_files import (
    write_borehole,
    write_planned_hole,
    write_samples_csv,
    write_samples_npz,
    write_samples_vti,
    write_samples_vtu,
    write_section_csv,
    write_section_npz,
    write_section_obj,
    write_section_vtu,
)
from .shapes.dxf import write_dxf_faces
from .shapes.gltf import write_glb
from .shapes.obj import write_obj
from .shapes.ply import write_ply
from .shapes.stl import write_stl
from .shapes.tsurf import write_tsurf
from .solvers.cdb import write_cdb
from .solvers.exodus import write_exodus
from .solvers.f3grid import write_f3grid
from .solvers.gmsh import write_msh
from .solvers.grdecl import write_grdecl
from .solvers.inp import write_inp
from .solvers.modflow import write_disu, write_disv
from .solvers.openfoam import POLY_MESH, write_openfoam
from .solvers.vtu import write_vtu, write_vtu_elements
from .surface_files import write_fields, write_surfaces_npz, write_surfaces_vtu

_ANY_SAMPLES = ("section samples", "hole samples", "grid samples")
_CLEANED = ("tolerance", "cells")  # cells that are cleaned already
CORNER_POINT = ("cell_size", "grid_layers", "grid_azimuth", "grid")  # how it is made, or one that is
_VTK = "VTK Unstructured Grid"

FORMATS = (
    Format(".npz", "NumPy", ("model",), "All arrays of the model, for Python", write_npz),
    Format(".npz", "NumPy", ("surfaces",), "All arrays of the surfaces, for Python", write_surfaces_npz),
    Format(
        ".vtu",
        _VTK,
        ("polyhedra",),
        "The polyhedral cells, for ParaView and simulation",
        write_vtu,
        _CLEANED,
    ),
    Format(
        ".vtu",
        f"{_VTK}, OpenGeoSys",
        ("elements",),
        "The elements, for ParaView and OpenGeoSys",
        write_vtu_elements,
    ),
    Format(
        ".vtu",
        _VTK,
        ("surfaces",),
        "Triangles with elevation, variance and distance, for ParaView",
        write_surfaces_vtu,
    ),
    Format(".vtu", _VTK, ("section",), "Polygons with their blocks, for ParaView", write_section_vtu),
    Format(".vtu", _VTK, ("fields",), "The lattices of fields, for ParaView", write_fields),
    Format(
        ".foam",
        "OpenFOAM Case",
        ("polyhedra",),
        "A folder with the polyhedral cells as polyMesh, with zones of cells and patches",
        write_openfoam,
        _CLEANED,
        folder=POLY_MESH,
    ),
    Format(
        ".exo",
        "Exodus II",
        ("polyhedra", "elements"),
        "The cells, an element block for each block",
        write_exodus,
        _CLEANED,
    ),
    Format(
        ".disu",
        "MODFLOW 6 DISU",
        ("polyhedra",),
        "The polyhedral cells as an unstructured grid, and a table with the block of each cell",
        write_disu,
        (*_CLEANED, "unit"),
        has_files=True,
    ),
    Format(".msh", "Gmsh", ("elements",), "The elements, with physical groups, for Gmsh", write_msh),
    Format(".inp", "Abaqus, CalculiX", ("elements",), "The elements, with sets, for Abaqus", write_inp),
    Format(".cdb", "ANSYS", ("elements",), "The elements, with components, for ANSYS", write_cdb),
    Format(".f3grid", "FLAC3D", ("elements",), "The elements, with groups, for FLAC3D", write_f3grid),
    Format(
        ".disv",
        "MODFLOW 6 DISV",
        ("elements",),
        "Layers of columns as a grid by vertices, and a table of the block of each cell",
        write_disv,
        ("unit",),
        has_files=True,
    ),
    Format(
        ".grdecl",
        "Corner-Point Grid",
        ("corner point",),
        "Layers of columns that follow the blocks, for reservoir simulators (Eclipse, OPM Flow)",
        write_grdecl,
        (*CORNER_POINT, "unit"),
    ),
    Format(".obj", "Wavefront OBJ", ("section",), "Triangles, a group for each block", write_section_obj),
    Format(
        ".obj",
        "Wavefront OBJ",
        ("parts",),
        "Triangles, an object for each block or surface",
        write_obj,
        ("origin",),
        has_files=True,
    ),
    Format(
        ".ply",
        "PLY",
        ("parts",),
        "Triangles with block and property",
        write_ply,
        ("origin",),
        has_each=True,
    ),
    Format(
        ".stl",
        "STL",
        ("parts",),
        "Triangles, a solid for each block or surface",
        write_stl,
        ("origin",),
        has_each=True,
    ),
    Format(
        ".glb",
        "glTF Binary",
        ("parts",),
        "Triangles in the colors of the properties, for the web",
        write_glb,
        ("origin",),
        has_each=True,
    ),
    Format(
        ".html",
        "Web Page",
        ("model",),
        "One page to share, for any browser, offline: rotate, section, explode, volumes",
        write_page,
    ),
    Format(
        ".dxf",
        "DXF",
        ("parts",),
        "Triangles, a layer for each block or surface, for CAD",
        write_dxf_faces,
        ("origin",),
        has_each=True,
    ),
    Format(
        ".ts",
        "GOCAD TSurf",
        ("parts",),
        "Triangles, an object for each block or surface",
        write_tsurf,
        ("unit",),
    ),
    Format(
        ".csv",
        "Block Model",
        ("model",),
        "Regular cells with the share of each block, a row for each",
        write_block_table,
        ("cell_size",),
    ),
    Format(".csv", "Table of Corners", ("section",), "The corners of the polygons", write_section_csv),
    Format(".csv", "Table of Intervals", ("borehole",), "The blocks from the top down", write_borehole),
    Format(
        ".csv",
        "Table of Intervals",
        ("planned hole",),
        "The intervals with depths and probabilities, for a spreadsheet",
        write_planned_hole,
    ),
    Format(".csv", "Table of Places", _ANY_SAMPLES, "The probability of each block", write_samples_csv),
    Format(".npz", "NumPy", ("section",), "All arrays of the section, for Python", write_section_npz),
    Format(".npz", "NumPy", _ANY_SAMPLES, "The probability of each block, for Python", write_samples_npz),
    Format(".vtu", _VTK, ("section samples",), "Cells with the probability of each block", write_samples_vtu),
    Format(
        ".vti",
        "VTK Image",
        ("model",),
        "Regular cells with the share of each block",
        write_vti,
        ("cell_size",),
    ),
    Format(
        ".vti", "VTK Image", ("grid samples",), "Cells with the probability of each block", write_samples_vti
    ),
    Format(
        ".tif",
        "GeoTIFF",
        ("model",),
        "Elevation, and top and thickness of every block, as bands",
        write_geotiff,
        ("cell_size",),
    ),
    Format(
        ".asc",
        "ESRI ASCII Grids",
        ("model",),
        "Elevation, and top and thickness of every block, a file for each",
        write_ascii_grids,
        ("cell_size",),
        has_files=True,
    ),
    Format(
        ".gpkg",
        "GeoPackage",
        ("model",),
        "The geological map of the top, contours, and maps of tops, thickness and uncertainty, for GIS",
        write_geopackage,
        ("contour_interval", "cell_size"),
        has_files=True,
    ),
    Format(
        ".geojson",
        "GeoJSON",
        ("model",),
        "The geological map of the top, and contours, as text for GIS and the web",
        write_geojson,
        ("contour_interval",),
        has_files=True,
    ),
    Format(
        ".omf",
        "Open Mining Format",
        ("model",),
        "Closed blocks, surfaces and boreholes (OMF 1), with cells if their size is given",
        write_omf,
        ("cell_size",),
        has_files=True,
        needs=("omf", "omf"),
    ),
    Format(
        ".geoh5",
        "geoh5",
        ("model",),
        "Closed blocks, surfaces and boreholes, with cells if their size is given (ANALYST)",
        write_geoh5,
        ("cell_size",),
        has_files=True,
        needs=("geoh5py", "geoh5"),
    ),
    Format(
        ".ifc",
        "IFC 4.3",
        ("model",),
        "A geomodel of closed strata with their shared boundaries, and boreholes, for BIM",
        write_ifc,
        has_files=True,
        needs=("ifcopenshell", "ifc"),
    ),
    Format(
        ".epc",
        "RESQML 2.0.1",
        ("model and grid",),
        "Closed blocks, surfaces and boreholes, with a corner-point grid if the size of cells is given",
        write_resqml,
        CORNER_POINT,
        has_files=True,
        needs=("resqpy", "resqml"),
    ),
    Format(
        ".json",
        "Report",
        ("report",),
        "Volumes, settings, warnings, and the validation of the model",
        write_report,
    ),
    Format(
        ".csv",
        "Table of Blocks",
        ("block table",),
        "Volumes, shares, and counts of the blocks, for a spreadsheet",
        lambda text, file, _step: file.write(text.encode()),
    ),
    Format(".pdf", "PDF", ("sheets",), "Sheets to print, a page for each", write_pages),
    Format(".svg", "SVG", ("sheets",), "Sheets to print, a file for each", write_svg_sheets, has_files=True),
    *DRAWINGS,
)
