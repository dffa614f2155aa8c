# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of settings: each returns the value as it is used, or refuses it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..base.errors import InputRefused, UsageError
from .setting import Setting, Settings, declarations


class OptionRefused(InputRefused):
    """A setting is not as it must be; `option` is its name, for the line in a file."""

    def __init__(self, what: str, option: str | None = None, advice: str | None = None, **where: Any):
        super().__init__(what, advice=advice, **where)
        self.option = option


def _is_whole(value: object) -> bool:
    return hasattr(value, "__index__") and not isinstance(value, (bool, np.bool_))


def is_name(value: object) -> bool:
    """Whether a value may name something."""
    return isinstance(value, str) and bool(value.strip()) and not any(ord(c) < 32 for c in value)


def checked(option: str, setting: Setting, value: Any) -> Any:
    """The value of a setting as it is used. Raises OptionRefused."""
    if setting.check is not None:
        return setting.check(option, value)
    if value is None and setting.default is None:
        return None
    if setting.kind == "word":
        return _word(option, setting, value)
    if setting.kind == "surface":
        return surface(option, value)
    if setting.parts:
        return table(option, setting.parts, value)
    if setting.kind == "whole":
        bound = "" if setting.low is None else f" from {setting.low:g}"
        least = -(2**31) if setting.low is None else int(setting.low)
        if not _is_whole(value) or not least <= int(value) < 2**31:
            raise OptionRefused(f"'{option}' must be a whole number{bound}, not {value!r}", option=option)
        return int(value)
    if setting.kind == "truth":
        if not isinstance(value, (bool, np.bool_)):
            raise OptionRefused(f"'{option}' must be true or false, not {value!r}", option=option)
        return bool(value)
    if setting.kind in ("text", "any_surface", "rock_mass", "series"):
        if not is_name(value):
            raise OptionRefused(f"'{option}' must be a name, not {value!r}", option=option)
        return value
    return number(option, setting, value) if setting.kind in ("number", "length") else value


def without(fault: Callable[[Any], str | None]) -> Callable[[str, Any], Any]:
    """The check of a value that `fault` finds nothing wrong with."""

    def check(key: str, value: Any) -> Any:
        if value is not None and (what := fault(value)):
            raise OptionRefused(what, option=key)
        return value

    return check


def check_fields(entry: Any) -> None:
    """Refuses values of a dataclass that the declarations of its fields do not allow. Raises
    OptionRefused."""
    kind: type = type(entry)
    for part in declarations(kind):
        value = getattr(entry, part.name)
        if part.setting.kind != "options":  # those are checked with their method
            checked(part.key, part.setting, value)


def number(option: str, setting: Setting, value: Any) -> float:
    name = option.rpartition(".")[2]
    try:
        real = float(value) if not isinstance(value, (bool, str)) else math.nan
    except (OverflowError, TypeError, ValueError):
        real = math.nan
    if not math.isfinite(real):
        raise OptionRefused(f"'{name}' must be a finite number, not {value!r}", option=option)
    if setting.above is not None:
        if real <= setting.above:
            raise OptionRefused(f"'{name}' must be more than {setting.above:g}, not {real:g}", option=option)
    elif setting.low is not None and real < setting.low:
        raise OptionRefused(f"'{name}' must be at least {setting.low:g}, not {real:g}", option=option)
    if setting.below is not None and real >= setting.below:
        raise OptionRefused(f"'{name}' must be below {setting.below:g}, not {real:g}", option=option)
    if setting.below is None and setting.high is not None and real > setting.high:
        raise OptionRefused(f"'{name}' must be at most {setting.high:g}, not {real:g}", option=option)
    return real


def surface(option: str, value: Any) -> Any:
    """Another surface: a height, its name in a project, heights at the nodes (N,), or a triangulated surface
    (vertices (V, 3), triangles (T, 3))."""
    if value is None:
        raise OptionRefused(
            f"'{option}' is missing", option=option, advice="name another surface, or an elevation"
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
            raise OptionRefused(f"'{option}' is not an array of elevations", option=option) from error
    return number(option, Setting(), value)


def _word(option: str, setting: Setting, value: Any) -> str:
    if not isinstance(value, str) or value not in setting.words:
        choices = "' or '".join(setting.words)
        name = option.rpartition(".")[2]
        raise OptionRefused(f"'{name}' cannot be {value!r}", option=option, advice=f"use '{choices}'")
    return value


def table(option: str, parts: Settings, value: Any) -> dict:
    """The values of a table by its parts; those without a default are needed. Raises OptionRefused."""
    if not isinstance(value, Mapping):
        shape = ", ".join(f"{key} = ..." for key in parts)
        raise OptionRefused(f"'{option}' must be a table", option=option, advice=f"write {{{shape}}}")
    for key in value:
        if key not in parts:
            raise OptionRefused(
                f"unknown key '{key}' in '{option}'",
                option=f"{option}.{key}",
                advice=f"known are {', '.join(parts)}",
            )
    for key, part in parts.items():
        if key not in value and part.default is None and not part.switch:
            raise OptionRefused(f"'{option}' lacks '{key}'", option=option)
    values = {
        key: checked(f"{option}.{key}", part, value.get(key, part.default)) for key, part in parts.items()
    }
    return {key: entry for key, entry in values.items() if entry is not None}


def variogram(parts: Settings, structure: Settings) -> Callable[[str, Any], Any]:
    """The check of a variogram: {model, range, sill, nugget}, or {nugget, structures = [{model, range, sill,
    anisotropy}, ...]} for a nested one; a Variogram found by an earlier interpolation is taken as well. None:
    to be fitted."""
    nested = {"nugget": parts["nugget"], "structures": Setting(check=lambda *pair: structures(*pair))}

    def structures(option: str, value: Any) -> list[dict]:
        if not isinstance(value, (list, tuple)) or not value:
            raise OptionRefused(
                f"'{option}' must be a list of tables",
                option=option,
                advice='write structures = [{model = "spherical", range = ..., sill = ...}, ...]',
            )
        return [table(option, structure, entry) for entry in value]

    def check(option: str, value: Any) -> dict | None:
        if value is None:
            return None
        if hasattr(value, "settings"):
            value = value.settings()
        if isinstance(value, Mapping) and "structures" in value:
            return table(option, nested, value)
        content = table(option, parts, value)
        if content["nugget"] > content["sill"]:
            raise OptionRefused(
                f"the nugget, {content['nugget']:g}, is more than the sill, {content['sill']:g}",
                option=f"{option}.nugget",
                advice="the sill includes the nugget",
            )
        return content

    return check


def check_threads(threads: Any) -> int:
    """The number of threads: 0 for as many as the machine has."""
    if not _is_whole(threads) or int(threads) < 0:
        raise UsageError(f"threads must be a whole number from 0 (all that there are), not {threads!r}")
    return int(threads)
