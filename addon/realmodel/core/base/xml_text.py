# SPDX-License-Identifier: GPL-3.0-or-later
"""XML files. Those with entities are refused: expanded, they could exceed all memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Protocol
from xml.etree import ElementTree

from .errors import InputRefused
from .text import BYTES_AT_ONCE, FileBytes, Step, content_of


def parse_xml(file: Path, pieces: Iterable[bytes], target):
    """Parses text that comes in pieces; what the target of the parser returns in the end. Raises InputRefused
    naming the line."""
    parser = ElementTree.XMLParser(target=target)
    try:
        for piece in pieces:
            parser.feed(piece)
        return parser.close()
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise _damaged(file, error) from error


def no_document_type(file: Path) -> InputRefused:
    """The error of a document type, which entities are defined in."""
    return InputRefused("XML with a document type is not read", file=file, advice="export it again")


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
    parse_xml(file, _pieces(content_of(file), step), _Target(file, handler))


def _pieces(content: FileBytes, step: Step) -> Iterator[bytes]:
    for at in range(0, len(content), BYTES_AT_ONCE):
        yield content[at : at + BYTES_AT_ONCE]
        step(at / len(content))


class _Target:
    """The target of the parser: hands on its calls, without namespaces."""

    def __init__(self, file: Path, handler: ElementHandler):
        self._file, self._handler, self.data = file, handler, handler.text

    def doctype(self, *_) -> None:
        raise no_document_type(self._file)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._handler.begin(tag.rpartition("}")[2], attributes)

    def end(self, tag: str) -> None:
        self._handler.end(tag.rpartition("}")[2])

    def close(self) -> None:
        pass
