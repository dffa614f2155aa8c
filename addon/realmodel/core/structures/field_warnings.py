# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about the field of a series: data that it does not honor, critical points, data that it lacks."""

from __future__ import annotations

import numpy as np

from ..base.errors import BuildWarning, number_list, place_text
from ..base.triangles import Sheet
from ..base.work import Work
from ..fields import ScalarField, SolvedField, are_on
from ..fields.series_field import SeriesField
from ..project.series import Series
from ..readers.tables.observations import KINDS, LeftOut
from ..surfaces.doubtful_heights import farthest
from ..surfaces.rock_input import RockInput
from ..surfaces.wrong_sides import heights_at
from .series_data import SeriesData

_LISTED = 12  # data that a warning names
_DIFFER = 1 / 3  # of the volume of a block


def warn_of_lacks(entry: RockInput, series: Series, lacks: list[str], compartments: list[str]) -> None:
    """Adds the warning that compartments, by their names, have the field of all data. lacks: the names of the
    surfaces without contacts there."""
    what = "compartment" if len(compartments) == 1 else "compartments"
    text = (
        f"{series.item}: {what} {number_list(compartments, _LISTED)} without contacts of "
        f"{number_list(lacks, _LISTED)}: the field there is that of all data, as if no fault displaced it; "
        "give contacts of each surface on both sides of the faults"
    )
    entry.warnings.append(BuildWarning(text, "contacts", entry.rock.name))


def warn_of_direction(entry: RockInput, series: Series, compartments: list[str]) -> None:
    """Adds the warning that compartments, by their names, have no dips, which alone show the direction to
    younger rock for one surface."""
    what = "compartment" if len(compartments) == 1 else "compartments"
    text = (
        f"{series.item}: {what} {number_list(compartments, _LISTED)} without dips: those of the others say "
        "in which direction the rock gets younger there; give one"
    )
    entry.warnings.append(BuildWarning(text, "dips", entry.rock.name))


def warn_of_distance(entry: RockInput, series: Series, places: np.ndarray) -> None:
    """Adds the warning that some of the data of a series, at places (N, 3), lie far from the region."""
    outlier = farthest(entry.planar_mesh().vertices[:, :2], places)
    if outlier is None:
        return
    text = (
        f"{series.item}: data lie up to {outlier[1]:.3g} beyond the region, as at "
        f"{place_text(places[outlier[0]])}: the lattice of the field reaches there, and an automatic "
        "resolution is coarser for it; check their coordinates"
    )
    entry.warnings.append(BuildWarning(text, "contacts", entry.rock.name))


def leave_out(entry: RockInput, series: Series, data: SeriesData, field: SolvedField) -> None:
    """Lists bounds that are left out of a field, with what they contradict; those of one observation once.
    Warns of them."""
    others: dict[str, LeftOut] = {}
    contradicted = field.contradicted or [[] for _ in field.bounds_missed]
    for row, against in zip(field.bounds_missed.tolist(), contradicted, strict=True):
        others.setdefault(data.bound_text(row), data.left_out(row, against))
    left_out = list(others.values())
    if left_out:
        entry.left_out += left_out
        text = f"{len(left_out)} {KINDS['contradiction']}"
        _add(entry, series, text, "contradiction", [bound.text for bound in left_out])


def warn_of_field(
    entry: RockInput, series: Series, data: SeriesData, field: SolvedField, off: np.ndarray
) -> None:
    """Adds the warnings about dips and bounds that a field does not honor. off: rows of these bounds."""
    dips = [
        f"{data.item('dip', n)} at {place_text(data.dips[n].tolist())}" for n in field.dips_missed.tolist()
    ]
    if dips:
        text = f"its polarity does not hold at {len(dips)} dips, which contradict other data"
        _add(entry, series, text, "dips", dips)
    if len(off):
        count = "a place is" if len(off) == 1 else f"{len(off)} places are"
        text = f"{count} on the wrong side: other data contradict it, or a finer resolution is needed"
        _add(entry, series, text, "observations", [data.bound_text(n) for n in off.tolist()])


def warn_of_critical_points(entry: RockInput, series: Series, points: np.ndarray) -> None:
    """Adds the warning about critical points (P, 3) of the fields of a series in its rock mass."""
    if len(points):
        is_one = len(points) == 1
        text = f"its field has {len(points)} critical point{'' if is_one else 's'}, where beds close or part"
        _add(entry, series, text, "critical_points", [place_text(point) for point in points.tolist()])


def warn_of_volumes(entry: RockInput, series: Series, numbers: list[int], field: SolvedField) -> None:
    """Adds the warning that blocks have other volumes with a plainer field. numbers: of the surfaces."""
    plain = field.plain_shares
    if not len(plain):
        return
    block = np.searchsorted(field.levels, field.values)
    shares = np.bincount(block, minlength=len(plain)) / len(block)
    differ = np.flatnonzero(np.abs(shares - plain) > _DIFFER * plain)
    surfaces = [entry.rock.surfaces[number].name for number in numbers]
    where = [f"below '{surfaces[0]}'", *(f"above '{name}'" for name in surfaces)]
    listed = [f"{where[n]} {shares[n]:.1%} and {plain[n]:.1%} of the lattice" for n in differ.tolist()]
    if listed:
        text = "volumes differ by a third from those of a field as smooth in all directions; give dips there"
        _add(entry, series, text, "volumes", listed)


def warn_of_thicknesses(entry: RockInput, series: Series, missed: list[str]) -> None:
    """Adds the warning that beds have other thicknesses than given ones, as texts say."""
    if missed:
        text = "beds are thicker or thinner than was measured, as other data want it"
        _add(entry, series, text, "observations", missed)


def within_rock(work: Work, entry: RockInput, points: np.ndarray) -> np.ndarray:
    """(P,) bool: which points (P, 3) lie over the region and on or above the base of a rock mass."""
    base = entry.rock.base_elevation
    assert base is not None  # fields have one
    vertices, triangles = entry.planar_mesh()
    level = Sheet(np.column_stack([vertices[:, :2], np.zeros(len(vertices))]), triangles)
    return np.isfinite(heights_at(work, level, points[:, :2])) & (points[:, 2] >= base)


def warn_of_contacts(
    entry: RockInput, own: SeriesField, number: int, sheets: dict[ScalarField, Sheet]
) -> None:
    """Adds the warning about contacts of a surface that its level set does not pass through. sheets: of each
    field the level set."""
    missed = []
    for field, sheet in sheets.items():
        contacts = field.points[field.point_values == field.levels[number - own.first]]
        missed += contacts[~are_on(contacts, sheet)].tolist()
    if missed:
        count = "a contact lies" if len(missed) == 1 else f"{len(missed)} contacts lie"
        text = f"{count} beside it, one at {place_text(tuple(missed[0]))}: use a finer resolution"
        surface = entry.rock.surfaces[number].name
        entry.warnings.append(BuildWarning(text, "contacts", entry.rock.name, surface))


def _add(entry: RockInput, series: Series, text: str, kind: str, listed: list[str]) -> None:
    text = f"{series.item}: {text}: {number_list(listed, _LISTED)}"
    entry.warnings.append(BuildWarning(text, kind, entry.rock.name))
