# SPDX-License-Identifier: GPL-3.0-or-later
"""The series of a rock mass, stored in its row."""

import json

from ..core import InputRefused, Series, SpaceDips
from ..core.settings.series import FIELD
from . import stored_arrays

_KEYS = ("name", "kind", "dips", "resolution")


def keep(row, series):
    """Stores realmodel.core.Series with dips as arrays."""
    row.series = json.dumps([_entry(each) for each in series]) if series else ""


def _entry(series):
    dips = series.space_dips()
    packed = None if dips is None else stored_arrays.pack(positions=dips.positions, normals=dips.normals)
    return {"name": series.name, "kind": series.kind, "resolution": series.resolution, "dips": packed}


def of_row(row):
    """The stored series. Raises InputRefused for damaged text."""
    return [
        Series(each["name"], each["kind"], _dips(each["dips"]), each["resolution"]) for each in _entries(row)
    ]


def fields(row):
    """The names of the series whose surfaces are level sets. Raises InputRefused for damaged text."""
    return {each["name"] for each in _entries(row) if each["kind"] == FIELD}


def _entries(row):
    if not row.series:
        return []
    try:
        entries = json.loads(row.series)
        return [{key: each[key] for key in _KEYS} for each in entries]
    except (KeyError, TypeError, ValueError) as error:
        raise InputRefused(
            f"what the .blend keeps of its series cannot be read: {error}",
            advice="open the project file again",
        ) from error


def _dips(text):
    return None if text is None else SpaceDips(**stored_arrays.unpack(text))
