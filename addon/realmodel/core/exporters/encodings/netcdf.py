# SPDX-License-Identifier: GPL-3.0-or-later
"""NetCDF files in the classic format with 64-bit offsets (Unidata, "NetCDF Classic Format Specification")."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import BinaryIO

import numpy as np

_DIMENSION, _VARIABLE, _ATTRIBUTE = 10, 11, 12
_TYPES = {"S1": 2, "i4": 4, "f4": 5, "f8": 6}
_CHAR = 2


@dataclass
class NetcdfFile:
    """Dimensions, attributes and variables to be written. dimensions: sizes by name; 0: the record dimension,
    without records. attributes: text or numbers. variables: (dimensions, values, attributes) by name."""

    dimensions: dict[str, int] = field(default_factory=dict)
    attributes: dict[str, str | np.generic | np.ndarray] = field(default_factory=dict)
    variables: dict[str, tuple] = field(default_factory=dict)

    def add(
        self,
        name: str,
        dimensions: tuple[str, ...],
        values: np.ndarray,
        /,
        **attributes: str | float | np.ndarray,
    ) -> None:
        self.variables[name] = (dimensions, values, attributes)

    def write(self, file: BinaryIO) -> None:
        places = dict.fromkeys(self.variables, 0)
        at = len(self._header(places))
        for name, (_, values, _) in self.variables.items():
            places[name] = at
            at += values.nbytes + -values.nbytes % 4
        file.write(self._header(places))
        for _, values, _ in self.variables.values():
            file.write(values.astype(values.dtype.newbyteorder(">"), order="C"))
            file.write(b"\0" * (-values.nbytes % 4))

    def _header(self, places: dict[str, int]) -> bytes:
        index = {name: k for k, name in enumerate(self.dimensions)}
        head = b"CDF\2" + _int(0)
        head += _int(_DIMENSION, len(index))
        head += b"".join(_text(name) + _int(size) for name, size in self.dimensions.items())
        head += _attributes(self.attributes)
        head += _int(_VARIABLE, len(self.variables))
        for name, (dimensions, values, attributes) in self.variables.items():
            head += _text(name) + _int(len(dimensions), *(index[d] for d in dimensions))
            size = min(values.nbytes + -values.nbytes % 4, 2**31 - 1)  # readers go by the dimensions
            head += _attributes(attributes) + _int(_TYPES[values.dtype.str[1:]], size)
            head += np.array([places[name]], ">i8").tobytes()
        return head


def _int(*numbers: int) -> bytes:
    return np.array(numbers, ">i4").tobytes()


def _text(text: str) -> bytes:
    raw = text.encode()
    return _int(len(raw)) + raw + b"\0" * (-len(raw) % 4)


def _attributes(attributes: dict[str, str | np.generic | np.ndarray]) -> bytes:
    if not attributes:
        return _int(0, 0)
    body = _int(_ATTRIBUTE, len(attributes))
    for name, value in attributes.items():
        if isinstance(value, str):
            body += _text(name) + _int(_CHAR) + _text(value)
        else:
            array = np.atleast_1d(value)
            body += _text(name) + _int(_TYPES[array.dtype.str[1:]], len(array))
            body += array.astype(array.dtype.newbyteorder(">")).tobytes()
    return body


def characters(texts: list[str], width: int) -> np.ndarray:
    """(N, width) of single characters, as names are stored."""
    raw = np.array([text.encode("ascii", "replace")[: width - 1] for text in texts], f"S{width}")
    return raw.view("S1").reshape(len(texts), width)
