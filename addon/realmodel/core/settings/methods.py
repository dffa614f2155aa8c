# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods that give heights to a planar mesh: one registry (docs/dev/extending.md). From it follow the
keys of the project file and their checks, the settings and labels of the panel, and the tables of
docs/reference/project_file.md. What runs a method is named in `heights.methods`.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, replace

from . import method_options as check
from .method_options import OptionRefused
from .setting import Setting, Settings, Words
from .variogram import VARIOGRAMS

# of a surface that names no method
DEFAULT_METHOD, DEFAULT_OPTIONS = "universal_kriging", {"drift": "auto"}
# how a ready mesh is continued to faults that it does not reach, unless it has a method
CONTINUATION, CONTINUATION_OPTIONS = "natural_neighbour", {"extrapolate": "nearest"}
DEFAULT_NEIGHBOURS = 16
NEIGHBOURS_OF_FITTED = 32


@dataclass(frozen=True)
class Method:
    """label and tip: in the panel. options: by name.

    instead_of_points: the option that takes the place of points, if any. on_mesh: it needs the triangles of
    the nodes. leaves_one_out: it estimates each point from the others in one run. is_local: its heights at a
    node do not depend on the other nodes, and it is cheap. is_triangulated: it works on the triangulation of
    the points. spreads_thickness: `parallel` may use it. is_constrained: it uses dips and bounds. has_shape:
    one or two points are too few for its surface. has_contacts: its points are contacts, to which the surface
    is tied, and not the surface itself. tamed_by: the advice where its heights go far beyond those of the
    points. chooses: it runs another method, which suits the data.
    """

    label: str
    tip: str
    options: Settings
    instead_of_points: str | None = None
    on_mesh: bool = False
    leaves_one_out: bool = False
    is_local: bool = False
    is_triangulated: bool = False
    spreads_thickness: bool = False
    is_constrained: bool = False
    has_shape: bool = True
    has_contacts: bool = True
    tamed_by: str | None = None
    chooses: bool = False

    @property
    def may_be_kriged(self) -> bool:
        """Whether it has a variogram, or chooses a method that may have one."""
        return self.chooses or "variogram" in self.options

    def needs_points(self, settings: Mapping) -> bool:
        """Whether there is nothing without points, with these settings."""
        return self.instead_of_points is None or settings.get(self.instead_of_points) is None


EXTRAPOLATE: Words = {
    "method": ("By Method", "The method continues beyond the points"),
    "nearest": ("Nearest Point", "Beyond the points, the elevation of the nearest one"),
    "none": ("None", "The surface ends where the points end"),
}
_DRIFTS: Words = {
    "linear": ("Linear", "A plane"),
    "quadratic": ("Quadratic", "A second-order surface"),
    "auto": (
        "Automatic",
        "A plane, as far as the points show one: few of them, or rough ones, give less slope",
    ),
}
_NEIGHBOURS = Setting(
    DEFAULT_NEIGHBOURS,
    "whole",
    "Neighbors",
    "Number of nearest points in plan used at each node; 0: all",
    start=DEFAULT_NEIGHBOURS,
    low=0,
    switch=("Limit Neighbors", "Set how many points are used at each node; off: as many as suit the method"),
    fold="search",
    unset=f"{DEFAULT_NEIGHBOURS}; {NEIGHBOURS_OF_FITTED} for kriging with a fitted variogram",
)
_NEIGHBOURHOOD = {
    "neighbours": _NEIGHBOURS,
    "octants": Setting(
        0,
        "whole",
        "Per Octant",
        "Maximum number of points from each of eight sectors; 0: no limit",
        low=0,
        fold="search",
    ),
    "radius": Setting(
        None,
        "length",
        "Radius",
        "Search radius: points farther away are not used; 0: no limit",
        low=0.0,
        above=0.0,
        zero_is_none=True,
        fold="search",
    ),
}
# None: DEFAULT_NEIGHBOURS, or twice as many with a fitted variogram, which estimates points better.
_NEIGHBOURHOOD_OF_KRIGING = {
    **_NEIGHBOURHOOD,
    "neighbours": replace(_NEIGHBOURS, default=None),
}


def _anisotropy(prefix: str, tip: str) -> Setting:
    """The anisotropy of a variogram or of one of its structures; prefix: of its properties."""
    return Setting(
        None,
        "table",
        "Anisotropy",
        parts={
            "ratio": Setting(
                label="Ratio",
                tip="Range along the azimuth divided by the range across it",
                start=2.0,
                low=0.001,
                above=0.0,
                name=f"{prefix}ratio",
            ),
            "azimuth": Setting(
                label="Azimuth",
                tip="Direction of the longest range, in degrees clockwise from north (+Y)",
                name=f"{prefix}azimuth",
            ),
        },
        switch=("Anisotropy", tip),
        unset="fitted with the variogram; none if that is given",
        more="`{ratio = 2, azimuth = 30}`: the range is longest along the azimuth, in degrees clockwise from "
        "north (+y), and `ratio` times shorter across",
    )


def _range(tip: str, name: str) -> Setting:
    return Setting(kind="length", label="Range", tip=tip, start=100.0, low=0.0, above=0.0, name=name)


STRUCTURE = {  # of a nested variogram, beside its anisotropy
    "model": Setting(
        "spherical", kind="word", label="Model", tip="Model of this structure", words=VARIOGRAMS
    ),
    "range": _range("Practical range of this structure", "range"),
    "sill": Setting(
        label="Sill", tip="Variance that this structure contributes", start=1.0, low=0.0, above=0.0
    ),
    "anisotropy": _anisotropy("", "Give this structure its own anisotropy; off: that of the variogram"),
}
_PARTS = {
    "model": Setting(
        kind="word", label="Model", tip="Variogram model", words=VARIOGRAMS, name="variogram_model"
    ),
    "range": _range("Practical range: the distance at which correlation vanishes", "variogram_range"),
    "sill": Setting(
        label="Sill",
        tip="Variance between points farther apart than the range, including the nugget",
        start=1.0,
        low=0.0,
        above=0.0,
        name="variogram_sill",
    ),
    "nugget": Setting(
        0.0,
        label="Nugget",
        tip="Variance at distance zero; 0: every point is honored",
        low=0.0,
        name="variogram_nugget",
    ),
}
_VARIOGRAM = {
    "variogram": Setting(
        kind="table",
        label="Variogram",
        check=check.variogram(_PARTS, STRUCTURE),
        parts=_PARTS,
        unset="fitted",
        more='`{model = "spherical", range = 60, sill = 4, nugget = 0}`, or nested: `{nugget = 0, '
        "structures = [{model, range, sill, anisotropy}, ...]}`",
    ),
    "anisotropy": _anisotropy(
        "anisotropy_",
        "Set a direction of longer correlation. Off: found with a fitted variogram, else isotropic",
    ),
}
_EXTRAPOLATE = {
    "extrapolate": Setting(
        "method",
        "word",
        "Extrapolation",
        "What happens beyond the points",
        EXTRAPOLATE,
        more='outside their convex hull: `"nearest"` takes the nearest point\'s elevation, `"none"` gives '
        "none: the surface ends there",
    )
}


def _other_surface(label: str, tip: str, empty: str) -> Setting:
    """An option that may name another surface, and need not."""
    tip = f"{tip}Name of another surface of this rock mass, or an elevation; empty: {empty}"
    return Setting(None, "surface", label, tip, unset=empty)


METHODS: dict[str, Method] = {
    "kriging": Method(
        "Kriging",
        "Ordinary kriging: the best linear unbiased estimate from the variogram",
        {**_NEIGHBOURHOOD_OF_KRIGING, **_VARIOGRAM, **_EXTRAPOLATE},
        leaves_one_out=True,
        is_local=True,
        spreads_thickness=True,
        is_constrained=True,
    ),
    "universal_kriging": Method(
        "Universal Kriging",
        "Kriging with a trend, such as a dip",
        {
            "drift": Setting(
                "linear",
                "word",
                "Drift",
                "Form of the trend",
                _DRIFTS,
                more='or `"quadratic"`; or `"auto"`, a plane as far as the points show one, the default '
                "where no method is named",
            ),
            **_NEIGHBOURHOOD_OF_KRIGING,
            **_VARIOGRAM,
            **_EXTRAPOLATE,
        },
        leaves_one_out=True,
        is_local=True,
        is_constrained=True,
        tamed_by='its drift continues beyond them: use a simpler one, or extrapolate = "nearest"',
    ),
    "idw": Method(
        "Inverse Distance",
        "Mean of neighboring points, weighted by inverse distance",
        {
            **_NEIGHBOURHOOD,
            "power": Setting(
                2.0,
                label="Power",
                tip="Exponent of the distance: higher values give near points more weight",
                start=2.0,
                low=0.01,
                above=0.0,
                more="above 0",
            ),
            **_EXTRAPOLATE,
        },
        leaves_one_out=True,
        is_local=True,
        spreads_thickness=True,
    ),
    "spline": Method(
        "Spline",
        "Thin-plate spline: the smoothest surface through the points",
        {
            **_NEIGHBOURHOOD,
            "smoothing": Setting(
                0.0,
                label="Smoothing",
                tip="0: the surface passes through every point; higher: smoother",
                low=0.0,
            ),
            **_EXTRAPOLATE,
        },
        is_local=True,
        is_constrained=True,
        tamed_by='use smoothing, or extrapolate = "nearest"',
    ),
    "dsi": Method(
        "DSI",
        "Discrete smooth interpolation on the mesh, with constraints",
        {
            "weight": Setting(
                None,
                label="Weight",
                tip="Weight of a point against the roughness of one node",
                start=1.0,
                low=1e-9,
                above=0.0,
                switch=("Approximate Points", "The surface need not pass exactly through the points"),
                unset="passes through the points",
            ),
            "border": _other_surface("Border", "Elevation at the border of the region. ", "free"),
            "above": _other_surface("Stay Above", "", "no bound"),
            "below": _other_surface("Stay Below", "", "no bound"),
            **_EXTRAPOLATE,
        },
        on_mesh=True,
        is_constrained=True,
        tamed_by="points that differ much within a triangle make it steep: give points a weight",
    ),
    "natural_neighbour": Method(
        "Natural Neighbor",
        "Mean of the surrounding points, weighted by the area of their Voronoi cells",
        _EXTRAPOLATE,
        is_triangulated=True,
        spreads_thickness=True,
    ),
    "tin": Method(
        "TIN",
        "Linear in the Delaunay triangles of the points",
        _EXTRAPOLATE,
        is_triangulated=True,
    ),
    "grid": Method(
        "Grid",
        "Bilinear between points on a regular grid",
        _EXTRAPOLATE,
        is_local=True,
        has_contacts=False,
    ),
    "plane": Method(
        "Plane",
        "A plane fitted to the points, or with a fixed dip",
        {
            "dip": Setting(
                label="Dip",
                tip="Angle below the horizontal, in degrees",
                low=0.0,
                high=89.999,
                below=90.0,
                switch=("Fixed Dip", "Set the dip; off: fitted to the points"),
                unset="fitted",
            ),
            "dip_direction": Setting(
                0.0,
                label="Dip Direction",
                tip="Azimuth of the dip, in degrees clockwise from north (+Y)",
                beside="dip",
            ),
            **_EXTRAPOLATE,
        },
        is_local=True,
        spreads_thickness=True,
    ),
    "constant": Method(
        "Constant",
        "One elevation everywhere",
        {
            "value": Setting(
                None,
                "length",
                "Elevation",
                "Elevation of the whole surface",
                switch=("Fixed Elevation", "Set the elevation; off: the mean of the points"),
                unset="the points' mean",
            )
        },
        instead_of_points="value",
        is_local=True,
        spreads_thickness=True,
        has_shape=False,
    ),
    "parallel": Method(
        "Parallel",
        "Parallel to another surface, at a thickness",
        {
            "to": Setting(
                None,
                "surface",
                "Parallel To",
                "Name of another surface of this rock mass, or an elevation",
                check=check.surface,
                unset="required",
            ),
            "thickness": Setting(
                None,
                "length",
                "Thickness",
                "Distance above the other surface; negative: below it",
                switch=("Fixed Thickness", "Set the thickness; off: interpolated from the points"),
                unset="from the points",
            ),
        },
        instead_of_points="thickness",
        has_shape=False,
    ),
    "auto": Method(
        "Automatic",
        "Chooses the method with the smallest cross-validation error",
        _EXTRAPOLATE,
        chooses=True,
        is_constrained=True,
    ),
}

_SPREAD_BY = "idw"
THICKNESS_METHODS = tuple(
    dict.fromkeys([_SPREAD_BY, *(name for name, method in METHODS.items() if method.spreads_thickness)])
)
# Of any of the methods above: only now are they all there.
_THICKNESS_METHOD = Setting(
    _SPREAD_BY,
    "word",
    "Thickness Method",
    "How the thickness is interpolated between the points",
    {name: (METHODS[name].label, METHODS[name].tip) for name in THICKNESS_METHODS},
    more="also " + ", ".join(f'`"{name}"`' for name in THICKNESS_METHODS[1:]),
)
METHODS["parallel"] = replace(
    METHODS["parallel"], options={**METHODS["parallel"].options, "thickness_method": _THICKNESS_METHOD}
)

# Every option once: those of one name mean the same wherever they are.
OPTIONS: dict[str, Setting] = {
    name: option for method in reversed(METHODS.values()) for name, option in method.options.items()
}
OPTIONS = {name: OPTIONS[name] for method in METHODS.values() for name in method.options}
SURFACE_OPTIONS = tuple(name for name, option in OPTIONS.items() if option.kind == "surface")


def check_method(method: str) -> None:
    """Refuses a method that this version does not have."""
    if method in METHODS:
        return
    near = difflib.get_close_matches(str(method), METHODS, n=1)
    advice = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(METHODS)}"
    raise OptionRefused(f"unknown method '{method}'", option="method", advice=advice)


def check_uses_dips(method: str) -> None:
    """Refuses a method that dips have no effect on."""
    check_method(method)
    if METHODS[method].is_constrained:
        return
    able = ", ".join(name for name, entry in METHODS.items() if entry.is_constrained)
    raise OptionRefused(f"method '{method}' does not use dips", option="dips", advice=f"{able} use them")


def checked_options(method: str, options: Mapping) -> dict:
    """The options of one method, complete and of the right types, as `heights` takes them.

    Raises OptionRefused for an option that the method does not have, or a value that makes no sense.
    """
    check_method(method)
    settings = METHODS[method].options
    for option in options:
        if option in settings:
            continue
        owner = next((name for name, other in METHODS.items() if option in other.options), None)
        what = f"'{option}' belongs to {owner}, not to {method}" if owner else None
        raise OptionRefused(
            what or f"'{option}' is not an option of any method",
            option=option,
            advice=f"options of {method} are {', '.join(settings)}",
        )
    return {
        name: check.checked(name, setting, options.get(name, setting.default))
        for name, setting in settings.items()
    }
