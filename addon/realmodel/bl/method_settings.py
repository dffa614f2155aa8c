# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of methods between the settings of a surface and realmodel.core."""

import json

from ..core.methods import METHODS
from .settings import number, set_number

# Settings that the panel shows for an option: the switch before it, if it has one, and its own.
SHOWN = {
    "neighbours": ("use_neighbours", ("neighbours",)),
    "octants": (None, ("octants",)),
    "radius": (None, ("radius",)),
    "power": (None, ("power",)),
    "smoothing": (None, ("smoothing",)),
    "drift": (None, ("drift",)),
    "extrapolate": (None, ("extrapolate",)),
    "thickness_method": (None, ("thickness_method",)),
    "border": (None, ("border",)),
    "above": (None, ("above",)),
    "below": (None, ("below",)),
    "to": (None, ("to",)),
    "weight": ("use_weight", ("weight",)),
    "dip": ("use_dip", ("dip", "dip_direction")),
    "dip_direction": (None, ()),
    "value": ("use_value", ("value",)),
    "thickness": ("use_thickness", ("thickness",)),
    "anisotropy": ("use_anisotropy", ("anisotropy_ratio", "anisotropy_azimuth")),
    "variogram": (None, ()),
}
READY_MESHES = ("MESH_OBJECT", "MESH_FILE")  # sources of surfaces that are not interpolated
_SURFACES = ("border", "above", "below", "to")
_NONE_IS_ZERO = ("radius",)
_WORDS = ("drift", "extrapolate", "thickness_method")
_WHOLE = ("neighbours", "octants")
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
    switch, _ = SHOWN[name]
    if switch is not None and not getattr(row, switch):
        return None
    if name in _WORDS or name in _WHOLE:
        return getattr(row, name)
    if name in _SURFACES:
        return _surface_or_height(getattr(row, name))
    if name == "variogram":
        return None if row.fit_variogram else _variogram(row)
    if name == "anisotropy":
        return _anisotropy(row)
    if name == "dip_direction":
        return number(row, name) if row.use_dip else None
    value = number(row, name)
    return None if name in _NONE_IS_ZERO and value == 0.0 else value


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
    switch, _ = SHOWN.get(name, (None, ()))
    if switch is not None:
        setattr(row, switch, True)
    if name in _WORDS or name in _WHOLE:
        setattr(row, name, value)
    elif name in _SURFACES:
        if not isinstance(value, (str, int, float)):
            return False
        setattr(row, name, value if isinstance(value, str) else repr(value))
    elif name == "variogram":
        return _set_variogram(row, value)
    elif name == "anisotropy":
        for key, part in value.items():
            set_number(row, f"anisotropy_{key}", part)
    elif name in SHOWN:
        set_number(row, name, value)
    else:
        return False
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
