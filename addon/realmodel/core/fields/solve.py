# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a series from its data, and random fields that honor the data, for the realizations of a
series in an ensemble."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..base.algebra import dot, norm
from ..base.errors import InputRefused, place_text
from ..base.stored_objects import NOT_STORED
from ..base.work import NativeError, Work, refused_as
from .given_kind import Kind, solved_as_given
from .lattice import Lattice, ScalarField

_NO_POINTS = np.empty((0, 3))
_NO_NUMBERS = np.empty(0, np.int32)
_NO_SHARES = np.empty(0)
_LINES = 256  # of a random function
_STEPS = 1024  # of each line
MOST_CENTERS = 2500  # contacts that carry a field: their system is solved within seconds


def _item(kind: str, row: int) -> str:
    return f"{kind} {row}"


@dataclass(frozen=True, eq=False)
class SlitData:
    """Faults: each gives places one more coordinate, which jumps across it, so that the field may differ on
    its two sides; around the tips of those that die out it is one function.

    contacts (N, F), dips (M, F), bounds (B, F): the coordinates of data. slopes: (M, F, 3) how they rise at
    dips. normals: (F, 3) of the faults in the mean, of length 1. nodes: (S, nodes, F) the coordinates of a
    lattice's nodes, on each combination of sides as if the faults were not there. same: (S, nodes) int64:
    combination * nodes + node of the first combination that has the same coordinates there by being beyond
    tips. bound_sides: (B,) int32 the combination that each bound is on.
    """

    contacts: np.ndarray
    dips: np.ndarray
    bounds: np.ndarray
    slopes: np.ndarray
    normals: np.ndarray
    nodes: np.ndarray
    same: np.ndarray
    bound_sides: np.ndarray

    def native(self) -> tuple:
        """The argument of the native module."""
        sides, _, count = self.nodes.shape
        arrays = (self.contacts, self.dips, self.bounds, self.slopes)
        return (
            count,
            sides,
            *(np.ascontiguousarray(array, np.float64).ravel() for array in arrays),
            np.ascontiguousarray(self.normals, np.float64),
            np.ascontiguousarray(self.nodes, np.float64).ravel(),
            self.same.ravel(),
            self.bound_sides,
        )


@dataclass(frozen=True, eq=False)
class LevelSetData:
    """What is known of a field whose level sets are surfaces, oldest first.

    names: of the surfaces. contacts: (N, 3) points on surfaces; contact_surfaces: (N,) which. dips: (M, 3)
    points; normals: (M, 3) of length 1, the direction there in which rock gets younger. bounds: (B, 3)
    points between surfaces: above surface bound_below (B,) and below surface bound_above (B,), -1: none.
    slits: faults that die out. error: how far contacts may be off, as a standard deviation, at least; the
    data may show more. item: names a datum in errors, from "contact", "dip" or "bound" and its row.
    keeps_thickness: whether beds keep their thickness around bends and beyond the data, as in parallel folds;
    None: if this predicts data better that are left out. dip_error: the same of dips, in degrees. range:
    beyond this distance data say nothing of the field but its tilt; None: as they show.
    """

    names: Sequence[str]
    contacts: np.ndarray
    contact_surfaces: np.ndarray
    dips: np.ndarray = field(default_factory=_NO_POINTS.copy)
    normals: np.ndarray = field(default_factory=_NO_POINTS.copy)
    bounds: np.ndarray = field(default_factory=_NO_POINTS.copy)
    bound_below: np.ndarray = field(default_factory=_NO_NUMBERS.copy)
    bound_above: np.ndarray = field(default_factory=_NO_NUMBERS.copy)
    slits: SlitData | None = None
    item: Callable[[str, int], str] = _item
    error: float = 0.0
    keeps_thickness: bool | None = None
    dip_error: float = 0.0
    range: float | None = None


@dataclass(frozen=True)
class Anisotropy:
    """A field bends less along some directions. axes: orthonormal, the fold axis first. ratios: how much, 1
    as across them, 0.01 a hundredth of it; of order 5 one over the ranges, in units of half of the lattice's
    diagonal."""

    axes: tuple[tuple[float, float, float], ...]
    ratios: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class FieldDraw:
    """How a field is drawn at random, as the data allow. kind: of random function, as of the SolvedField of
    the same data and lattice. normal: gives so many independent normal numbers (N,), each time others."""

    kind: tuple
    normal: Callable[[int], np.ndarray]

    def native(self, data: LevelSetData) -> tuple:
        """The argument of the native module."""
        slits = 0 if data.slits is None else data.slits.nodes.shape[2]
        directions = self.kind[-2]  # of places where beds keep their thickness
        counts = _LINES * (3 + slits), _LINES * _STEPS, 2 * len(data.dips) + len(directions)
        return (self.kind, *map(self.normal, counts))


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedField(ScalarField):
    """A field with the results of its solution: the anisotropy; the order of the derivatives that are least,
    3, or 2 where surfaces are rough, or 5: all up to it, where the data are smooth; how many contacts carry
    the field; the largest distance of a contact from its surface, nearly; rows of the dips and bounds that
    contradict other data and do not hold; the fields on the other combinations of sides of slits; the kind of
    random function, of which the native module draws others; of each of the missed bounds what it
    contradicts: "contact", "dip" or "bound", and the row; and the share of the lattice that each block, from
    the oldest, has with the best field that has no ranges and no anisotropy, none if it is this or predicts
    data clearly worse. Of one that is drawn critical points are not asked."""

    anisotropy: Anisotropy
    order: int
    centers: int
    misfit: float
    dips_missed: np.ndarray
    bounds_missed: np.ndarray
    others: tuple[SolvedField, ...] = ()
    kind: tuple = field(default=(), repr=False, metadata=NOT_STORED)
    contradicted: list[list[tuple[str, int]]] = field(default_factory=list, repr=False, metadata=NOT_STORED)
    plain_shares: np.ndarray = field(default_factory=_NO_SHARES.copy, repr=False, metadata=NOT_STORED)


def solve_field(
    lattice: Lattice,
    data: LevelSetData,
    work: Work,
    tolerance: float = 0.0,
    draw: FieldDraw | None = None,
) -> SolvedField:
    """The smoothest field that honors the data (docs/reference/methods.md#fields-of-series). With `draw`: a
    random field with the roughness of the data.

    tolerance: the distance by which surfaces may miss contacts where there are too many for all of them to
    carry the field. Raises InputRefused for data
    outside the lattice, contacts that contradict one another, surfaces whose order contradicts the data, and
    a dip whose polarity is against that of its neighbors.
    """
    of_lattice = (lattice.origin, lattice.spacing, lattice.counts)
    slits = None if data.slits is None else data.slits.native()
    with refused_as(lambda error: _refusal(error, data)) as native:

        def solved(drawn: tuple | None) -> dict[str, Any]:
            return work.native(
                native.solve_field,
                of_lattice,
                (len(data.names), data.contacts, data.contact_surfaces, data.error),
                (data.dips, data.normals),
                (data.bounds, data.bound_below, data.bound_above),
                (tolerance, MOST_CENTERS, data.keeps_thickness),
                slits,
                drawn,
            )

        def of_kind(kind: Kind) -> dict[str, Any]:
            return solved(kind.without_chance(0 if slits is None else slits[0], len(data.dips)))

        with work.phase(0.0, 0.95, "fitting the field", has_steps=True):
            solution = solved(None if draw is None else draw.native(data))
            if draw is None and (data.dip_error or data.range is not None):
                solution = solved_as_given(solution, lattice, data.dip_error, data.range, of_kind)
        every = solution["values"].reshape(-1, lattice.nodes)
        with work.phase(0.95, 1.0, "critical points of the field"):
            points = [
                _NO_POINTS
                if draw is not None
                else lattice.positions()[work.native(native.critical_points, of_lattice, values)[0]]
                for values in every
            ]
    (axes, ratios), order, *_ = solution["kind"]
    first = SolvedField(
        lattice=lattice,
        values=every[0],
        levels=solution["levels"],
        anisotropy=Anisotropy(tuple(map(tuple, axes)), tuple(ratios)),
        order=order,
        centers=solution["centers"],
        misfit=solution["misfit"],
        dips_missed=solution["dips_missed"],
        bounds_missed=solution["bounds_missed"],
        critical_points=points[0],
        kind=solution["kind"],
        contradicted=solution["contradicted"],
        plain_shares=solution["plain_shares"],
    )
    others = zip(every[1:], points[1:], strict=True)
    return replace(
        first,
        others=tuple(replace(first, values=values, critical_points=places) for values, places in others),
    )


def _refusal(error: NativeError, data: LevelSetData) -> InputRefused:
    """The native error with the names of surfaces and data."""
    if error.kind == "no_direction":
        return InputRefused(
            "the direction to younger rock is not known",
            advice="give dips, or contacts of a second surface",
        )
    if error.kind == "no_contacts":
        return InputRefused(
            "it has no contacts", item=f"surface '{data.names[error.surface]}'", advice="give one at least"
        )
    make = {
        "contradicting": _contradicting,
        "wrong_order": _wrong_order,
        "against_order": _against_order,
        "polarity": _polarity,
        "outside": _outside,
    }.get(error.kind)
    return make(error, data) if make else InputRefused(str(error), place=error.place)


def _place(error: NativeError) -> str:
    return "" if error.place is None else place_text(error.place)


def _contradicting(error: NativeError, data: LevelSetData) -> InputRefused:
    names = [data.names[data.contact_surfaces[row]] for row in error.items]
    if len(names) == 1:
        what = f"it contradicts contacts of surface '{names[0]}' next to it"
    else:
        what = f"surfaces '{names[0]}' and '{names[1]}' have a contact at one place, {_place(error)}"
    return InputRefused(
        what,
        item=data.item("contact", error.items[-1]),
        advice="surfaces of a series do not touch; leave one of them out",
        place=error.place,
    )


def _wrong_order(error: NativeError, data: LevelSetData) -> InputRefused:
    older, younger = data.names[error.surface], data.names[error.surface + 1]
    return InputRefused(
        f"near {_place(error)} it lies on the older side of surface '{older}', which is listed as older",
        item=f"surface '{younger}'",
        advice=_advice_on_order(data, "exchange the two"),
        place=error.place,
    )


def _against_order(error: NativeError, data: LevelSetData) -> InputRefused:
    return InputRefused(
        f"at {len(error.items)} of {len(data.dips)} dips rock gets younger the other way than from the first "
        f"to the last of them, as at {_place(error)}",
        item=f"surfaces '{data.names[0]}' to '{data.names[-1]}'",
        advice=_advice_on_order(data, "list the oldest surface first"),
        place=error.place,
    )


def _advice_on_order(data: LevelSetData, change: str) -> str:
    """What to do where surfaces and dips seem to be in the wrong order. change: where they are. They are in
    order where most contacts of a surface lie, from the nearest one of the surface listed before it, to the
    side to which rock gets younger at the nearest dip: then no other list helps."""
    votes = 0.0
    for older in range(len(data.names) - 1):
        lower, upper = (data.contacts[data.contact_surfaces == number] for number in (older, older + 1))
        for place in upper if len(lower) and len(data.dips) else ():
            away = place - lower[norm(lower - place).argmin()]
            normal = data.normals[norm(data.dips - place).argmin()]
            votes += np.sign(dot(away, normal))
    if votes <= 0:
        return f"{change}, or correct the polarity of the dips"
    return (
        "the surfaces are in the order that the dips say, but a field through all contacts and dips turns "
        'over: look for wrong ones, give how far contacts may be off, or choose the kind "sheets"'
    )


def _polarity(error: NativeError, data: LevelSetData) -> InputRefused:
    return InputRefused(
        f"at {_place(error)} rock gets younger the other way than at the nearest dips, which have "
        "its attitude",
        item=data.item("dip", error.items[0]),
        advice="correct its polarity: 1 upright, -1 overturned",
        place=error.place,
    )


def _outside(error: NativeError, data: LevelSetData) -> InputRefused:
    kind = str(error).split()[0]
    return InputRefused(
        f"{_place(error)} lies outside the lattice of the field",
        item=data.item(kind, error.items[0]),
        advice="make the region or the base reach beyond it, or leave it out",
        place=error.place,
    )


_PARTS = 3  # of the normal numbers of a field: directions, steps, errors of dips


@dataclass(frozen=True)
class FieldDraws:
    """How the fields of a series are drawn. normal: (part, count) gives (count,) independent normal numbers.
    known: the kind of random function by the data that it follows from, filled as they come, the same for
    all realizations. top: an elevation above all rock of the model, of which they are realizations."""

    normal: Callable[[int, int], np.ndarray]
    known: dict[bytes, tuple]
    top: float

    def field(self, lattice: Lattice, data: LevelSetData, work: Work, number: int) -> SolvedField:
        """The field of the data, drawn. number: of the field in its series. Raises as solve_field."""
        digest = hashlib.sha256(repr(lattice).encode())
        digest.update(repr((data.error, data.dip_error, data.range)).encode())
        for array in (data.contacts, data.dips, data.normals, data.bounds):
            digest.update(np.ascontiguousarray(array))
        key = digest.digest()
        if key not in self.known:
            with work.part(0.0, 0.5):
                self.known[key] = solve_field(lattice, data, work).kind
        parts = iter(range(_PARTS * number, _PARTS * (number + 1)))
        draw = FieldDraw(self.known[key], lambda count: self.normal(next(parts), count))
        with work.part(0.5, 1.0):
            return solve_field(lattice, data, work, draw=draw)
