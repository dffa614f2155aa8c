# SPDX-License-Identifier: GPL-3.0-or-later
"""XML files from anywhere: read without entities of their own, which could grow beyond all memory."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ..errors import InputRefused


def parse_xml(file: Path, raw: bytes) -> ElementTree.Element:
    """The root. Raises InputRefused naming the line."""
    if b"<!ENTITY" in raw or b"<!DOCTYPE" in raw:
        raise InputRefused("XML with a document type is not read", file=file, advice="export it again")
    try:
        return ElementTree.fromstring(raw)
    except ElementTree.ParseError as error:
        line = error.position[0]
        raise InputRefused(f"damaged XML: {error}", file=file, line=line) from error
    except (ValueError, LookupError) as error:  # an encoding that is not there
        raise InputRefused(f"damaged XML: {error}", file=file) from error


def local_name(element: ElementTree.Element) -> str:
    """Without the namespace."""
    return element.tag.rpartition("}")[2]
