# SPDX-License-Identifier: GPL-3.0-or-later
"""XML files. Those with entities are refused: expanded, they could exceed all memory."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from .errors import InputRefused
from .text import BYTES_AT_ONCE, Step


class _Tree(ElementTree.TreeBuilder):
    """Builds the elements of a file. Entities are defined in its document type, which is refused."""

    def __init__(self, file: Path):
        super().__init__()
        self._file = file

    def doctype(self, *_: object) -> None:
        raise InputRefused("XML with a document type is not read", file=self._file, advice="export it again")


def parse_xml(file: Path, raw: bytes, step: Step) -> ElementTree.Element:
    """The root of a file with this content. Raises InputRefused naming the line."""
    parser = ElementTree.XMLParser(target=_Tree(file))
    try:
        for at in range(0, len(raw), BYTES_AT_ONCE):
            parser.feed(raw[at : at + BYTES_AT_ONCE])
            step(0.5 * at / len(raw))
        return parser.close()
    except InputRefused:
        raise
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # the last of an unknown encoding
        line = error.position[0] if isinstance(error, ElementTree.ParseError) else None
        raise InputRefused(f"damaged XML: {error}", file=file, line=line) from error


def local_name(element: ElementTree.Element) -> str:
    """The name of an element without its namespace."""
    return element.tag.rpartition("}")[2]
