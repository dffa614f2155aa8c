# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a project, a rock mass, a surface and the reading of files (setting.py says what follows).
Those of kind "other" are read, checked and shown by code of their own; so are parts of some more."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ..base.units import METERS, UNIT_NAMES
from .crs import checked_crs
from .directions import checked_direction
from .mesh_sizes import edge_length_fault, triangles_fault
from .meshers import DEFAULT_MESHER, MESHERS
from .method_options import OptionRefused
from .methods import DEFAULT_METHOD, DEFAULT_OPTIONS, METHODS, OPTIONS
from .rules import DEFAULT_RULE, RULES
from .series import AUTO, FIELD, KINDS, THICKNESSES, resolution_fault
from .setting import Setting

_OTHER = Setting(kind="other")  # with its row in the document alone


def _labels(registry: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    return {name: (entry.label, entry.tip) for name, entry in registry.items()}


def _without(fault: Callable[[Any], str | None]) -> Callable[[str, Any], Any]:
    """The check of a value that `fault` finds nothing wrong with."""

    def check(key: str, value: Any) -> Any:
        if value is not None and (what := fault(value)):
            raise OptionRefused(what, option=key)
        return value

    return check


_UNITS = {"": ("Model Unit", "The unit of the model")} | {unit: (unit, UNIT_NAMES[unit]) for unit in METERS}

PROJECT = {
    **dict.fromkeys(("format", "name", "units", "library"), _OTHER),
    "crs": Setting(
        kind="text",
        label="CRS",
        tip="Coordinate reference system of the model by its code, such as EPSG:25832; empty: not known",
        check=checked_crs,
        more="A projected system, in the unit of the model. Nothing is converted: IFC, GeoJSON, geoh5 and "
        "OMF files name it, GeoTIFF and GeoPackage the codes of EPSG",
    ),
    **dict.fromkeys(("rock", "fault", "body"), _OTHER),
}

ROCK = {
    "name": Setting(kind="text", label="Name", tip="Name of the rock mass"),
    "region": _OTHER,
    "holes": _OTHER,
    "edge_length": Setting(
        kind="length",
        label="Edge Length",
        tip="Edge length of the triangles on which surfaces are interpolated. Half the length gives four "
        "times as many triangles",
        low=0.0,
        check=_without(edge_length_fault),
        zero_is_none=True,
        needed="if a surface has `points`, unless `triangles` is given",
        more="Where points lie much closer together than it is long, they become [nodes "
        'themselves](methods.md#ties). `"auto"`: half the spacing of the points of the surfaces, '
        "where they lie",
    ),
    "triangles": Setting(
        kind="whole",
        label="Triangles",
        tip="Number of triangles of the planar mesh, within 5 %",
        start=10_000,
        low=1,
        check=_without(triangles_fault),
        more='Instead of `edge_length`; with `edge_length = "auto"` it scales the point spacing',
        switch=("Scale to Triangles", "Scale the point spacing so that the mesh has a number of triangles"),
    ),
    "mesher": Setting(
        DEFAULT_MESHER,
        kind="word",
        label="Mesher",
        tip="Algorithm that divides the region into triangles",
        words=_labels(MESHERS),
        more="See [meshing](../dev/meshing.md)",
    ),
    "size": _OTHER,
    "base_elevation": Setting(
        kind="length",
        label="Base Elevation",
        tip="Elevation of the flat base of the oldest block; surfaces that reach below are cut off there",
        more="It adds a block beneath the oldest surface; see [Base](#base)",
        switch=("Base", "Add a block between the oldest surface and the base elevation"),
        switch_name="use_base",
    ),
    "constraints": _OTHER,
    "boreholes": _OTHER,
    "observations": _OTHER,
    "dips": _OTHER,
    "map": _OTHER,
    "names": _OTHER,
    "series": _OTHER,
}

SERIES = {
    "name": Setting(kind="text", label="Name", tip="Name of the series"),
    "kind": Setting(FIELD, kind="word", label="Kind", tip="How its surfaces are made", words=KINDS),
    "dips": _OTHER,
    "resolution": Setting(
        kind="length",
        label="Resolution",
        tip="Edge length of the lattice of the field",
        low=0.0,
        check=_without(resolution_fault),
        zero_is_none=True,
        unset="auto",
        more='`"auto"` (default): by the spacing of the contacts and the size of the rock mass',
    ),
    "thickness": Setting(
        AUTO,
        kind="word",
        label="Thickness",
        tip="How thick the beds of a field are away from the data",
        words=THICKNESSES,
    ),
}

SERIES_VALUES = ("kind", "resolution", "thickness")  # of SERIES, that are read and checked as they stand

SIZE = {
    "length": Setting(kind="length", label="Length", tip="Edge length there", start=1.0, low=1e-6),
    "distance": Setting(
        kind="length",
        label="Influence Distance",
        tip="Distance within which edges are this short; beyond, they grow by a quarter of it",
        low=0.0,
    ),
}

READING = {
    "columns": Setting(
        kind="columns",
        parts={
            axis: Setting(
                kind="column",
                label=f"{axis.upper()} Column",
                tip=f"Column of {axis}, by name or by number from 1; all three empty: detected from "
                "their names, else the first three",
                name=f"column_{axis}",
            )
            for axis in "xyz"
        },
    ),
    "where": _OTHER,
    "separator": Setting(
        kind="text",
        label="Separator",
        tip="Character between the columns, or tab, or blank; empty: detected from the file",
    ),
    "decimal": Setting(
        kind="word",
        label="Decimal Separator",
        tip="Decimal separator of the numbers in the file",
        words={
            "": ("Automatic", "Detected from the file, except for commas that could separate thousands"),
            ".": ("Point", "1234.5"),
            ",": ("Comma", "1234,5"),
        },
    ),
    "nodata": Setting(
        kind="text",
        label="NoData Value",
        tip="Value that marks missing data, such as -9999, or several with commas; such points are skipped",
    ),
    "units": Setting(
        kind="table",
        parts={
            "xy": Setting(
                kind="word",
                label="Unit of X, Y",
                tip="Unit of the plan coordinates in the file",
                words=_UNITS,
                name="plan_unit",
            ),
            "z": Setting(
                kind="word",
                label="Unit of Z",
                tip="Unit of the elevations in the file",
                words=_UNITS,
                name="height_unit",
            ),
        },
    ),
    "z_axis": Setting(
        "up",
        kind="word",
        label="Z Axis",
        tip="Direction in which z of the file increases",
        words={
            "up": ("Up", "Z is an elevation"),
            "down": ("Down", "Z is a depth: it changes its sign"),
        },
    ),
    "height": Setting(
        kind="column",
        label="Elevation Field",
        tip="Attribute with the elevation of each feature, as of a contour line; empty: z of its coordinates",
        name="height_attribute",
    ),
    "layer": Setting(
        kind="layer",
        label="Layer",
        tip="Layer of a GeoPackage, or object of an OMF or geoh5 file; needed where there are several",
    ),
}

MESH_READING = ("units", "z_axis", "layer")  # of READING, for meshes too

SURFACE = {
    "name": Setting(kind="text", label="Name", tip="Name of the surface"),
    "points": _OTHER,
    **READING,
    "mesh": _OTHER,
    "dips": _OTHER,
    "left_out": _OTHER,
    "series": Setting(
        kind="series",
        label="Series",
        tip="Name of the series that the surface belongs to; empty: none",
        more="See [Series](#series)",
    ),
    "method": Setting(
        DEFAULT_METHOD,
        kind="word",
        label="Method",
        tip="How elevations are interpolated from the points",
        words=_labels(METHODS),
    ),
    **OPTIONS,  # those of a new row are those of a surface that names no method
    **{key: replace(OPTIONS[key], default=given) for key, given in DEFAULT_OPTIONS.items()},
    "minimum_thickness": Setting(
        kind="length",
        label="Minimum Thickness",
        tip="Minimum distance above the next older surface",
        low=0.0,
        more="For interpolated surfaces; points that contradict it are listed",
        switch=("Thickness ≥", "Keep the surface at least this far above the next older one"),
    ),
    "true_thickness": Setting(
        False,
        kind="truth",
        label="True Thickness",
        tip="Measure the minimum thickness, and the thickness of a parallel surface, perpendicular to the "
        "other surface, not vertically",
        more="Default `false`; see [true thickness](methods.md#true-thickness)",
    ),
    "tie": Setting(
        True,
        kind="truth",
        label="Tie",
        tip="The surface passes through all its points, also within the triangles of the planar mesh",
        more="Default `true`, for interpolated surfaces; see [ties](methods.md#ties). `false` leaves the "
        "elevations as the method interpolates them",
    ),
    "observed": Setting(
        False,
        kind="truth",
        label="Observed",
        tip="The points were seen in the rock: no younger surface cuts below them",
        more="Default `false`; picks of boreholes and points of a [series](#series) always are. See "
        "[observed contacts](#observed-contacts)",
    ),
    "correlation": Setting(
        label="Correlation",
        tip="Correlation of the errors of its elevations with those of the next older surface, in ensembles",
        low=-1.0,
        high=1.0,
        more="-1 to 1, for interpolated surfaces; see [ensembles](../ensembles.md)",
        switch=("Correlation", "In ensembles, draw its elevations with those of the next older surface"),
    ),
    "rule": Setting(
        DEFAULT_RULE,
        kind="word",
        label="Rule",
        tip="What the surface does to the rock that was there before",
        words=_labels(RULES),
        more="See [Rules](#rules)",
    ),
    "property": Setting(
        0,
        kind="whole",
        label="Property",
        tip="Library ID of the rock deposited beneath this surface; 0: none",
        name="property_id",
        more="See [Library](#library)",
    ),
    "block": Setting(
        kind="text",
        label="Block",
        tip='Name of the block beneath this surface; empty: the name of the surface and "block"',
        more='The block on the base is "base block"',
    ),
}

FAULT = {
    "name": Setting(kind="text", label="Name", tip="Name of the fault"),
    "mesh": _OTHER,
    "points": _OTHER,
    **READING,
    "stick": Setting(
        kind="column",
        label="Stick Column",
        tip="Column of a table that numbers or names the fault sticks",
        more="Without it, and without a column named `stick`, the points are scattered",
    ),
    "extend": Setting(
        0.0,
        kind="length",
        label="Extend",
        tip="Distance by which the mesh continues beyond its border, the fitted surface beyond its points, "
        "or the trace beyond its ends",
        low=0.0,
        more="In its own plane; of a fault that dies out up and down the dip only, of its trace along that. "
        "Default 0; a trace goes through the rock then, unless the fault dies out",
    ),
    "trace": _OTHER,
    "dip": Setting(
        label="Dip",
        tip="Angle below the horizontal, in degrees; 0: the attribute of the file",
        low=0.0,
        high=90.0,
        above=0.0,
        zero_is_none=True,
    ),
    "dip_direction": Setting(
        kind="direction",
        label="Dip Direction",
        tip="Degrees clockwise from north (+Y), or the side of the trace: N, NE, E, ... Not needed for a "
        "vertical fault",
        check=checked_direction,
    ),
    "elevation": Setting(
        kind="surface",
        label="Elevation",
        tip="Elevation of the trace, or the surface that it is on. Empty: z of the trace, or the youngest "
        "surface where it has none",
    ),
    "youngest": Setting(
        kind="any_surface",
        label="Youngest",
        tip="Youngest surface that the fault displaces; empty: all surfaces",
        more="Younger surfaces ignore the fault",
    ),
    "ends_at": _OTHER,
    "dies_out": Setting(
        False,
        kind="truth",
        label="Dies Out",
        tip="The fault ends inside the rock; its displacement vanishes there",
        more="Default `false`: its border must lie outside the rock that it displaces",
    ),
    "rocks": _OTHER,
}

BODY = {
    "name": Setting(kind="text", label="Name", tip="Name of the body, and of its block"),
    "mesh": _OTHER,
    **{key: READING[key] for key in MESH_READING},
    "after": Setting(
        kind="any_surface",
        label="After",
        tip="Surface after which the body came; empty: the youngest",
        more="Younger surfaces erode and bury the body",
    ),
    "property": Setting(
        0,
        kind="whole",
        label="Property",
        tip="Library ID of the rock of the body; 0: none",
        name="property_id",
        more="See [Library](#library)",
    ),
    "void": Setting(
        False,
        kind="truth",
        label="Void",
        tip="The body takes rock away and leaves nothing, as a tunnel does",
        more="Default `false`",
    ),
    "rock": Setting(
        kind="rock_mass",
        label="Rock Mass",
        tip="Rock mass that the body is in; empty: all",
        more="Default: all that have the surface `after`",
    ),
}
