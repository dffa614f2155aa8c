# SPDX-License-Identifier: GPL-3.0-or-later
"""The methods that give heights to a planar mesh, the options of each, and what those may be."""

from __future__ import annotations

import math
from collections.abc import Mapping

from .errors import InputRefused, UsageError

DEFAULT_METHOD = "kriging"
OPTIONS = {
    "kriging": ("neighbours", "variogram", "anisotropy"),
    "idw": ("neighbours", "power"),
}
LATER_METHODS = ("universal_kriging", "dsi", "natural_neighbour", "auto")
VARIOGRAM_MODELS = ("spherical", "exponential", "gaussian", "cubic", "matern32", "matern52")
DEFAULT_NEIGHBOURS = 16
DEFAULT_POWER = 2.0

ALL_OPTIONS = tuple(dict.fromkeys(option for options in OPTIONS.values() for option in options))


class OptionRefused(InputRefused):
    """An option of a method is not as it must be; `option` is its name, for the line in a file."""

    def __init__(self, what: str, *, option: str | None = None, **where):
        super().__init__(what, **where)
        self.option = option


def check_method(method: str) -> None:
    """Refuses a method that this version does not have."""
    if method in OPTIONS:
        return
    have = "' or '".join(OPTIONS)
    if method in LATER_METHODS:
        what = f"method '{method}' comes with a later version"
        raise OptionRefused(what, option="method", advice=f"use '{have}'")
    raise OptionRefused(f"unknown method '{method}'", option="method", advice=f"use '{have}'")


def checked_options(method: str, options: Mapping) -> dict:
    """The options of one method, complete and of the right types, as the native functions take them.

    kriging: neighbours (int >= 0; 0 all points), variogram (None to fit one, or {model, range, sill,
    nugget}), anisotropy ({ratio of longest to shortest range, azimuth in degrees from north}).
    idw: neighbours, power (> 0).
    Raises OptionRefused for an option that the method does not have, or a value that makes no sense.
    """
    check_method(method)
    for option in options:
        if option not in OPTIONS[method]:
            owners = [name for name, own in OPTIONS.items() if option in own]
            reason = f"belongs to {owners[0]}" if owners else "is not an option of any method"
            advice = f"options of {method} are {', '.join(OPTIONS[method])}"
            raise OptionRefused(
                f"'{option}' {reason}, not to {method}" if owners else f"'{option}' {reason}",
                option=option,
                advice=advice,
            )
    checked = {"neighbours": _neighbours(options.get("neighbours", DEFAULT_NEIGHBOURS))}
    if method == "idw":
        checked["power"] = _number("power", options.get("power", DEFAULT_POWER), above=0.0)
    else:
        checked["variogram"] = _variogram(options.get("variogram"))
        checked["anisotropy"] = _anisotropy(options.get("anisotropy"))
    return checked


def _neighbours(value) -> int:
    if isinstance(value, bool) or not hasattr(value, "__index__") or int(value) < 0:
        raise OptionRefused(
            f"'neighbours' must be a whole number from 0, not {value!r}",
            option="neighbours",
            advice="0 takes all points, 16 is usual",
        )
    return int(value)


def _number(option: str, value, above: float | None = None, least: float | None = None) -> float:
    name = option.rpartition(".")[2]
    try:
        number = float(value) if not isinstance(value, (bool, str)) else math.nan
    except (OverflowError, TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise OptionRefused(f"'{name}' must be a finite number, not {value!r}", option=option)
    if above is not None and number <= above:
        raise OptionRefused(f"'{name}' must be more than {above:g}, not {number:g}", option=option)
    if least is not None and number < least:
        raise OptionRefused(f"'{name}' must be at least {least:g}, not {number:g}", option=option)
    return number


def _parts(option: str, value, required: tuple[str, ...], optional: tuple[str, ...]) -> dict:
    known = (*required, *optional)
    if not isinstance(value, Mapping):
        shape = ", ".join(f"{key} = ..." for key in known)
        raise OptionRefused(f"'{option}' must be a table", option=option, advice=f"write {{{shape}}}")
    for key in value:
        if key not in known:
            raise OptionRefused(
                f"unknown key '{key}' in '{option}'",
                option=f"{option}.{key}",
                advice=f"known are {', '.join(known)}",
            )
    for key in required:
        if key not in value:
            raise OptionRefused(f"'{option}' lacks '{key}'", option=option)
    return dict(value)


def _variogram(value) -> dict | None:
    """{model, range, sill, nugget}; a Variogram found by an earlier interpolation is taken as well."""
    if value is None:
        return None
    if hasattr(value, "settings"):
        value = value.settings()
    parts = _parts("variogram", value, ("model", "range", "sill"), ("nugget",))
    if parts["model"] not in VARIOGRAM_MODELS:
        raise OptionRefused(
            f"unknown variogram model {parts['model']!r}",
            option="variogram.model",
            advice=f"use {', '.join(VARIOGRAM_MODELS)}",
        )
    sill = _number("variogram.sill", parts["sill"], above=0.0)
    nugget = _number("variogram.nugget", parts.get("nugget", 0.0), least=0.0)
    if nugget > sill:
        raise OptionRefused(
            f"the nugget, {nugget:g}, is more than the sill, {sill:g}",
            option="variogram.nugget",
            advice="the sill includes the nugget",
        )
    reach = _number("variogram.range", parts["range"], above=0.0)
    return {"model": parts["model"], "range": reach, "sill": sill, "nugget": nugget}


def _anisotropy(value) -> dict:
    if value is None:
        return {"ratio": 1.0, "azimuth": 0.0}
    parts = _parts("anisotropy", value, ("ratio", "azimuth"), ())
    return {
        "ratio": _number("anisotropy.ratio", parts["ratio"], above=0.0),
        "azimuth": _number("anisotropy.azimuth", parts["azimuth"]),
    }


def check_threads(threads) -> int:
    """The number of threads: 0 for as many as the machine has."""
    if isinstance(threads, bool) or not hasattr(threads, "__index__") or int(threads) < 0:
        raise UsageError(f"threads must be a whole number from 0 (all that there are), not {threads!r}")
    return int(threads)
