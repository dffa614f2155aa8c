# SPDX-License-Identifier: GPL-3.0-or-later
"""Text files with lines of numbers, read in pieces so that a caller can show progress and cancel; XML
files."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import DTypeLike

from .errors import InputRefused

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
LINES_AT_ONCE = 20_000
BYTES_AT_ONCE = 1 << 19  # between two steps: a few milliseconds

BOM = codecs.BOM_UTF8
_END_OF_FILE = re.compile(rb"\x1a[\s\0]*\Z")
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
# Letters of code page 850 (ü, ä, ö, é and others) that cp1252 does not have, or has as signs.
_OF_DOS = re.compile(rb"[\x81\x8d\x8f\x90\x9d]|[A-Za-z][\x82\x84\x85\x87-\x8a\x93\x94][a-z\x81-\xa5\xe1]")

Step = Callable[[float], None]


def no_step(_fraction: float) -> None:
    """For callers without progress."""


class FileBytes:
    """The bytes of a file for readers, or some in a row: read on demand, not cached. Raises InputRefused."""

    def __init__(self, file: Path, first: int = 0, stop: int | None = None):
        self._file, self._first = file, first
        self._block, self._begin = b"", 0  # the block read last, and its position
        with reading(file):
            self._size = (file.stat().st_size if stop is None else stop) - first

    def some(self, first: int, stop: int) -> FileBytes:
        """Those from one position to another."""
        return FileBytes(self._file, self._first + first, self._first + stop)

    def __len__(self) -> int:
        return self._size

    def __getitem__(self, part: slice) -> bytes:
        begin, end, _ = part.indices(self._size)
        if end <= begin:
            return b""
        if begin < self._begin or end > self._begin + len(self._block):
            if end - begin > BYTES_AT_ONCE:
                return self._read(begin, end)
            self._block = self._read(begin, min(begin + BYTES_AT_ONCE, self._size))
            self._begin = begin
        return self._block[begin - self._begin : end - self._begin]

    def _read(self, begin: int, end: int) -> bytes:
        content = bytearray()
        with reading(self._file), self._file.open("rb", buffering=0) as opened:
            opened.seek(self._first + begin)
            while len(content) < end - begin and (more := opened.read(end - begin - len(content))):
                content += more
        if len(content) < end - begin:
            raise InputRefused("the file was truncated while being read", file=self._file)
        return bytes(content)

    def find(self, text: bytes, begin: int = 0, end: int | None = None) -> int:
        """The next position of a short text; -1 where there is none."""
        end = self._size if end is None else min(end, self._size)
        size = _BYTES_TO_FIND
        while begin < end:
            position = self[begin : min(begin + size + len(text) - 1, end)].find(text)
            if position >= 0:
                return begin + position
            begin, size = begin + size, BYTES_AT_ONCE
        return -1

    def count(self, text: bytes, begin: int, end: int) -> int:
        """The number of times that a text of one byte occurs between two positions."""
        places = range(begin, end, BYTES_AT_ONCE)
        return sum(self[at : min(at + BYTES_AT_ONCE, end)].count(text) for at in places)


Content = bytes | FileBytes
_BYTES_TO_FIND = 1 << 12  # mostly the end of a line


@contextmanager
def reading(file: Path) -> Iterator[None]:
    """Raises InputRefused instead of OSError."""
    try:
        yield
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=file, advice="check the path") from error


def content_of(file: Path) -> Content:
    """The content of a file, in pieces; text in UTF-16 as UTF-8, as a whole. Raises InputRefused."""
    content = FileBytes(Path(file))
    return read_bytes(file) if _utf_16(content[:64]) else content


def text_content(file: Path) -> Content:
    """content_of a text file, with lines that end in \\n. Raises InputRefused."""
    content = content_of(file)
    require_text(file, content[:4096])
    return with_newlines(_between_marks(content))


def _between_marks(content: Content) -> Content:
    """Text without the mark of UTF-8 before it, and without the sign with which files of DOS end."""
    first = len(BOM) if content[: len(BOM)] == BOM else 0
    sign = _END_OF_FILE.search(content[-64:])
    stop = len(content) - (0 if sign is None else len(sign[0]))
    if first == 0 and stop == len(content):
        return content
    return content[first:stop] if isinstance(content, bytes) else content.some(first, stop)


def with_newlines(content: Content) -> Content:
    """Text with lines that end in \\n. Where all end in \\r, as old Macs have it, it is read as a whole."""
    if content.find(b"\n") >= 0 or content.find(b"\r") < 0:
        return content
    return content[:].replace(b"\r", b"\n")


def pieces_of(content: Content, begin: int = 0, stop: int | None = None) -> Iterator[tuple[int, bytes]]:
    """Whole lines in pieces, to a position or the end: the position of each piece, and its bytes."""
    stop = len(content) if stop is None else stop
    while begin < stop:
        end = content.find(b"\n", min(begin + BYTES_AT_ONCE, stop) - 1, stop)
        end = stop if end < 0 else end + 1
        yield begin, content[begin:end]
        begin = end


def text_lines(file: Path) -> Iterator[tuple[int, list[str], float]]:
    """Lines of text as read_text has them, few at once: the number of the first, from 1, these, and which
    share of the file is done then. Raises InputRefused."""
    content = content_of(file)
    require_text(file, content[:4096])
    content = _between_marks(content)
    encoding, number = encoding_of(content), 1
    decoder = io.IncrementalNewlineDecoder(codecs.getincrementaldecoder(encoding)(), translate=True)
    rest: list[str] = []  # of a line that continues
    for at in range(0, len(content), BYTES_AT_ONCE):
        end = min(at + BYTES_AT_ONCE, len(content))
        whole, newline, more = decoder.decode(content[at:end], final=end == len(content)).rpartition("\n")
        rest.append(whole if newline else more)
        if newline:
            lines, rest = "".join(rest).split("\n"), [more]
            yield number, lines, end / len(content)
            number += len(lines)
    if rest:
        yield number, ["".join(rest)], 1.0


def _with_plain_ends(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def encoding_of(content: Content) -> str:
    """utf-8, or where the bytes are not valid UTF-8 the code page of Windows, or that of DOS where the bytes
    stand in words as its letters and are none in the other."""
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        for at in range(0, len(content), BYTES_AT_ONCE):
            piece = content[at : at + BYTES_AT_ONCE]
            if not piece.isascii() or decoder.getstate()[0]:
                decoder.decode(piece)
        decoder.decode(b"", final=True)
    except UnicodeDecodeError:
        pieces = (content[at : at + BYTES_AT_ONCE] for at in range(0, len(content), BYTES_AT_ONCE))
        return "cp850" if any(map(_OF_DOS.search, pieces)) else "cp1252"
    return "utf-8"


def read_bytes(file: Path) -> bytes:
    """The content of a file; text in UTF-16, as spreadsheets write it, as UTF-8; without a mark of these.
    Raises InputRefused."""
    with reading(file):
        raw = Path(file).read_bytes()
    if encoding := _utf_16(raw[:64]):
        try:
            return raw.decode(encoding).encode()
        except UnicodeDecodeError as error:
            raise InputRefused("damaged UTF-16 text", file=file, advice="save it as UTF-8") from error
    return raw.removeprefix(BOM)


def _utf_16(head: bytes) -> str | None:
    """The encoding of text in UTF-16, which begins with its mark, or has NUL in every second byte; None of
    other content."""
    if head[:2] in _UTF_16:
        return "utf-16"
    for encoding, high, low in (("utf-16-le", head[1::2], head[::2]), ("utf-16-be", head[::2], head[1::2])):
        if len(high) > 7 and not any(high) and min(low) >= ord("\t"):
            return encoding
    return None


def as_utf8(head: bytes) -> bytes:
    """The beginning of a file, as UTF-8 where it is text in UTF-16, without a mark of these."""
    encoding = _utf_16(head[:64])
    if encoding is not None:
        head = head[: len(head) // 2 * 2].decode(encoding, "ignore").encode()
    return head.removeprefix(BOM)


def line_of_word(content: Content, number: int, begin: int = 0, stop: int | None = None) -> int:
    """The line, from 1, of a word of the text between two positions, from 0; that of the last one where there
    are fewer."""
    last = line = content.count(b"\n", 0, begin) + 1
    for _, piece in pieces_of(content, begin, stop):
        words = len(piece.split())
        if number < words:
            counts = np.cumsum([len(text.split()) for text in piece.split(b"\n")])
            return line + int(np.searchsorted(counts, number, "right"))
        number -= words
        if words:
            last = line + piece.rstrip().count(b"\n")
        line += piece.count(b"\n")
    return last


def require_text(file: Path, raw: bytes) -> None:
    """Refuses binary content."""
    if b"\0" in raw[:4096]:
        advice = "convert a raster to GeoTIFF, shapes to GeoPackage, a table to CSV"
        raise InputRefused("this is a binary file, not text", file=file, advice=advice)


def read_text(file: Path) -> str:
    """The text of a file. Numbers are ASCII, so that names in any 8-bit encoding do no harm."""
    raw = read_bytes(file)
    require_text(file, raw)
    text = _between_marks(raw)[:]
    return _with_plain_ends(text.decode(encoding_of(text)))


def column_numbers(
    lines: list[str], columns: tuple[int, ...], delimiter: str | None, dtype: DTypeLike, step: Step = no_step
) -> np.ndarray:
    """(N, len(columns)) numbers of the given lines; blank lines and what follows '#' are left out.

    Raises ValueError where NumPy cannot read a line: the caller then looks for it with more patience.
    """
    pieces = []
    for start in range(0, len(lines), LINES_AT_ONCE):
        piece = [line for line in lines[start : start + LINES_AT_ONCE] if line and not line.isspace()]
        if piece and not all(line.lstrip().startswith("#") for line in piece):
            pieces.append(
                np.loadtxt(
                    piece,
                    dtype=dtype,
                    comments="#",
                    delimiter=delimiter,
                    usecols=columns,
                    ndmin=2,
                    quotechar='"',
                )
            )
        step(min(1.0, (start + LINES_AT_ONCE) / len(lines)))
    return np.concatenate(pieces) if pieces else np.empty((0, len(columns)), dtype)


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
