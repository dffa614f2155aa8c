# SPDX-License-Identifier: GPL-3.0-or-later
"""The coordinate reference system of a project, by its code. Nothing is converted by it: files that have a
place for it name it."""

from __future__ import annotations

import re

from .method_options import OptionRefused

_CODE = re.compile(r"([A-Za-z][A-Za-z0-9_.-]*):([A-Za-z0-9_.-]+)")
# As a number alone, "EPSG:25832", a URN or an address of OGC's, or at the end of well-known text.
_NAMED = re.compile(
    r'(?:EPSG[:/](?:[\d.]*[:/])?|(?:AUTHORITY|ID)\["EPSG",\s*"?|^)(\d{4,6})"?[\]\s]*$', re.IGNORECASE
)
MOST_DEGREES = 360.0  # of coordinates that may be degrees
_GEOGRAPHIC = (4258, 4267, 4269, 4326, 4490, 4979)  # those in degrees that are taken for projected ones most


def checked_crs(key: str, value: object) -> str | None:
    """A code such as "EPSG:25832", or None. Raises OptionRefused."""
    if value is None:
        return None
    advice = 'write the code of a projected system, such as "EPSG:25832"'
    if not (isinstance(value, str) and _CODE.fullmatch(value)):
        raise OptionRefused(f"'{key}' must be a code, not {value!r}", key, advice)
    if epsg_code(value) in _GEOGRAPHIC:
        raise OptionRefused(f"'{key}' is {value}, a system in degrees, which models cannot have", key, advice)
    if value.upper().startswith("EPSG:") and epsg_code(value) is None:
        raise OptionRefused(f"'{key}' must be a number of EPSG's, not {value!r}", key, advice)
    return value


def epsg_code(crs: str | None) -> int | None:
    """The number of a code of EPSG's; None of others."""
    if crs is None:
        return None
    authority, _, code = crs.partition(":")
    return int(code) if authority.upper() == "EPSG" and re.fullmatch(r"[1-9]\d{3,5}", code) else None


def projected_code(system: str) -> str | None:
    """What a project writes for a system that a file names by a code or as well-known text: "EPSG:25832".
    None where that has no number of EPSG's, is in degrees, or has its own heights."""
    code = _NAMED.search(system.strip())
    if code is None or is_in_degrees(system) or system.lstrip().upper().startswith("COMP"):
        return None
    return f"EPSG:{code[1]}"


def is_in_degrees(system: str) -> bool:
    """Whether a text, as files name their systems by a code or as well-known text, is of one in degrees."""
    if system.lstrip().upper().startswith(("GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "GEOGRAPHICCRS")):
        return True
    code = system.replace("::", ":").rpartition(":")[2]
    return code.upper().startswith("CRS84") or (code.isdecimal() and int(code) in _GEOGRAPHIC)
