# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of a surface beside faults that die out, tied to their data together: beyond the ends of a fault
its two sides have one sheet, and stay so."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...base.triangles import Sheet, median_edge
from ...base.work import Work
from ...heights.ties import TieData, correction, missed_warnings, tie_data, tied_heights
from ...readers.tables.observations import Bounds
from ...surfaces.rock_structure import RockStructure
from .tips import share_of_sides


def sides_of_sheets(structure: RockStructure, number: int, sheets: Sequence[Sheet]) -> np.ndarray:
    """(S, F) float64 the sides of faults on which sheets of a surface lie; 0 where a sheet lies on both, or
    the fault is not there."""
    active = structure.faults.active(number)
    sheet_sides = np.zeros((len(sheets), structure.compartments.shape[1]))
    for row, sheet in enumerate(sheets):
        compartments = [n for n, made in enumerate(structure.sheets) if made[number] is sheet]
        sides = structure.compartments[compartments]
        sheet_sides[row] = np.where(active & (sides == sides[0]).all(axis=0), sides[0], 0)
    return sheet_sides


def weights_of_sheets(structure: RockStructure, mesh: Sheet, z: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """(F, N) how far sheets on the two sides of each fault may differ at the nodes of a planar mesh: 0 where
    they are equal, and no fault between them parts the rock: each dies out, or is not there beside one of
    them. z: (S, N), their heights."""
    nodes, triangles = mesh
    ramp = median_edge(nodes, triangles)
    dies_out = np.array(structure.faults.dies_out, bool)
    equal = np.zeros((sides.shape[1], len(nodes)), bool)
    for one in range(len(sides)):
        for other in range(one + 1, len(sides)):
            between = sides[one] != sides[other]
            if (dies_out | (sides[one] * sides[other] == 0))[between].all():
                equal[between] |= z[one] == z[other]
    return np.array([share_of_sides(nodes, is_equal, ramp) for is_equal in equal]).reshape(equal.shape)


def data_of_sheets(
    points: np.ndarray, bounds: Bounds, of_points: np.ndarray, of_bounds: np.ndarray, count: int
) -> tuple[TieData, np.ndarray]:
    """What points (P, 3) and bounds ask of so many sheets together, and (C,) int32, of which. of_points,
    of_bounds: to which each counts; -1: none."""
    parts = [tie_data(points[of_points == sheet], bounds.some(of_bounds == sheet)) for sheet in range(count)]
    first = [np.arange(len(part.places)) < part.contacts for part in parts]
    order = np.argsort(~np.concatenate(first), kind="stable")
    sheets = np.repeat(np.arange(count, dtype=np.int32), [len(part.places) for part in parts])
    data = TieData(
        np.concatenate([part.places for part in parts])[order],
        np.concatenate([part.lower for part in parts])[order],
        np.concatenate([part.upper for part in parts])[order],
        np.concatenate([part.margins for part in parts])[order],
        sum(part.contacts for part in parts),
        sum(part.left_out for part in parts),
        max((part.tolerance for part in parts), default=0.0),
    )
    return data, sheets[order]


def tied_sheets(
    work: Work, mesh: Sheet, z: np.ndarray, sided: tuple[np.ndarray, np.ndarray], data: tuple
) -> tuple[list[np.ndarray], list[str]]:
    """Heights (N,) of each sheet, the same objects where none is corrected, and warnings. sided: (S, F) and
    (F, N), of sides_of_sheets and weights_of_sheets. data: of data_of_sheets."""
    nodes, triangles = mesh
    sides, weights = sided
    asked, of_sheet = data
    terms, after = correction(
        work, nodes, triangles, (np.ascontiguousarray(z), sides, weights), asked, of_sheet
    )
    rows = list(z)
    if len(terms.radii):
        rows = [
            tied_heights(
                work, np.ascontiguousarray(sheet_z), nodes, terms, np.ascontiguousarray(side * weights.T)
            )
            for sheet_z, side in zip(z, sides, strict=True)
        ]
    return rows, missed_warnings(asked, after)
