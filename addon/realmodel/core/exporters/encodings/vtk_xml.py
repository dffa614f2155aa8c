# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's unstructured grids in XML with binary arrays behind ("VTK File Formats", type UnstructuredGrid)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO, NamedTuple

import numpy as np

_TYPES = {"f8": "Float64", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}
END = b"\n</AppendedData>\n</VTKFile>\n"


class ArrayTag(NamedTuple):
    """An array of the file. element: Points, Cells, PointData or CellData. kind: like "i4". size: bytes,
    0 where it is the last array and its length is not known yet."""

    element: str
    name: str
    kind: str
    size: int
    components: int = 1


def write_grid(file: BinaryIO, arrays: Sequence[tuple[str, str, np.ndarray]]) -> None:
    """Writes a whole file. arrays: (element, name, values), of little-endian float64, int64, int32 or uint8;
    "Points" (P, 3) and "offsets" (C,) are among them."""
    values = {name: np.ascontiguousarray(array) for _, name, array in arrays}
    tags = [
        ArrayTag(element, name, array.dtype.str[1:], array.nbytes, *array.shape[1:])
        for element, name, array in arrays
    ]
    write_header(file, len(values["Points"]), len(values["offsets"]), tags)
    for array in values.values():
        write_array(file, array)
    file.write(END)


def write_image(
    file: BinaryIO,
    origin: np.ndarray,
    size: np.ndarray,
    counts: tuple[int, int, int],
    arrays: Sequence[tuple[str, np.ndarray]],
) -> None:
    """Writes a whole file of type ImageData. origin, size, counts: as of RegularCells. arrays: of the cells,
    by name, x fastest, of little-endian int32 or float64; programs color by the first."""
    extent = " ".join(f"0 {count}" for count in counts)
    corner, spacing = (" ".join(map(repr, vector.tolist())) for vector in (origin, size))
    tags, at = [], 0
    for name, values in arrays:
        kind = _TYPES[values.dtype.str[1:]]
        tags.append(f'<DataArray type="{kind}" Name="{_quoted(name)}" format="appended" offset="{at}"/>')
        at += 8 + values.nbytes
    file.write(
        f"""<?xml version="1.0" encoding="UTF-8"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{corner}" Spacing="{spacing}">
<Piece Extent="{extent}">
<CellData Scalars="{_quoted(arrays[0][0])}">
""".encode()
    )
    file.write(("\n".join(tags) + "\n</CellData>\n</Piece>\n</ImageData>\n").encode())
    file.write(b'<AppendedData encoding="raw">\n_')
    for _, values in arrays:
        write_array(file, np.ascontiguousarray(values))
    file.write(END)


def _quoted(text: str) -> str:
    """A text as the value of an attribute."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def write_header(file: BinaryIO, points: int, cells: int, arrays: Sequence[ArrayTag]) -> None:
    """Writes all that stands before the arrays, which follow in this order. The first array of points or
    cells is what programs color by."""
    lines: dict[str, list[str]] = {}
    at = 0
    for element, name, kind, size, components in arrays:
        width = f' NumberOfComponents="{components}"' if components > 1 else ""
        active = f' Scalars="{_quoted(name)}"' if element.endswith("Data") else ""
        named = f'type="{_TYPES[kind]}" Name="{_quoted(name)}"{width}'
        lines.setdefault(element, [f"<{element}{active}>"]).append(
            f'<DataArray {named} format="appended" offset="{at}"/>'
        )
        at += 8 + size
    body = "\n".join("\n".join([*tags, f"</{element}>"]) for element, tags in lines.items())
    file.write(
        f"""<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid>
<Piece NumberOfPoints="{points}" NumberOfCells="{cells}">
{body}
</Piece>
</UnstructuredGrid>
<AppendedData encoding="raw">
_""".encode()
    )


def write_pieces(file: BinaryIO, pieces: Sequence[str]) -> None:
    """Writes an index (.pvtu) of grids that write_vtu wrote, by their paths beside it."""
    arrays = "".join(
        f'<PDataArray type="Int32" Name="{name}"/>' for name in ("block", "property", "compartment")
    )
    sources = "\n".join(f'<Piece Source="{piece}"/>' for piece in pieces)
    file.write(
        f"""<?xml version="1.0"?>
<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PUnstructuredGrid GhostLevel="0">
<PPoints><PDataArray type="Float64" Name="Points" NumberOfComponents="3"/></PPoints>
<PCellData Scalars="block">{arrays}</PCellData>
{sources}
</PUnstructuredGrid>
</VTKFile>
""".encode("ascii")
    )


def write_length(file: BinaryIO, size: int) -> None:
    """Writes the header of an array of this number of bytes."""
    file.write(np.array([size], "<u8").tobytes())


def write_array(file: BinaryIO, array: np.ndarray) -> None:
    """Writes a contiguous array behind its length."""
    write_length(file, array.nbytes)
    file.write(array)
