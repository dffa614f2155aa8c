# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of methods between the settings of a surface and realmodel.core."""

import json

from ..core.methods import METHODS, OPTIONS
from .settings import number, set_number

_TABLES = {  # settings of the options that are tables, as SHOWN has them
    "anisotropy": ("use_anisotropy", ("anisotropy_ratio", "anisotropy_azimuth")),
    "variogram": (None, ()),
}


def switch_of(name):
    """The setting that switches an option on; None where it is always on."""
    option = OPTIONS[name]
    if option.beside is not None:
        return switch_of(option.beside)
    return None if option.switch is None else f"use_{name}"


def _shown(name, option):
    if option.kind == "table":
        return _TABLES[name]
    if option.beside is not None:
        return None, ()
    beside = [other for other, given in OPTIONS.items() if given.beside == name]
    return switch_of(name), (name, *beside)


# Settings that the panel shows for an option: the switch before it, if it has one, its own and those beside.
SHOWN = {name: _shown(name, option) for name, option in OPTIONS.items()}
READY_MESHES = ("MESH_OBJECT", "MESH_FILE")  # sources of surfaces that are not interpolated
_VARIOGRAM = ("range", "sill", "nugget")


def interpolates(rock):
    """Whether surfaces of a rock mass are interpolated on its mesh, or may yet be: there are none."""
    return not len(rock.surfaces) or any(row.source not in READY_MESHES for row in rock.surfaces)


def options_of(row):
    """The options of a surface's method as realmodel.core takes them; those at their default are left out."""
    known = METHODS[row.method].options
    options = json.loads(row.other_options) if row.other_options else {}
    options = {key: value for key, value in options.items() if key in known}
    if row.fit_variogram:
        options.pop("variogram", None)
    for name, option in known.items():
        if name in options or name not in SHOWN:
            continue
        value = _value(row, name)
        if value is not None and value != option.default:
            options[name] = value
    return options


def _value(row, name):
    option, (switch, _) = OPTIONS[name], SHOWN[name]
    switch = switch or switch_of(name)
    if switch is not None and not getattr(row, switch):
        return None
    if name == "variogram":
        return None if row.fit_variogram else _variogram(row)
    if name == "anisotropy":
        return _anisotropy(row)
    if option.kind in ("word", "whole"):
        return getattr(row, name)
    if option.kind == "surface":
        return _surface_or_height(getattr(row, name))
    value = number(row, name)
    return None if option.zero_is_none and value == 0.0 else value


def _surface_or_height(text):
    text = text.strip()
    try:
        return float(text)
    except ValueError:
        return text or None


def _variogram(row):
    if len(row.structures):
        return {
            "nugget": number(row, "variogram_nugget"),
            "structures": [_structure(part) for part in row.structures],
        }
    return {
        "model": row.variogram_model,
        **{key: number(row, f"variogram_{key}") for key in _VARIOGRAM},
    }


def _structure(part):
    found = {"model": part.model, **{key: number(part, key) for key in ("range", "sill")}}
    if part.use_anisotropy:
        found["anisotropy"] = {key: number(part, key) for key in ("ratio", "azimuth")}
    return found


def _anisotropy(row):
    return {key: number(row, f"anisotropy_{key}") for key in ("ratio", "azimuth")}


def set_options(row, method, options):
    """Sets a surface's method and its options from a project; what the panel has no setting for is kept."""
    if method is not None:
        row.method = method
    other = {}
    for name, value in options.items():
        if not _set(row, name, value):
            other[name] = value.settings() if hasattr(value, "settings") else value
    row.other_options = json.dumps(other) if other else ""


def _set(row, name, value):
    """Whether the settings of a surface could take an option's value."""
    if value is None:
        return True
    if name not in OPTIONS:
        return False
    option, (switch, _) = OPTIONS[name], SHOWN[name]
    if switch is not None:
        setattr(row, switch, True)
    if name == "variogram":
        return _set_variogram(row, value)
    if name == "anisotropy":
        for key, part in value.items():
            set_number(row, f"anisotropy_{key}", part)
    elif option.kind in ("word", "whole"):
        setattr(row, name, value)
    elif option.kind == "surface":
        if not isinstance(value, (str, int, float)):
            return False
        setattr(row, name, value if isinstance(value, str) else repr(value))
    else:
        set_number(row, name, value)
    return True


def _set_variogram(row, value):
    value = value.settings() if hasattr(value, "settings") else value
    row.fit_variogram = False
    row.structures.clear()
    if "structures" in value:
        set_number(row, "variogram_nugget", value.get("nugget", 0.0))
        for given in value["structures"]:
            _set_structure(row.structures.add(), given)
        return True
    row.variogram_model = value["model"]
    for key in _VARIOGRAM:
        set_number(row, f"variogram_{key}", value.get(key, 0.0))
    return True


def _set_structure(part, given):
    part.model = given["model"]
    for key in ("range", "sill"):
        set_number(part, key, given[key])
    for key, value in (given.get("anisotropy") or {}).items():
        part.use_anisotropy = True
        set_number(part, key, value)


def take_up_nested_variogram(row):
    """A nested variogram that a file of an earlier version has kept as it was gets its rows."""
    others = json.loads(row.other_options) if row.other_options else {}
    if "variogram" in others:
        _set_variogram(row, others.pop("variogram"))
        row.other_options = json.dumps(others) if others else ""
