# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of sheets: what the surfaces of one know of the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...heights.companions import Companions
from ...project.project import Rock
from ...readers.tables.observations import Bounds
from ...settings.series import SHEETS
from .conformable import mean_error
from .surface_data import SurfaceData


def sheets_beside(rock: Rock, number: int) -> list[int]:
    """The surfaces of the series of sheets of one, itself included, oldest first; none where it is in
    none."""
    name = rock.surfaces[number].series
    for series in rock.series:
        if series.kind == SHEETS and series.name == name:
            return rock.members(series)
    return []


def with_least_thickness(rock: Rock) -> Rock:
    """A rock mass whose sheets of a series do not lie below the older one of it."""
    surfaces = list(rock.surfaces)
    for number, surface in enumerate(surfaces):
        beside = sheets_beside(rock, number)
        if beside and number > beside[0] and surface.minimum_thickness is None:
            surfaces[number] = replace(surface, minimum_thickness=0.0)
    return replace(rock, surfaces=surfaces)


def companions_of(
    rock: Rock, data: Sequence[SurfaceData], number: int, known: dict[bytes, Any]
) -> Companions | None:
    """The sheets with which a surface is interpolated; None where none of the others has points. known: as
    of Alike."""
    beside = sheets_beside(rock, number)
    if not any(len(data[other].points) for other in beside if other != number):
        return None
    sheets = [data[other] for other in beside]
    points = [np.ascontiguousarray(sheet.points) for sheet in sheets]
    dips = [sheet.dips for sheet in sheets]
    return Companions(beside.index(number), points, dips, known, mean_error(sheets))


def bounds_beside(bounds: Bounds, companions: Companions | None) -> Bounds:
    """Bounds of a surface, and those by the contacts of the other sheets: it lies at or above the older
    ones, and at or below the younger ones."""
    if companions is None:
        return bounds
    parts = [bounds]
    for other, points in enumerate(companions.points):
        if other != companions.own and len(points):
            is_older = np.full(len(points), other < companions.own)
            parts.append(replace(Bounds.at_or_above(points), is_lower=is_older))
    return Bounds.joined(parts)
