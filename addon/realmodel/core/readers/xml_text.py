# SPDX-License-Identifier: GPL-3.0-or-later
"""XML files. Those with entities are refused: expanded, they could exceed all memory."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol
from xml.etree import ElementTree

from ..errors import InputRefused
from .text import BYTES_AT_ONCE, Step, content_of

_WITH_ENTITIES = "XML with a document type is not read"


def parse_xml(file: Path, raw: bytes) -> ElementTree.Element:
    """The root. Raises InputRefused naming the line."""
    if b"<!ENTITY" in raw or b"<!DOCTYPE" in raw:
        raise InputRefused(_WITH_ENTITIES, file=file, advice="export it again")
    try:
        return ElementTree.fromstring(raw)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise _damaged(file, error) from error


def _damaged(file: Path, error: Exception) -> InputRefused:
    """The error of damaged XML. error: of the parser, or of an unknown encoding."""
    line = error.position[0] if isinstance(error, ElementTree.ParseError) else None
    return InputRefused(f"damaged XML: {error}", file=file, line=line)


class ElementHandler(Protocol):
    """The functions that feed_xml calls for elements and text, in the order of the file. Names come without
    namespaces."""

    def begin(self, name: str, attributes: dict[str, str]) -> None: ...
    def text(self, text: str) -> None: ...
    def end(self, name: str) -> None: ...


def feed_xml(file: Path, handler: ElementHandler, step: Step) -> None:
    """Parses a file piece by piece and calls the handler. Raises InputRefused naming the line."""
    content = content_of(file)
    parser = ElementTree.XMLParser(target=_Target(file, handler))
    try:
        for at in range(0, len(content), BYTES_AT_ONCE):
            parser.feed(content[at : at + BYTES_AT_ONCE])
            step(at / len(content))
        parser.close()
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise _damaged(file, error) from error


class _Target:
    """The target of the parser: hands on its calls, without namespaces."""

    def __init__(self, file: Path, handler: ElementHandler):
        self._file, self._handler, self.data = file, handler, handler.text

    def doctype(self, *_) -> None:
        raise InputRefused(_WITH_ENTITIES, file=self._file, advice="export it again")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._handler.begin(tag.rpartition("}")[2], attributes)

    def end(self, tag: str) -> None:
        self._handler.end(tag.rpartition("}")[2])

    def close(self) -> None:
        pass
