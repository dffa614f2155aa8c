# SPDX-License-Identifier: GPL-3.0-or-later
"""Ties: the heights at the nodes of a mesh are corrected so that the surface passes through its contacts,
also within triangles, and keeps its bounds there (native/include/realmodel/interpolation/ties.hpp)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..base.errors import place_text
from ..base.work import Work, native_module
from ..readers.tables.observations import BESIDE_BOUND, Bounds
from .bounded import consistent
from .mis_ties import contradictions, first_at_each_place, shuffled, without_mis_ties

_TOLERANCE = 1e-10  # of the height range of the data: nearer is right
_DIGITS = 4  # of the last digits of heights, if that is more
_MISSED = 10  # tolerances: what is farther off is listed


class Terms(NamedTuple):
    """A correction, as native tied_heights takes it."""

    radii: np.ndarray
    positions: np.ndarray
    sided: np.ndarray
    coefficients: np.ndarray


@dataclass(frozen=True)
class TieData:
    """What a surface is to honor: places (C, 2), no two equal, and lower and upper (C,), equal at contacts,
    infinite where there is no bound; margins: (C,), by how much bounds are narrowed, where there is room;
    contacts: their number, which come first; left_out: the number of points that contradict others at their
    place. tolerance: of heights."""

    places: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    margins: np.ndarray
    contacts: int
    left_out: int
    tolerance: float


def tie_data(points: np.ndarray, bounds: Bounds | None) -> TieData:
    """What points (P, 3) and bounds ask of a surface. Where points at one place differ by a mis-tie, their
    mean counts; those that contradict one another do not."""
    points, _ = without_mis_ties(points)
    wrong = contradictions(points) if len(points) else np.zeros(0, bool)
    contacts = first_at_each_place(points[~wrong])
    places, lower, upper, heights = contacts[:, :2], contacts[:, 2], contacts[:, 2], [points[:, 2]]
    margins = np.zeros(len(contacts))
    if bounds is not None and len(bounds):
        limits = consistent(contacts, bounds)
        places = np.concatenate([places, limits.positions])
        heights.append(bounds.places[:, 2])
        margin = np.minimum(
            BESIDE_BOUND * float(np.ptp(np.concatenate(heights))), (limits.upper - limits.lower) / 3
        )
        lower = np.concatenate([lower, limits.lower + margin])
        upper = np.concatenate([upper, limits.upper - margin])
        margins = np.concatenate([margins, margin])
    every = np.concatenate(heights)
    tolerance = 0.0
    if len(every):
        digits = float(np.spacing(np.abs(every).max()))
        tolerance = max(_TOLERANCE * float(np.ptp(every)), _DIGITS * digits)
    places = np.ascontiguousarray(places)
    return TieData(places, lower, upper, margins, len(contacts), int(wrong.sum()), tolerance)


def corrected(
    work: Work, nodes: np.ndarray, triangles: np.ndarray, z: np.ndarray, data: TieData
) -> tuple[np.ndarray, list[str]]:
    """Heights (N,) at the nodes of a planar mesh with which the surface honors the data: those that it has
    where it does already. And warnings about data that it cannot honor."""
    if not len(data.places):
        return z, missed_warnings(data, np.empty(0))
    terms, after = correction(work, nodes, triangles, *one_sheet(z, data))
    if len(terms.radii):
        z = tied_heights(work, z, nodes, terms)
    return z, missed_warnings(data, after)


def correction(
    work: Work, nodes: np.ndarray, triangles: np.ndarray, sheets: tuple, data: TieData, of_sheet: np.ndarray
) -> tuple[Terms, np.ndarray]:
    """The correction of sheets, as native ties takes them, whose heights are requested only at the corners of
    triangles with data; and how far the sheet of each of the data lies below it then, (C,), NaN where it has
    no triangle. of_sheet: (C,) int32, to which sheet each of the data counts."""
    # of contacts near one another the first ones count more: they must not lie on one side
    order = np.concatenate(
        [shuffled(data.places[: data.contacts]), np.arange(data.contacts, len(data.places))]
    )
    asked = (data.places[order], data.lower[order], data.upper[order], of_sheet[order])
    solution = work.native(native_module().ties, nodes, triangles, sheets, asked, data.tolerance)
    faults = sheets[1].shape[1]
    count = len(solution["positions"])
    terms = Terms(
        solution["radii"],
        solution["positions"].reshape(-1, 2),
        solution["sided"].reshape(count, faults),
        solution["coefficients"].reshape(len(solution["radii"]), count),
    )
    after = np.empty(len(order))
    after[order] = solution["after"]
    return terms, after


def one_sheet(z: np.ndarray, data: TieData) -> tuple[tuple, TieData, np.ndarray]:
    """A sheet that no fault divides, with heights (N,), and data as `correction` takes them."""
    none = np.empty((1, 0)), np.empty((0, len(z)))
    return (z, *none), data, np.zeros(len(data.places), np.int32)


def tied_heights(
    work: Work, z: np.ndarray, nodes: np.ndarray, terms: Terms, sided: np.ndarray | None = None
) -> np.ndarray:
    """Heights (N,) of a sheet at nodes, corrected; the same bits for some nodes as for all. sided: (N, F),
    the sheet's sides of faults times their weights at the nodes."""
    sided = np.empty((len(nodes), 0)) if sided is None else sided
    as_given = (terms.radii, terms.positions, terms.sided, terms.coefficients)
    return work.native(native_module().tied_heights, z, np.ascontiguousarray(nodes), sided, as_given)


def raised_heights(
    work: Work, nodes: np.ndarray, triangles: np.ndarray, z: np.ndarray, least: np.ndarray, data: TieData
) -> np.ndarray:
    """Heights (N,) at nodes (N, 2), at or above the least ones (N,), NaN where there is none, with which a
    sheet that was raised to these honors its data within triangles as far as they leave room."""
    asked = (data.places, data.lower, data.upper, data.margins)
    return work.native(native_module().raised_heights, nodes, triangles, (z, least), asked, data.tolerance)


def missed_warnings(data: TieData, after: np.ndarray) -> list[str]:
    """The warnings about data that a surface does not honor. after: as of correction."""
    warnings = []
    if data.left_out:
        warnings.append(
            f"{data.left_out} of its points contradict others at their position and are not fitted"
        )
    off = np.abs(np.nan_to_num(after)) - data.margins
    missed = off > _MISSED * data.tolerance
    for which, name in ((slice(None, data.contacts), "points"), (slice(data.contacts, None), "bounds")):
        if missed[which].any():
            misfits = off[which]
            worst = int(misfits.argmax())
            place = place_text(data.places[which][worst].tolist())
            warnings.append(
                f"{int(missed[which].sum())} of {len(misfits)} {name} cannot be honored beside others: the "
                f"surface misses one at {place} by {misfits[worst]:.4g}"
            )
    return warnings
