# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a surface above those of a younger one that cuts, at one place: it would have removed them.

Where there is no point of the younger surface at the place nothing can be said: a surface that was eroded is
often given as it was before.
"""

from __future__ import annotations

from collections.abc import Collection
from itertools import combinations

import numpy as np

from ..base.build_warning import BuildWarning
from ..base.errors import number_list, place_text
from ..settings.rules import RULES
from .observed.surface_data import SurfaceData
from .rock_input import RockInput
from .shared_places import is_raster, places_of
from .wrong_sides import WrongPoints, points_that_lie

_MOST = 20_000  # points that are picked; more are a survey, and may be of another time


def points_above_younger(entry: RockInput, numbers: Collection[int]) -> list[BuildWarning]:
    """The points of surfaces, of these numbers, that contradict the order of a RockInput that is read.

    Two points in one hole contradict it wherever the older one lies higher. Points with
    the same x and y do where most of two surfaces are so: single ones may be of a surface that was continued
    above the ground. Rasters are left out: they may be of one ground at several times.
    """
    surfaces, data = entry.rock.surfaces, entry.data
    checked = [n for n in sorted(numbers) if _may_be_picks(data[n].known_points)]
    points = {n: data[n].points for n in checked}
    places = dict(zip(checked, places_of(list(points.values())), strict=True)) if checked else {}
    wrong_points: dict[int, WrongPoints] = {}
    holes: dict[int, list[str]] = {}
    for older, younger in combinations(checked, 2):
        if RULES[surfaces[older].rule].protects or not RULES[surfaces[younger].rule].cuts:
            continue  # the points of the younger one are looked at instead: wrong_sides
        if younger == older + 1 and surfaces[younger].minimum_thickness is not None:
            continue  # found where this is imposed
        older_rows, younger_rows, names = _in_one_hole(data[older], data[younger])
        if not len(older_rows):
            older_rows, younger_rows = places[older].shared_with(places[younger])
        above = points[older][older_rows]
        beyond = above[:, 2] - points[younger][younger_rows, 2]
        if not names and 2 * (beyond > 0).sum() <= (beyond != 0).sum():
            continue
        by_number = np.argsort(older_rows)
        wrong = WrongPoints.of(above[by_number], beyond[by_number], younger, older_rows[by_number])
        if wrong is not None:
            wrong_points[older] = wrong_points[older].joined(wrong) if older in wrong_points else wrong
            holes.setdefault(older, []).extend(
                name for name, by in zip(names, beyond, strict=False) if by > 0
            )
    return [_warning(entry, older, wrong, holes[older]) for older, wrong in wrong_points.items()]


def _may_be_picks(points: np.ndarray) -> bool:
    return 0 < len(points) <= _MOST and not is_raster(points)


def _warning(entry: RockInput, older: int, wrong: WrongPoints, holes: list[str]) -> BuildWarning:
    rock, data = entry.rock, entry.data[older]
    row = data.row(wrong.worst)
    names = number_list([f"'{rock.surfaces[younger].name}'" for younger in wrong.others])
    text = (
        f"{points_that_lie(len(wrong.items), len(data.points))} above those of {names} at the "
        f"same place, the farthest by {wrong.by:.4g}: point {row} at {place_text(wrong.place)}"
    )
    if holes:
        text += f"; holes {number_list(dict.fromkeys(holes))}"
    text += "; a younger surface removes what is above it: check the order of the surfaces, and these points"
    return BuildWarning(text, "wrong_side", rock.name, rock.surfaces[older].name, wrong.rows(data))


def _in_one_hole(first: SurfaceData, second: SurfaceData) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """The numbers of the points of two surfaces in the holes that meet both, (N,) each, and the holes."""
    first_rows, second_rows = (
        {source.hole: row for row, sources in data.sources.items() for source in sources}
        for data in (first, second)
    )
    holes = sorted(first_rows.keys() & second_rows.keys())
    rows = np.array([(first_rows[hole], second_rows[hole]) for hole in holes], int).reshape(-1, 2)
    return rows[:, 0], rows[:, 1], holes
