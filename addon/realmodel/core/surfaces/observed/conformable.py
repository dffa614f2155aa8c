# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are conformable, so that a series of sheets would interpolate them better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...base.build_warning import BuildWarning
from ...base.errors import InputRefused, number_list
from ...base.work import Work
from ...heights.companions import Companions
from ...heights.cross_validation import validate
from ...heights.interpolation import Task
from ...project.project import Rock
from ...settings.methods import checked_options

# contacts of a surface: fewer do not show that it follows another one; more show its own shape, and take long
_LEAST, _MOST = 8, 300
_BETTER = 0.8  # of the error alone: below it two surfaces are taken to be conformable


@dataclass(frozen=True)
class _Compared:
    """Mean squares of the errors of contacts left out, from those of their own surface and of both."""

    alone: float
    together: float


def proposals(work: Work, rock: Rock, numbers: Sequence[int]) -> list[BuildWarning]:
    """A warning for each run of consecutive surfaces among those of a rock mass with these numbers whose
    contacts, left out one by one, are estimated better with those of the next surface: they are conformable,
    and none of them is in a series."""
    runs: list[list[int]] = []
    errors: dict[tuple[int, int], _Compared] = {}
    known = [number for number in numbers if _is_known(rock, number)]
    for one, other in pairwise(known):
        if other != one + 1:
            continue
        found = _compared(work, rock, one, other)
        if found is None or not found.together < _BETTER**2 * found.alone:
            continue
        errors[one, other] = found
        if runs and runs[-1][-1] == one:
            runs[-1].append(other)
        else:
            runs.append([one, other])
    return [_proposal(rock, run, [errors[pair] for pair in pairwise(run)]) for run in runs]


def _is_known(rock: Rock, number: int) -> bool:
    surface = rock.surfaces[number]
    count = len(surface.point_array()) if surface.interpolated else 0
    return surface.series is None and _LEAST <= count <= _MOST


def _compared(work: Work, rock: Rock, *numbers: int) -> _Compared | None:
    """Of two surfaces; None where their points cannot be kriged."""
    surfaces = [rock.surfaces[number] for number in numbers]
    points = [np.ascontiguousarray(each.point_array()) for each in surfaces]
    dips = [each.known_dips() for each in surfaces]
    squares: list[list[np.ndarray]] = [[], []]
    settings, nodes = checked_options("kriging", {}), np.empty((0, 2))
    try:
        for own in range(2):
            for which, companions in enumerate((None, Companions(own, points, dips))):
                task = Task(work, points[own], nodes, settings, dips=dips[own], companions=companions)
                error = validate("kriging", task, 2).errors
                squares[which].append(error[np.isfinite(error)] ** 2)
    except InputRefused:  # it is said where the surface itself is interpolated
        return None
    alone, together = (np.concatenate(each) for each in squares)
    if not len(alone) or not len(together):
        return None
    return _Compared(float(alone.mean()), float(together.mean()))


def _proposal(rock: Rock, run: list[int], errors: list[_Compared]) -> BuildWarning:
    names = number_list([f"'{rock.surfaces[number].name}'" for number in run])
    alone, together = (
        float(np.sqrt(np.mean([getattr(each, key) for each in errors]))) for key in ("alone", "together")
    )
    text = (
        f"surfaces {names} are conformable: a contact that is left out is estimated with an error of "
        f"{alone:.3g} from its own surface, and of {together:.3g} with the next one: a series of the kind "
        '"sheets" interpolates them together, by method kriging'
    )
    return BuildWarning(text, "series", rock.name)
