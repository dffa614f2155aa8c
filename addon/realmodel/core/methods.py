# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods that give heights to a planar mesh: one registry (docs/dev/extending.md). From it follow the
keys of the project file and their checks, the settings and labels of the panel, and the tables of
docs/reference/project_file.md.

What a method does with its options is in the package `heights`, one module for each kind.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from . import method_options as check
from .method_options import OptionRefused

DEFAULT_METHOD = "kriging"
DEFAULT_NEIGHBOURS = 16
NEIGHBOURS_OF_FITTED = 32

Words = Mapping[str, tuple[str, str]]  # label and tooltip in the panel, by word


@dataclass(frozen=True)
class Option:
    """default: its value where it is not given. check(name, value) returns the value as the method takes it,
    or raises OptionRefused.

    For the panel: kind, one of "number", "length", "whole", "word", "surface" and "table" (which has settings
    of its own); label and tip; words, of the kind "word"; start, low and high: the value before it is given,
    and its bounds. switch: label and tip of a tick, off where the option is not given; beside: the option
    whose tick this one shares. zero_is_none: 0 in the panel means that it is not given.
    For the documents: unset, what None means, and more, what there is to say beside the tip.
    """

    default: object
    check: Callable[[str, object], object]
    kind: str = "number"
    label: str = ""
    tip: str = ""
    words: Words = field(default_factory=dict)
    start: float = 0.0
    low: float | None = None
    high: float | None = None
    switch: tuple[str, str] | None = None
    beside: str | None = None
    zero_is_none: bool = False
    unset: str = "none"
    more: str = ""


@dataclass(frozen=True)
class Method:
    """label and tip: in the panel. run: the function of the package `heights` that does it,
    "module.function"; None for "auto", which chooses another. options: by name.

    instead_of_points: the option that tells what points would, where there is one. on_mesh: whether it needs
    the triangles of the nodes. leaves_one_out: it can tell each point from the others at once. is_local: it
    gives on a part of the nodes what it gives on all, and is cheap. spreads_thickness: `parallel` may use it.
    has_shape: its surface has a shape of its own, for which one or two points are too few. tamed_by: what to
    do where its heights run away from those of the points.
    """

    label: str
    tip: str
    run: str | None
    options: Mapping[str, Option]
    instead_of_points: str | None = None
    on_mesh: bool = False
    leaves_one_out: bool = False
    is_local: bool = False
    spreads_thickness: bool = False
    has_shape: bool = True
    tamed_by: str | None = None

    def needs_points(self, settings: Mapping) -> bool:
        """Whether there is nothing without points, with these settings."""
        return self.instead_of_points is None or settings.get(self.instead_of_points) is None


EXTRAPOLATE: Words = {
    "method": ("As the method", "The method goes on outside the points"),
    "nearest": ("Nearest point", "Outside the points the height of the nearest one"),
    "none": ("Not at all", "The surface ends where the points end"),
}
_DRIFTS: Words = {"linear": ("Linear", "A plane"), "quadratic": ("Quadratic", "A curved sheet")}
_NEIGHBOURS = Option(
    DEFAULT_NEIGHBOURS,
    check.neighbours,
    "whole",
    "Neighbours",
    "How many points, the nearest in plan, count at each place; 0: all of them",
    start=DEFAULT_NEIGHBOURS,
    low=0,
    switch=("Choose neighbours", "Say how many points count at each place; off: as many as suit the method"),
    unset=f"{DEFAULT_NEIGHBOURS}; {NEIGHBOURS_OF_FITTED} for kriging with a fitted variogram",
)
_NEIGHBOURHOOD = {
    "neighbours": _NEIGHBOURS,
    "octants": Option(
        0,
        check.octants,
        "whole",
        "Per octant",
        "At most so many points from each eighth of the directions; 0: any number",
        low=0,
    ),
    "radius": Option(
        None,
        check.optional_positive,
        "length",
        "Radius",
        "Points farther away do not count; 0: no limit",
        low=0.0,
        zero_is_none=True,
    ),
}
# None: DEFAULT_NEIGHBOURS, or with a variogram that is fitted twice as many, which tells points better.
_NEIGHBOURHOOD_OF_KRIGING = {
    **_NEIGHBOURHOOD,
    "neighbours": replace(_NEIGHBOURS, default=None, check=check.optional_neighbours),
}
_VARIOGRAM = {
    "variogram": Option(
        None,
        check.variogram,
        "table",
        unset="fitted",
        more='`{model = "spherical", range = 60, sill = 4, nugget = 0}`, or nested: `{nugget = 0, '
        "structures = [{model, range, sill, anisotropy}, ...]}`",
    ),
    "anisotropy": Option(
        None,
        check.anisotropy,
        "table",
        unset="found with a variogram that is fitted, else none",
        more="`{ratio = 2, azimuth = 30}`: the range is longest along the azimuth, in degrees clockwise from "
        "north (+y), and `ratio` times shorter across",
    ),
}
_EXTRAPOLATE = {
    "extrapolate": Option(
        "method",
        check.one_of(*EXTRAPOLATE),
        "word",
        "Outside",
        "What happens beyond the points",
        EXTRAPOLATE,
        more='outside their convex hull: `"nearest"` takes the nearest point\'s height, `"none"` gives '
        "none: the surface ends there",
    )
}


def _other_surface(label: str, tip: str, empty: str) -> Option:
    """An option that may name another surface, and need not."""
    tip = f"{tip}Name of another surface of this rock mass, or a height; empty: {empty}"
    return Option(None, check.optional_surface, "surface", label, tip, unset=empty)


METHODS: dict[str, Method] = {
    "kriging": Method(
        "Kriging",
        "The best guess from neighbouring points, as the variogram says how they vary",
        "from_neighbours.krige",
        {**_NEIGHBOURHOOD_OF_KRIGING, **_VARIOGRAM, **_EXTRAPOLATE},
        leaves_one_out=True,
        is_local=True,
        spreads_thickness=True,
    ),
    "universal_kriging": Method(
        "Universal kriging",
        "Kriging of what a trend, such as a dip, leaves over",
        "from_neighbours.krige",
        {
            "drift": Option(
                "linear",
                check.one_of(*_DRIFTS),
                "word",
                "Drift",
                "Form of the trend",
                _DRIFTS,
                more='or `"quadratic"`',
            ),
            **_NEIGHBOURHOOD_OF_KRIGING,
            **_VARIOGRAM,
            **_EXTRAPOLATE,
        },
        leaves_one_out=True,
        is_local=True,
        tamed_by='its drift goes on beyond them: use a simpler one, or extrapolate = "nearest"',
    ),
    "idw": Method(
        "Inverse distance",
        "Mean of neighbouring points, the nearer the more",
        "from_neighbours.inverse_distance",
        {
            **_NEIGHBOURHOOD,
            "power": Option(
                2.0,
                check.positive,
                label="Power",
                tip="How fast the weight of a point falls with its distance",
                start=2.0,
                low=0.01,
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
        "The smoothest sheet through the points: a thin plate",
        "from_neighbours.thin_plate",
        {
            **_NEIGHBOURHOOD,
            "smoothing": Option(
                0.0,
                check.not_negative,
                label="Smoothing",
                tip="0: the sheet goes through every point; more: it may leave them to be smoother",
                low=0.0,
            ),
            **_EXTRAPOLATE,
        },
        tamed_by='use smoothing, or extrapolate = "nearest"',
    ),
    "dsi": Method(
        "DSI",
        "Discrete smooth interpolation: smooth on the mesh, through points, with constraints",
        "on_mesh.dsi",
        {
            "weight": Option(
                None,
                check.optional_positive,
                label="Weight",
                tip="Weight of a point against the roughness of one node",
                start=1.0,
                low=1e-9,
                switch=("Loose points", "Points need not hold exactly"),
                unset="points hold",
            ),
            "border": _other_surface("Border", "What the surface is at the border of the region. ", "free"),
            "above": _other_surface("Stay above", "", "no bound"),
            "below": _other_surface("Stay below", "", "no bound"),
            **_EXTRAPOLATE,
        },
        on_mesh=True,
        tamed_by="points that differ much within a triangle make it steep: give points a weight",
    ),
    "natural_neighbour": Method(
        "Natural neighbour",
        "Mean of the points around, by shares of their area",
        "from_triangulation.natural_neighbour",
        _EXTRAPOLATE,
        spreads_thickness=True,
    ),
    "tin": Method("TIN", "Triangles between the points", "from_triangulation.linear", _EXTRAPOLATE),
    "grid": Method(
        "Grid", "Points on a regular grid, bilinear between them", "regular_grid.bilinear", _EXTRAPOLATE
    ),
    "plane": Method(
        "Plane",
        "One plane through the points, or of a given dip",
        "plain.plane",
        {
            "dip": Option(
                None,
                check.dip,
                label="Dip",
                tip="Degrees below the horizontal",
                low=0.0,
                high=89.999,
                switch=("Given dip", "Give the dip; off: it is fitted to the points"),
                unset="fitted",
            ),
            "dip_direction": Option(
                0.0,
                check.number,
                label="Dip direction",
                tip="Azimuth to which the plane falls, in degrees clockwise from north (+y)",
                beside="dip",
            ),
            **_EXTRAPOLATE,
        },
        is_local=True,
        spreads_thickness=True,
    ),
    "constant": Method(
        "Constant",
        "One height everywhere",
        "plain.constant",
        {
            "value": Option(
                None,
                check.optional_number,
                "length",
                "Height",
                "Height everywhere",
                switch=("Given height", "Give the height; off: the mean of the points"),
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
        "A given thickness above or below another surface",
        "plain.parallel",
        {
            "to": Option(
                None,
                check.surface,
                "surface",
                "Parallel to",
                "Name of another surface of this rock mass, or a height",
                unset="needed",
            ),
            "thickness": Option(
                None,
                check.optional_number,
                "length",
                "Thickness",
                "Distance above the other surface; negative: below it",
                switch=("Given thickness", "Give the thickness; off: it comes from the points"),
                unset="from the points",
            ),
        },
        instead_of_points="thickness",
        has_shape=False,
    ),
    "auto": Method("Automatic", "Chooses the method that predicts left-out points best", None, _EXTRAPOLATE),
}

_SPREAD_BY = "idw"
THICKNESS_METHODS = tuple(
    dict.fromkeys([_SPREAD_BY, *(name for name, method in METHODS.items() if method.spreads_thickness)])
)
# Of any of the methods above: only now are they all there.
_THICKNESS_METHOD = Option(
    _SPREAD_BY,
    check.one_of(*THICKNESS_METHODS),
    "word",
    "Spread by",
    "How the thickness at the points is spread between them",
    {name: (METHODS[name].label, METHODS[name].tip) for name in THICKNESS_METHODS},
    more="also " + ", ".join(f'`"{name}"`' for name in THICKNESS_METHODS[1:]),
)
METHODS["parallel"] = replace(
    METHODS["parallel"], options={**METHODS["parallel"].options, "thickness_method": _THICKNESS_METHOD}
)

# Every option once: those of one name mean the same wherever they are.
OPTIONS: dict[str, Option] = {
    name: option for method in reversed(METHODS.values()) for name, option in method.options.items()
}
OPTIONS = {name: OPTIONS[name] for method in METHODS.values() for name in method.options}
ALL_OPTIONS = tuple(OPTIONS)
SURFACE_OPTIONS = tuple(name for name, option in OPTIONS.items() if option.kind == "surface")


def check_method(method: str) -> None:
    """Refuses a method that this version does not have."""
    if method in METHODS:
        return
    near = difflib.get_close_matches(str(method), METHODS, n=1)
    advice = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(METHODS)}"
    raise OptionRefused(f"unknown method '{method}'", option="method", advice=advice)


def checked_options(method: str, options: Mapping) -> dict:
    """The options of one method, complete and of the right types, as `heights` takes them.

    Raises OptionRefused for an option that the method does not have, or a value that makes no sense.
    """
    check_method(method)
    known = METHODS[method].options
    for option in options:
        if option in known:
            continue
        owner = next((name for name, other in METHODS.items() if option in other.options), None)
        what = f"'{option}' belongs to {owner}, not to {method}" if owner else None
        raise OptionRefused(
            what or f"'{option}' is not an option of any method",
            option=option,
            advice=f"options of {method} are {', '.join(known)}",
        )
    return {name: option.check(name, options.get(name, option.default)) for name, option in known.items()}
