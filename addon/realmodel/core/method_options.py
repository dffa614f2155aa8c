# SPDX-License-Identifier: GPL-3.0-or-later
"""What the options of methods may be: each check returns the value as the methods take it, or refuses it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from .errors import InputRefused, UsageError
from .variogram import VARIOGRAM_MODELS


class OptionRefused(InputRefused):
    """An option of a method is not as it must be; `option` is its name, for the line in a file."""

    def __init__(self, what: str, *, option: str | None = None, **where):
        super().__init__(what, **where)
        self.option = option


def _is_whole(value) -> bool:
    return hasattr(value, "__index__") and not isinstance(value, (bool, np.bool_))


def neighbours(option: str, value) -> int:
    if not _is_whole(value) or not 0 <= int(value) < 2**31:
        raise OptionRefused(
            f"'{option}' must be a whole number from 0, not {value!r}",
            option=option,
            advice="0 takes all points, 16 is usual",
        )
    return int(value)


def optional_neighbours(option: str, value) -> int | None:
    return None if value is None else neighbours(option, value)


def octants(option: str, value) -> int:
    if not _is_whole(value) or not 0 <= int(value) < 2**31:
        raise OptionRefused(
            f"'{option}' must be a whole number from 0, not {value!r}",
            option=option,
            advice="it is the most points that count from each eighth of the directions; 0 is no limit",
        )
    return int(value)


def number(option: str, value, above: float | None = None, least: float | None = None) -> float:
    name = option.rpartition(".")[2]
    try:
        checked = float(value) if not isinstance(value, (bool, str)) else math.nan
    except (OverflowError, TypeError, ValueError):
        checked = math.nan
    if not math.isfinite(checked):
        raise OptionRefused(f"'{name}' must be a finite number, not {value!r}", option=option)
    if above is not None and checked <= above:
        raise OptionRefused(f"'{name}' must be more than {above:g}, not {checked:g}", option=option)
    if least is not None and checked < least:
        raise OptionRefused(f"'{name}' must be at least {least:g}, not {checked:g}", option=option)
    return checked


def positive(option: str, value) -> float:
    return number(option, value, above=0.0)


def not_negative(option: str, value) -> float:
    return number(option, value, least=0.0)


def optional_number(option: str, value) -> float | None:
    return None if value is None else number(option, value)


def optional_positive(option: str, value) -> float | None:
    return None if value is None else positive(option, value)


def dip(option: str, value) -> float | None:
    """Degrees from the horizontal."""
    if value is None:
        return None
    checked = number(option, value, least=0.0)
    if checked >= 90:
        raise OptionRefused(f"'{option}' must be below 90 degrees, not {checked:g}", option=option)
    return checked


def optional_surface(option: str, value):
    return None if value is None else surface(option, value)


def surface(option: str, value):
    """Another surface: a height, its name in a project, heights at the nodes (N,), or a triangulated surface
    (vertices (V, 3), triangles (T, 3))."""
    if value is None:
        raise OptionRefused(
            f"'{option}' is missing", option=option, advice="name another surface, or a height"
        )
    if isinstance(value, str):
        return value
    if isinstance(value, (tuple, list)) and len(value) == 2 and np.ndim(value[0]) == 2:
        try:
            vertices = np.ascontiguousarray(value[0], np.float64)
            triangles = np.ascontiguousarray(value[1], np.int32)
        except (TypeError, ValueError) as error:
            raise OptionRefused(f"'{option}' is no triangulated surface", option=option) from error
        if vertices.shape[1:] != (3,) or triangles.ndim != 2 or triangles.shape[1] != 3:
            raise OptionRefused(
                f"'{option}' must be vertices (V, 3) and triangles (T, 3), not {vertices.shape} and "
                f"{triangles.shape}",
                option=option,
            )
        return vertices, triangles
    if np.ndim(value) == 1:
        try:
            return np.asarray(value, np.float64)
        except (TypeError, ValueError) as error:
            raise OptionRefused(f"'{option}' is not an array of heights", option=option) from error
    return number(option, value)


def one_of(*known: str):
    """The check of an option that is one of a few words."""

    def check(option: str, value) -> str:
        if value not in known:
            choices = "' or '".join(known)
            raise OptionRefused(f"'{option}' cannot be {value!r}", option=option, advice=f"use '{choices}'")
        return value

    return check


def _table(option: str, value, required: Sequence[str], optional: Sequence[str]) -> dict:
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


def _model(option: str, value) -> str:
    if not isinstance(value, str) or value not in VARIOGRAM_MODELS:
        raise OptionRefused(
            f"unknown variogram model {value!r}", option=option, advice=f"use {', '.join(VARIOGRAM_MODELS)}"
        )
    return value


def variogram(option: str, value) -> dict | None:
    """{model, range, sill, nugget}, or {nugget, structures = [{model, range, sill, anisotropy}, ...]} for a
    nested one; a Variogram found by an earlier interpolation is taken as well. None: to be fitted."""
    if value is None:
        return None
    if hasattr(value, "settings"):
        value = value.settings()
    if isinstance(value, Mapping) and "structures" in value:
        return _nested(option, value)
    parts = _table(option, value, ("model", "range", "sill"), ("nugget",))
    model = _model(f"{option}.model", parts["model"])
    sill = positive(f"{option}.sill", parts["sill"])
    nugget = not_negative(f"{option}.nugget", parts.get("nugget", 0.0))
    if nugget > sill:
        raise OptionRefused(
            f"the nugget, {nugget:g}, is more than the sill, {sill:g}",
            option=f"{option}.nugget",
            advice="the sill includes the nugget",
        )
    reach = positive(f"{option}.range", parts["range"])
    return {"model": model, "range": reach, "sill": sill, "nugget": nugget}


def _nested(option: str, value: Mapping) -> dict:
    parts = _table(option, value, ("structures",), ("nugget",))
    listed = parts["structures"]
    if not isinstance(listed, (list, tuple)) or not listed:
        raise OptionRefused(
            f"'{option}.structures' must be a list of tables",
            option=f"{option}.structures",
            advice='write structures = [{model = "spherical", range = ..., sill = ...}, ...]',
        )
    structures = []
    for entry in listed:
        name = f"{option}.structures"
        own = _table(name, entry, ("model", "range", "sill"), ("anisotropy",))
        structure = {
            "model": _model(name, own["model"]),
            "range": positive(f"{name}.range", own["range"]),
            "sill": positive(f"{name}.sill", own["sill"]),
        }
        if own.get("anisotropy") is not None:
            structure["anisotropy"] = anisotropy(f"{name}.anisotropy", own["anisotropy"])
        structures.append(structure)
    nugget = not_negative(f"{option}.nugget", parts.get("nugget", 0.0))
    return {"nugget": nugget, "structures": structures}


def anisotropy(option: str, value) -> dict | None:
    """{ratio, azimuth}. None: found with a variogram that is fitted, and none with one that is given."""
    if value is None:
        return None
    parts = _table(option, value, ("ratio", "azimuth"), ())
    return {
        "ratio": positive(f"{option}.ratio", parts["ratio"]),
        "azimuth": number(f"{option}.azimuth", parts["azimuth"]),
    }


def check_threads(threads) -> int:
    """The number of threads: 0 for as many as the machine has."""
    if not _is_whole(threads) or int(threads) < 0:
        raise UsageError(f"threads must be a whole number from 0 (all that there are), not {threads!r}")
    return int(threads)
