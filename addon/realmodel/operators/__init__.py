# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the panel, `bpy.ops.realmodel.*`, also for scripts and F3."""

from ..registration import register_modules, unregister_modules
from . import (
    background,
    booleans,
    boreholes,
    build,
    documentation,
    ensemble,
    files,
    imports,
    judge,
    library,
    looks,
    origin,
    pictures,
    plan_mesh,
    results,
    rocks,
    sections,
    start,
    structures,
    surfaces,
    tiles,
    variograms,
    view,
)

_MODULES = (
    start,
    origin,
    rocks,
    plan_mesh,
    imports,
    surfaces,
    structures,
    boreholes,
    tiles,
    variograms,
    build,
    files,
    judge,
    library,
    looks,
    results,
    ensemble,
    view,
    pictures,
    sections,
    booleans,
    background,
    documentation,
)


def register():
    register_modules(_MODULES)


def unregister():
    unregister_modules(_MODULES)
