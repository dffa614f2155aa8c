# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about base elevations that cut surfaces off, and about contacts that a younger surface removes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.errors import BuildWarning, InputRefused, place_text
from ..base.work import Work
from ..settings.rules import RULES
from ..surfaces.observed.columns import Succession
from ..surfaces.observed.kept_contacts import observed_contacts
from ..surfaces.rock_input import RockInput
from ..surfaces.wrong_sides import WrongPoints
from .closed_form import ClosedForm

_ROUNDING = 1e-12  # of an area: a surface with less below its base touches it


def check_bases(work: Work, inputs: Sequence[RockInput], forms: Sequence[ClosedForm]) -> None:
    """Adds warnings to rock masses whose surfaces are made about those that their bases cut off. Raises
    InputRefused for a base that is above all of a rock mass, or above a contact that would be lost."""
    for entry, form in zip(inputs, forms, strict=True):
        rock = entry.rock
        shapes = [
            None if rock.is_level_set(surface) else entry.surface(n)
            for n, surface in enumerate(rock.surfaces)
        ]
        vertices = [shape.vertices for shape in shapes if shape is not None]
        if not entry.reaches_base:
            continue
        assert rock.base_elevation is not None
        every = np.concatenate(vertices)
        highest = every[every[:, 2].argmax()]
        # level sets have no vertices: what is younger and cuts bounds them
        is_bounded = len(vertices) == len(shapes) or (
            shapes[-1] is not None and RULES[rock.surfaces[-1].rule].cuts
        )
        if is_bounded and highest[2] <= rock.base_elevation:
            what = "is not below any of the rock mass, whose highest point is"
            raise _refused(entry, what, highest, every[:, 2].min())
        for number, surface in enumerate(rock.surfaces):
            # any other lies on what is older, or on what that protects, which has its own base
            if shapes[number] is None or not (number == 0 or RULES[surface.rule].cuts):
                continue
            if rock.is_interpolated(surface) and len(entry.data[number].tied_points(surface)):
                _check_contacts(work, entry, form, number)
            if warning := _cut(work, entry, form, number):
                entry.warnings.append(warning)


def _refused(entry: RockInput, what: str, at: np.ndarray, lower: float) -> InputRefused:
    rock, place = entry.rock, tuple(at.tolist())
    file, line = rock.place_of("base_elevation")
    what = f"base_elevation {rock.base_elevation:.9g} {what} {place_text(place)}"
    advice = f"choose one below {lower:.9g}"
    return InputRefused(what, file=file, line=line, item=rock.item, advice=advice, place=place)


def _check_contacts(work: Work, entry: RockInput, form: ClosedForm, number: int) -> None:
    points = entry.data[number].measured_points
    deep = points[points[:, 2] < form.base_elevation]
    deep = deep[np.isfinite(form.heights(work, number, deep))]
    if len(deep):
        lowest = deep[deep[:, 2].argmin()]
        name = entry.rock.surfaces[number].name
        count = "a contact" if len(deep) == 1 else f"{len(deep)} contacts"
        what = f"is above {count} of surface '{name}', which would be lost: the lowest is"
        raise _refused(entry, what, lowest, lowest[2])


def _cut(work: Work, entry: RockInput, form: ClosedForm, number: int) -> BuildWarning | None:
    """The warning about a surface that reaches below the base where it bounds rock."""
    base = form.base_elevation
    total, below, lowest = 0.0, 0.0, np.full(3, np.inf)
    for compartment, sheets in enumerate(form.sheets):
        sheet = sheets[number]
        assert sheet is not None and base is not None  # as it is made
        corners = sheet.vertices[sheet.triangles]
        here = form.compartments_of(work, corners.mean(axis=1)) == compartment
        if form.region is not None and not sheet.has_plan_of(form.region):
            here &= form.is_over_region(work, corners.mean(axis=1))
        area, part = _areas(corners[here], base)
        total, below = total + area, below + part
        deepest = corners[here].reshape(-1, 3)
        if len(deepest) and deepest[:, 2].min() < lowest[2]:
            lowest = deepest[deepest[:, 2].argmin()]
    if not below > _ROUNDING * total:
        return None
    rock = entry.rock
    share = f"{100 * below / total:.2g} %" if below < 0.99 * total else f"{100 * below / total:.4g} %"
    text = (
        f"it reaches below base_elevation {base:.9g} on {share} of its area, and is cut off there: lowest at "
        f"{place_text(lowest)}"
    )
    return BuildWarning(text, "below_base", rock.name, rock.surfaces[number].name)


def _areas(corners: np.ndarray, base: float) -> tuple[float, float]:
    """The area in plan of triangles (T, 3, 3), and that of what of them is below a height."""
    u, v = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    area = 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    low, middle, high = np.sort(corners[:, :, 2] - base, axis=1).T
    with np.errstate(divide="ignore", invalid="ignore"):
        corner = low * low / ((middle - low) * (high - low))
        rest = 1.0 - high * high / ((high - low) * (high - middle))
    share = np.select([high <= 0, low >= 0, middle > 0], [1.0, 0.0, corner], rest)
    return float(area.sum()), float((area * share).sum())


_KEPT = "it is a ready mesh, or other data of it lie below them"
_NOT_KEPT = "to keep them: observed = true"
_OF_TERRAIN = "the terrain is not moved to them: check their elevations, and those of the collars of holes"


def warn_of_eroded_contacts(work: Work, inputs: Sequence[RockInput], forms: Sequence[ClosedForm]) -> None:
    """Adds these warnings to rock masses whose surfaces are made. Of surfaces that are not observed surveys
    and grids are left out, which are often given as they were before erosion, and what ready meshes remove:
    these stay as they are."""
    for entry, form in zip(inputs, forms, strict=True):
        rock, surfaces = entry.rock, entry.rock.surfaces
        succession = Succession([surface.rule for surface in surfaces])
        for number, surface in enumerate(surfaces):
            data = entry.data[number]
            if not surface.has_points or not (rock.is_level_set(surface) or len(data.tied_points(surface))):
                continue
            points = data.measured_points
            is_observed = bool(len(points)) and len(observed_contacts(surface, data)) == len(points)
            for cutter in succession.cut_later(number) if len(points) else ():
                is_terrain = cutter == rock.terrain_number
                if not is_observed and (is_terrain or not surfaces[cutter].has_points):
                    continue
                # infinite: a level set is nowhere in the compartment
                above = np.nan_to_num(-form.above(work, cutter, points), posinf=0.0, neginf=0.0)
                wrong = WrongPoints.of(points, above, cutter, np.arange(len(points)))
                if wrong is None or (wrong.is_part_of_survey(len(points)) and not is_observed):
                    continue
                text = (
                    f"it erodes {len(wrong.items)} of the {len(points)} contacts of '{surface.name}', the "
                    f"farthest lies {wrong.by:.4g} above it: point {data.row(wrong.worst)} at "
                    f"{place_text(wrong.place)}; "
                    f"{_OF_TERRAIN if is_terrain else _KEPT if is_observed else _NOT_KEPT}"
                )
                cutter_name = surfaces[cutter].name  # a stage without it has no such warning
                entry.warnings.append(
                    BuildWarning(text, "eroded", entry.rock.name, cutter_name, wrong.rows(data))
                )
