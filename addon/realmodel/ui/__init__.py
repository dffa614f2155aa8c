# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab "RealModel" of the 3D viewport's sidebar: one module for each of its panels, in their order."""

from ..registration import register_modules, unregister_modules
from . import (
    booleans,
    build,
    codes,
    ensemble,
    field_data,
    hole_validation,
    judge,
    library,
    lists,
    menu,
    planned_holes,
    proposal,
    results,
    rocks,
    series,
    start,
    strata,
    structures,
    surfaces,
    view,
)

_MODULES = (
    *(
        lists,
        start,
        proposal,
        rocks,
        surfaces,
        series,
        field_data,
        codes,
        structures,
        judge,
        build,
        view,
        library,
    ),
    *(results, hole_validation, ensemble, planned_holes, booleans, strata, menu),
)


def register():
    register_modules(_MODULES)


def unregister():
    unregister_modules(_MODULES)
