# SPDX-License-Identifier: GPL-3.0-or-later
"""XML files from anywhere: read without entities of their own, which could grow beyond all memory."""

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
    """error: of the parser, or of an encoding that is not there."""
    line = error.position[0] if isinstance(error, ElementTree.ParseError) else None
    return InputRefused(f"damaged XML: {error}", file=file, line=line)


class Told(Protocol):
    """Who is told of a file as it is read; names are without namespaces."""

    def begin(self, name: str, attributes: dict[str, str]) -> None: ...
    def text(self, text: str) -> None: ...
    def end(self, name: str) -> None: ...


def feed_xml(file: Path, told: Told, step: Step) -> None:
    """Reads a file piece by piece. Raises InputRefused naming the line."""
    content = content_of(file)
    parser = ElementTree.XMLParser(target=_Target(file, told))
    try:
        for at in range(0, len(content), BYTES_AT_ONCE):
            parser.feed(content[at : at + BYTES_AT_ONCE])
            step(at / len(content))
        parser.close()
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise _damaged(file, error) from error


class _Target:
    """What the parser calls."""

    def __init__(self, file: Path, told: Told):
        self._file, self._told, self.data = file, told, told.text

    def doctype(self, *_) -> None:
        raise InputRefused(_WITH_ENTITIES, file=self._file, advice="export it again")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._told.begin(tag.rpartition("}")[2], attributes)

    def end(self, tag: str) -> None:
        self._told.end(tag.rpartition("}")[2])

    def close(self) -> None:
        pass
