# SPDX-License-Identifier: GPL-3.0-or-later
"""Series of a rock mass: consecutive surfaces that share their structure."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ..base.stored_objects import NOT_STORED
from ..base.toml_table import Source
from ..settings.dips import DIPS, DipFile, Dips, SpaceDips, dip_file_of
from ..settings.method_options import without
from ..settings.series_kinds import BY_DATA, FIELD, KINDS, PARALLEL, THICKNESSES, resolution_fault
from ..settings.setting import declared, described, settings_of
from .entry import Entry


@dataclass(eq=False)
class Series(Entry):
    """Consecutive surfaces of a rock mass that name it as their `series`.

    name: unique in the rock mass. kind: "field": its surfaces are level sets of one scalar field in space,
    which rises from older to younger; "sheets": they have one height at each position, and are interpolated
    together. dips: of the bedding, a file, a DipFile or SpaceDips; of sheets also Dips: each counts for the
    surface that it names, those of the series under and over its block, or for all where it names nothing.
    resolution: edge length of the lattice of a field, in model units, or "auto". thickness: of the beds of a
    field away from the data: "parallel", they keep it; "free"; or "auto", what the data say. error,
    dip_error: of a field, by how much its contacts (model units) and dips (degrees) are off at least, as a
    standard deviation. range: of a field, the distance beyond which they say nothing of it but its tilt;
    None: as they show.
    """

    name: str = declared(kind="name", label="Name", tip="Name of the series", is_needed=True)
    kind: str = declared(FIELD, kind="word", label="Kind", tip="How its surfaces are made", words=KINDS)
    dips: SpaceDips | Dips | DipFile | str | Path | None = described(DIPS)
    resolution: float | str = declared(
        BY_DATA,
        kind="length",
        label="Resolution",
        tip="Edge length of the lattice of the field",
        low=0.0,
        check=without(resolution_fault),
        zero_is_none=True,
        shapes=(FIELD,),
        unset="auto",
        more='`"auto"` (default): by the spacing of the contacts and the size of the rock mass',
    )
    thickness: str = declared(
        BY_DATA,
        kind="word",
        label="Thickness",
        tip="How thick the beds of a field are away from the data",
        words=THICKNESSES,
        shapes=(FIELD,),
    )
    error: float = declared(
        0.0,
        kind="length",
        label="Error",
        tip="Standard deviation of the errors of contacts. 0: as the data show it",
        low=0.0,
        shapes=(FIELD,),
        more="A given one is the least; see [errors and range](methods.md#errors-and-range-of-a-field)",
    )
    dip_error: float = declared(
        0.0,
        label="Dip Error",
        tip="Standard deviation of the errors of dips, in degrees. 0: as the data show it",
        low=0.0,
        below=90.0,
        shapes=(FIELD,),
        more="A given one is the least",
    )
    range: float | None = declared(
        kind="length",
        label="Range",
        tip="Distance beyond which contacts and dips do not influence the field",
        above=0.0,
        zero_is_none=True,
        shapes=(FIELD,),
        unset="as the data show it",
        more="Default: as the data show it",
    )
    source: Source | None = field(default=None, repr=False, compare=False, metadata=NOT_STORED)

    @property
    def item(self) -> str:
        return f"series '{self.name}'"

    @property
    def keeps_thickness(self) -> bool | None:
        """Whether the beds of a field keep their thickness away from the data; None: as the data say."""
        return None if self.thickness == BY_DATA else self.thickness == PARALLEL

    @property
    def dip_file(self) -> DipFile | None:
        """The file of its dips and how it is read; None where they are arrays, or there are none."""
        return None if isinstance(self.dips, SpaceDips) else dip_file_of(self.dips)

    def space_dips(self) -> SpaceDips | None:
        """The dips of a field that is read."""
        assert self.dips is None or isinstance(self.dips, SpaceDips)
        return self.dips

    def sheet_dips(self) -> Dips | None:
        """The dips of sheets that are read. Raises InputRefused where one is vertical or overturned."""
        if isinstance(self.dips, SpaceDips):
            return self.dips.checked().of_sheets()
        assert self.dips is None or isinstance(self.dips, Dips)
        return None if self.dips is None else self.dips.checked()


SERIES = settings_of(Series)
