# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts settings, by their declarations (core/settings/setting.py), between the properties of a row and
realmodel.core; also those of methods with their variograms."""

import numpy as np

from ...core import MeshFile, PointFile
from ...core.settings.method_options import surface
from ...core.settings.methods import DEFAULT_OPTIONS, METHODS, OPTIONS, STRUCTURE
from ...core.settings.setting import declarations, property_name, settings_of, switch_name
from . import reading_text as texts
from .settings import number, rock_of, set_number

NUMBERS = ("number", "length", "finite")  # kinds that keep all their digits
READY_MESHES = ("MESH_OBJECT", "MESH_FILE")  # sources of surfaces that are not interpolated


def interpolates(rock):
    """Whether surfaces of a rock mass are interpolated on its mesh, or may yet be: there are none."""
    return not len(rock.surfaces) or any(row.source not in READY_MESHES for row in rock.surfaces)


def has_method(row):
    """Whether a surface's method is used: the surface is interpolated, or a ready mesh that is continued to
    faults by a chosen method."""
    if row.source not in READY_MESHES:
        return True
    return row.use_continuation and len(row.id_data.realmodel.faults) > 0


def value(row, key, settings):
    """A setting of a row as realmodel.core takes it; None where it is not given. Raises InputRefused."""
    setting, name = settings[key], property_name(key, settings[key])
    switch = switch_name(key, settings)
    if switch is not None and not getattr(row, switch):
        return None
    if setting.parts:
        parts = {part: value(row, part, setting.parts) for part in setting.parts}
        parts = {part: content for part, content in parts.items() if content is not None}
        return texts.columns(parts) if setting.kind == "columns" else parts or None
    if setting.kind in NUMBERS:
        entry = number(row, name)
    else:
        read = texts.READ.get(setting.kind)
        entry = getattr(row, name) if read is None else read(getattr(row, name))
    is_none = (
        entry == "" or (entry == "NONE" and "" in setting.words) or (setting.zero_is_none and entry == 0)
    )
    return None if is_none and setting.kind != "name" else entry


def values(row, entry, shape=None):
    """The settings of a row that the panel shows of a dataclass, by its fields. shape: those with an effect
    on it alone."""
    return {
        part.name: content
        for part in declarations(entry)
        if is_shown(part.setting) and (shape is None or part.setting.fits(shape))
        if (content := value(row, part.key, settings_of(entry))) is not None
    }


def set_value(row, key, settings, given):
    """Sets a setting of a row, and its switch; None, and "auto" in the place of a number, unset it."""
    setting, name = settings[key], property_name(key, settings[key])
    switch = switch_name(key, settings)
    if switch is not None and setting.beside is None:
        setattr(row, switch, given is not None)
    if setting.parts:
        for part, inner in texts.parts_of(setting, given).items():
            set_value(row, part, setting.parts, inner)
    elif setting.kind in texts.FILL:
        texts.FILL[setting.kind](row, name, given)
    elif given is None or (setting.kind == "length" and isinstance(given, str)):
        row.property_unset(name)
        if setting.kind == "word":
            setattr(row, name, setting.default or "NONE")
    elif setting.kind in NUMBERS:
        set_number(row, name, given)
    else:
        setattr(row, name, given)


def set_values(row, entry, source):
    """Sets the settings of a row that the panel shows of a dataclass, from one; those that it lacks are
    unset."""
    for part in declarations(entry):
        if is_shown(part.setting):
            set_value(row, part.key, settings_of(entry), getattr(source, part.name, part.default))


def point_file(row, path):
    """The PointFile of a row whose file is at a path. Raises InputRefused."""
    return PointFile(path, **values(row, PointFile))


def fill_reading(row, file=None):
    """Sets how the file of a row is read, from a PointFile or MeshFile; None: as most files are."""
    set_values(row, PointFile if hasattr(row, "filters") else MeshFile, file)


def is_shown(setting):
    """Whether a row has properties of a setting; those of methods are set with their options."""
    return bool(setting.label) and setting.kind != "method"


def dips_unused(row):
    """Sentences about dips that the method of a surface's row does not use: its own, which a build refuses,
    or those of its rock mass."""
    if row.source in READY_MESHES or METHODS[row.method].is_constrained:
        return []
    if row.dips:
        able = ", ".join(method.label for method in METHODS.values() if method.is_constrained)
        return [f"The method of '{row.name}' does not use dips: choose one of {able}, or remove the dips"]
    if rock_of(row).dips:
        return [f"Dips of the rock mass have no effect on '{row.name}': its method does not use them"]
    return []


def options_of(row):
    """The options of a surface's method as realmodel.core takes them; those at their default are left out."""
    declared = METHODS[row.method].options
    options = {key: option for key, option in _other_options(row.other_options) if key in declared}
    for key, setting in declared.items():
        option = _variogram(row) if key == "variogram" else value(row, key, OPTIONS)
        if key not in options and option is not None and option != setting.default:
            options[key] = option
    return options


def set_options(row, method, options):
    """Sets a surface's method and its options from a project; arrays, which have no setting in the panel, are
    stored."""
    if method is not None:
        row.method = method
        for key in DEFAULT_OPTIONS.keys() & METHODS[method].options.keys():  # of a row without a method
            set_value(row, key, OPTIONS, METHODS[method].options[key].default)
    others = {}
    for key, option in options.items():
        if key == "variogram" and option is not None:
            set_variogram(row, option)
        elif OPTIONS[key].kind != "surface" or option is None or np.isscalar(option):
            set_value(row, key, OPTIONS, option)
        elif isinstance(heights := surface(key, option), tuple):
            others[f"{key} vertices"], others[f"{key} triangles"] = heights
        else:
            others[key] = heights
    row.other_options = others


def _other_options(stored):
    """(key, heights or a triangulation) of the options that `set_options` has stored."""
    for name, array in stored.items():
        key, _, part = name.partition(" ")
        if part != "triangles":
            yield key, (array, stored[f"{key} triangles"]) if part else array


def _variogram(row):
    """The variogram as in a project file; None where it is to be fitted."""
    if row.fit_variogram:
        return None
    variogram = value(row, "variogram", OPTIONS)
    if not len(row.structures):
        return variogram
    structures = [{key: value(part, key, STRUCTURE) for key in STRUCTURE} for part in row.structures]
    for part in structures:
        if part["anisotropy"] is None:
            del part["anisotropy"]
    return {"nugget": variogram["nugget"], "structures": structures}


def set_variogram(row, given):
    """Sets the variogram of a surface's row, which then is not fitted: as a project file writes it, or one
    found by an earlier interpolation."""
    given = given.settings() if hasattr(given, "settings") else given
    row.fit_variogram = False
    row.structures.clear()
    given = {"nugget": 0.0, **given}
    structures = given.pop("structures", ())
    set_value(row, "variogram", OPTIONS, given)
    for structure in structures:
        part = row.structures.add()
        for key in STRUCTURE:
            set_value(part, key, STRUCTURE, structure.get(key))


def take_fitted(row, fitted):
    """Sets the variogram that a build has fitted, as a project file writes it; it is not fitted again."""
    parts = fitted.get("structures", ())
    if len(parts) == 1:  # one with an anisotropy of its own
        anisotropy = parts[0].get("anisotropy")
        if anisotropy is not None:
            set_value(row, "anisotropy", OPTIONS, anisotropy)
        nugget = fitted["nugget"]
        fitted = {key: parts[0][key] for key in ("model", "range", "sill")} | {"nugget": nugget}
        fitted["sill"] += nugget  # of a structure it is without the nugget
    set_variogram(row, fitted)
