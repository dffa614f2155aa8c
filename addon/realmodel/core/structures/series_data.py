# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of a series whose surfaces are level sets: contacts, dips and bounds, with where each comes
from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import norm
from ..base.errors import place_text
from ..fields import LevelSetData, ScalarField, SlitData, SolvedField
from ..project.series import Series
from ..readers.tables.observations import Bounds, LeftOut, Origin, source_text
from ..settings.dips import SpaceDips
from ..surfaces.observed.conformable import mean_error
from ..surfaces.rock_input import RockInput

_MOST_BOUNDS = 20_000  # in ways through intervals: more take long, and say hardly more


@dataclass(frozen=True, eq=False)
class SeriesData:
    """entry: of its rock mass; numbers: of its surfaces there. contacts: (C, 3) with the number (C,) of the
    surface in the series that each is on, and its row (C,) among the points of that. dips, normals: (D, 3),
    with rows (D,). bounds: (B, 3) places, each with the number (B,) in the series of the surface whose level
    f is at most there, or else at least, by is_lower (B,) bool, and with its row (B,) among the bounds of
    that surface."""

    entry: RockInput
    numbers: list[int]
    contacts: np.ndarray
    surfaces: np.ndarray
    contact_rows: np.ndarray
    dips: np.ndarray
    normals: np.ndarray
    dip_rows: np.ndarray
    bounds: np.ndarray
    bound_surfaces: np.ndarray
    is_lower: np.ndarray
    bound_rows: np.ndarray

    @classmethod
    def of(cls, entry: RockInput, series: Series, numbers: list[int], step: float = np.inf) -> SeriesData:
        """step: how far places within an interval are apart at most."""
        points = [entry.data[number].points for number in numbers]
        dips = series.space_dips() or SpaceDips(np.empty((0, 3)), np.empty((0, 3)))
        of_dips = np.flatnonzero(dips.in_use)
        dip_rows = np.array([dips.row(number) for number in of_dips.tolist()], np.int64)
        positions, normals = dips.positions[of_dips], dips.normals[of_dips]
        bounds = [entry.data[number].bounds for number in numbers]
        step = max(step, sum(map(_length, bounds)) / _MOST_BOUNDS)
        placed = [surface_bounds.along(step) for surface_bounds in bounds]
        return cls(
            entry,
            numbers,
            np.concatenate(points),
            _owners([len(surface_points) for surface_points in points]),
            np.concatenate([np.arange(len(surface_points)) for surface_points in points]),
            positions,
            normals / norm(normals)[:, None],
            dip_rows,
            np.concatenate([places for places, _ in placed]),
            _owners([len(places) for places, _ in placed]),
            np.concatenate(
                [
                    surface_bounds.is_lower[rows]
                    for surface_bounds, (_, rows) in zip(bounds, placed, strict=True)
                ]
            ),
            np.concatenate([rows for _, rows in placed]),
        )

    def some(self, chosen: np.ndarray) -> SeriesData:
        """Those that `chosen`, bool, says of `positions`."""
        contacts, dips, bounds = np.split(chosen, np.cumsum([len(self.contacts), len(self.dips)]))
        return SeriesData(
            self.entry,
            self.numbers,
            *(column[contacts] for column in (self.contacts, self.surfaces, self.contact_rows)),
            *(column[dips] for column in (self.dips, self.normals, self.dip_rows)),
            *(
                column[bounds]
                for column in (self.bounds, self.bound_surfaces, self.is_lower, self.bound_rows)
            ),
        )

    def kept_rows(self, rows: np.ndarray) -> np.ndarray:
        """(C + D + B,) bool: all but some bounds, by their rows."""
        chosen = np.ones(len(self.contacts) + len(self.dips) + len(self.bounds), bool)
        chosen[len(self.contacts) + len(self.dips) + rows] = False
        return chosen

    def is_off(self, fields: Sequence[ScalarField], numbers: np.ndarray, near: float) -> np.ndarray:
        """(B,) bool: the bounds that do not hold in fields, each in the one with its number (B,), by more
        than `near` of the range of f."""
        off = np.zeros(len(self.bounds), bool)
        for number, field in enumerate(fields):
            here = np.flatnonzero(numbers == number)
            above = field.at(self.bounds[here]) - field.levels[self.bound_surfaces[here]]
            off[here] = np.where(self.is_lower[here], above, -above) > near * float(np.ptp(field.values))
        return off

    def known_to(self, field: SolvedField) -> SolvedField:
        """A field of these and of contacts that follow from thicknesses, of which it says nothing then."""
        count = len(self.contacts)
        contradicted = [
            [(kind, row) for kind, row in listed if kind != "contact" or row < count]
            for listed in field.contradicted
        ]
        return replace(field, contradicted=contradicted)

    def positions(self) -> np.ndarray:
        """(C + D + B, 3) the places of contacts, dips and bounds."""
        return np.concatenate([self.contacts, self.dips, self.bounds])

    def of_dips(self) -> np.ndarray:
        """(C + D + B,) bool: the rows of dips."""
        counts = len(self.contacts), len(self.dips), len(self.bounds)
        return np.repeat([False, True, False], counts)

    def missing(self, all_data: SeriesData) -> list[str]:
        """The names of the surfaces of which there are contacts in all data, but not here."""
        lacks = np.setdiff1d(all_data.surfaces, self.surfaces).tolist()
        return [self.entry.rock.surfaces[self.numbers[row]].name for row in lacks]

    def level_set_data(self, slits: SlitData | None, series: Series) -> LevelSetData:
        """The same for the solver, with what faults that die out say of it, and with its settings."""
        none = np.int32(-1)
        of_heights = mean_error([self.entry.data[number] for number in self.numbers])
        return LevelSetData(
            [self.entry.rock.surfaces[number].name for number in self.numbers],
            self.contacts,
            self.surfaces,
            self.dips,
            self.normals,
            self.bounds,
            np.where(self.is_lower, none, self.bound_surfaces),
            np.where(self.is_lower, self.bound_surfaces, none),
            slits,
            self.item,
            max(float(np.sqrt(of_heights)), series.error),
            series.keeps_thickness,
            series.dip_error,
            series.range,
        )

    def item(self, kind: str, row: int) -> str:
        """A datum in messages, by its kind, "contact", "dip" or "bound", and its row of that kind."""
        if kind == "dip":
            return f"dip {self.dip_rows[row]}"
        if kind == "bound":
            bounds = self._bounds_of(row)
            at = int(self.bound_rows[row])
            return source_text(str(bounds.holes[at]), float(bounds.depths[at]), self.bounds[row])
        if row >= len(self.contacts):
            return "a thickness"
        number, at = self.numbers[self.surfaces[row]], int(self.contact_rows[row])
        data = self.entry.data[number]
        is_point = at < data.contacts_from
        source = f"point {data.row(at)}" if is_point else data.source_text(at)
        return f"surface '{self.entry.rock.surfaces[number].name}', {source}"

    def left_out(self, row: int, against: Sequence[tuple[str, int]]) -> LeftOut:
        """A bound that is not used. against: what it contradicts, by kind and row."""
        bounds, at = self._bounds_of(row), int(self.bound_rows[row])
        others = tuple(dict.fromkeys(self._statement_text(*kind_and_row) for kind_and_row in against))
        return LeftOut(
            "contradiction",
            f"{self.bound_text(row)}, which contradicts {'; '.join(others) or 'data near it'}",
            self._block_of(row),
            *Origin.of(bounds.holes[at], bounds.depths[at])[:2],
            tuple(self.bounds[row].tolist()),
            others,
        )

    def _statement_text(self, kind: str, row: int) -> str:
        """The text of a datum, by its kind and row."""
        if kind == "bound":
            return self.bound_text(row)
        if kind == "dip":
            return f"{self.item(kind, row)} at {place_text(self.dips[row].tolist())}"
        number = self.numbers[self.surfaces[row]]
        text = self.entry.data[number].source_text(int(self.contact_rows[row]))
        return f"{text}: on '{self.entry.rock.surfaces[number].name}'"

    def bound_text(self, row: int) -> str:
        """The text of a bound."""
        name = self.entry.rock.surfaces[self.numbers[self.bound_surfaces[row]]].name
        side = "older" if self.is_lower[row] else "younger"
        block = self._block_of(row)
        return f"{self.item('bound', row)}{block and f' in {block!r}'}: on the {side} side of '{name}'"

    def _block_of(self, row: int) -> str:
        """The block in which a bound was seen; "" where it is not known."""
        bounds, at, observed = self._bounds_of(row), int(self.bound_rows[row]), self.entry.rock.observed
        if observed is None:
            return ""
        same = (observed.places == bounds.places[at]).all(axis=1)
        same &= observed.holes == bounds.holes[at]
        blocks = np.unique(observed.blocks[same])
        return str(blocks[0]) if len(blocks) == 1 else ""

    def _bounds_of(self, row: int) -> Bounds:
        return self.entry.data[self.numbers[self.bound_surfaces[row]]].bounds


def _owners(counts: list[int]) -> np.ndarray:
    return np.repeat(np.arange(len(counts)), counts).astype(np.int32)


def _length(bounds: Bounds) -> float:
    return 0.0 if bounds.ends is None else float(norm(bounds.ends - bounds.places).sum())
