# SPDX-License-Identifier: GPL-3.0-or-later
"""How surfaces are interpolated, by what models say of holes that are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..base.errors import BuildFailed, InputRefused
from ..model.build import build
from ..project.project import Project, Rock, Surface
from ..project.series import Series
from ..settings.rules import RULES
from ..settings.series_kinds import SHEETS
from ..validation.left_out_holes import cross_validate_holes

_FOLDS = 5
_COARSE = 2.0  # times the edge length, for trials
_FEW = 6  # holes: fewer show no variogram
_MOST_HOLES = 150  # with more no trials are made: each surface has data enough of its own
_BETTER = 0.005  # of the length in the right unit: less is no reason for another way


def with_methods(project: Project, holes: int) -> tuple[list[Rock], str]:
    """The rock masses with the way of interpolation that has most of the length of left-out holes in the
    right unit, and why."""
    rock = project.rocks[0]
    sheets = _with_sheets(rock)
    plain = "each surface separately, by kriging (the default method)"
    if 0 < holes < _FEW:
        surfaces = [s if s.method or not s.has_points else replace(s, method="auto") for s in rock.surfaces]
        rock = replace(rock, surfaces=surfaces)
        plain = "each surface separately, by the method that predicts left-out points best (few points)"
    if not sheets.series:
        return [rock], f"{plain}: no two that follow one another are conformable"
    if not 3 <= holes <= _MOST_HOLES:
        return [rock], plain
    alone = _share(project, rock)
    if alone is None or alone > 1 - _BETTER:
        right = "" if alone is None else f": left-out holes are right along {alone:.1%} of their length so"
        return [rock], plain + right
    together = _share(project, sheets)
    if together is None:
        return [rock], plain
    figures = f"left-out holes are right along {alone:.1%} of their length so, and {together:.1%}"
    if together > alone + _BETTER:
        figures = f"left-out holes are right along {together:.1%} of their length so, and {alone:.1%}"
        return [sheets], f"conformable surfaces together, in series: {figures} by itself each"
    return [rock], f"{plain}: {figures} with conformable surfaces in series"


def _share(project: Project, rock: Rock) -> float | None:
    """Of the length of left-out holes, in the right unit; None where such models cannot be built."""
    assert isinstance(rock.edge_length, float)
    trial = replace(rock, edge_length=_COARSE * rock.edge_length)
    try:
        model = build(
            Project(project.name, [trial], units=project.units)
        )  # bodies are the same in all trials
        return cross_validate_holes(model, _FOLDS).share
    except (InputRefused, BuildFailed):
        return None


def _with_sheets(rock: Rock) -> Rock:
    """The rock mass with its runs of conformable surfaces in series of sheets."""
    series: list[Series] = []
    surfaces: list[Surface] = []
    for run in _runs(rock.surfaces[:-1]):
        if len(run) > 1:
            name = f"series {len(series) + 1}"
            series.append(Series(name, SHEETS))
            run = [replace(surface, series=name) for surface in run]
        surfaces += run
    return replace(rock, surfaces=[*surfaces, rock.surfaces[-1]], series=series)


def _runs(surfaces: Sequence[Surface]) -> list[list[Surface]]:
    """Consecutive surfaces that do not cut; each that does by itself."""
    runs: list[list[Surface]] = []
    for surface in surfaces:
        cuts = RULES[surface.rule].cuts
        if not cuts and runs and not RULES[runs[-1][-1].rule].cuts:
            runs[-1].append(surface)
        else:
            runs.append([surface])
    return runs
