# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods that give heights to a planar mesh: one registry, with the options of each.

What a method does with its options is in the package `heights`, one module for each kind.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from . import method_options as check
from .method_options import OptionRefused

DEFAULT_METHOD = "kriging"
DEFAULT_NEIGHBOURS = 16
NEIGHBOURS_OF_FITTED = 32
THICKNESS_METHODS = ("idw", "kriging", "natural_neighbour", "plane", "constant")
EXTRAPOLATE = ("method", "nearest", "none")


@dataclass(frozen=True)
class Option:
    """Its value where it is not given, and check(name, value), which returns the value as the method takes it
    or raises OptionRefused."""

    default: object
    check: Callable[[str, object], object]


@dataclass(frozen=True)
class Method:
    """options: by name. instead_of_points: the option that tells what points would, where there is one.
    on_mesh: whether it needs the triangles of the nodes."""

    options: Mapping[str, Option]
    instead_of_points: str | None = None
    on_mesh: bool = False

    def needs_points(self, settings: Mapping) -> bool:
        """Whether there is nothing without points, with these settings."""
        return self.instead_of_points is None or settings.get(self.instead_of_points) is None


_NEIGHBOURHOOD = {
    "neighbours": Option(DEFAULT_NEIGHBOURS, check.neighbours),
    "octants": Option(0, check.octants),
    "radius": Option(None, check.optional_positive),
}
# None: DEFAULT_NEIGHBOURS, or with a variogram that is fitted twice as many, which tells points better.
_NEIGHBOURHOOD_OF_KRIGING = {**_NEIGHBOURHOOD, "neighbours": Option(None, check.optional_neighbours)}
_VARIOGRAM = {"variogram": Option(None, check.variogram), "anisotropy": Option(None, check.anisotropy)}
_EXTRAPOLATE = {"extrapolate": Option("method", check.one_of(*EXTRAPOLATE))}

METHODS: dict[str, Method] = {
    "kriging": Method({**_NEIGHBOURHOOD_OF_KRIGING, **_VARIOGRAM, **_EXTRAPOLATE}),
    "universal_kriging": Method(
        {
            "drift": Option("linear", check.one_of("linear", "quadratic")),
            **_NEIGHBOURHOOD_OF_KRIGING,
            **_VARIOGRAM,
            **_EXTRAPOLATE,
        }
    ),
    "idw": Method({**_NEIGHBOURHOOD, "power": Option(2.0, check.positive), **_EXTRAPOLATE}),
    "spline": Method(
        {
            **_NEIGHBOURHOOD,
            "smoothing": Option(0.0, check.not_negative),
            **_EXTRAPOLATE,
        }
    ),
    "dsi": Method(
        {
            "weight": Option(None, check.optional_positive),
            "border": Option(None, check.optional_surface),
            "above": Option(None, check.optional_surface),
            "below": Option(None, check.optional_surface),
            **_EXTRAPOLATE,
        },
        on_mesh=True,
    ),
    "natural_neighbour": Method(_EXTRAPOLATE),
    "tin": Method(_EXTRAPOLATE),
    "grid": Method(_EXTRAPOLATE),
    "plane": Method(
        {
            "dip": Option(None, check.dip),
            "dip_direction": Option(0.0, check.number),
            **_EXTRAPOLATE,
        }
    ),
    "constant": Method({"value": Option(None, check.optional_number)}, instead_of_points="value"),
    "parallel": Method(
        {
            "to": Option(None, check.surface),
            "thickness": Option(None, check.optional_number),
            "thickness_method": Option("idw", check.one_of(*THICKNESS_METHODS)),
        },
        instead_of_points="thickness",
    ),
    "auto": Method(_EXTRAPOLATE),
}
SURFACE_OPTIONS = ("to", "border", "above", "below")  # that may name another surface

ALL_OPTIONS = tuple(dict.fromkeys(option for method in METHODS.values() for option in method.options))


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
