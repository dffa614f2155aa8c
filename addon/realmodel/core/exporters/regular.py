# SPDX-License-Identifier: GPL-3.0-or-later
"""A model on a regular grid: block models as table (.csv) and VTK image (.vti), heights and thicknesses as
GeoTIFF and ESRI ASCII grids."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO
from xml.sax.saxutils import escape

import numpy as np

from ..base.atomic import Outputs
from ..base.packages import vendored
from ..base.text import Step
from ..cells.model_data import ModelData
from ..results.samples import CellSize, plan_grids, regular_cells
from ..settings.crs import epsg_code
from ..simulation.patches import solver_names
from .encodings.text_rows import write_rows
from .encodings.vtk_xml import write_image
from .shapes.shape_parts import distinct_names

_NO_HEIGHT = -9999.0
_LARGEST_CODE = 32766  # of systems in GeoTIFF


def write_block_table(model: ModelData, file: BinaryIO, step: Step, cell_size: CellSize = None) -> None:
    """A row for each cell that has rock: its center, its size, the name of the block with the largest share,
    and the share of each block in it."""
    cells = regular_cells(model, cell_size, lambda share: step(0.5 * share))
    shares = cells.shares
    names = distinct_names(block.name for block in model.blocks)
    z, y, x = np.nonzero(shares.sum(axis=0) > 0)
    rock_shares = shares[:, z, y, x]
    center = cells.origin + cells.size * (np.column_stack([x, y, z]) + 0.5)
    columns = ["x", "y", "z", "dx", "dy", "dz", "block", *(f"share {name}" for name in names)]
    quoted = [_quoted(name) for name in names]
    largest = np.array(quoted, object)[rock_shares.argmax(axis=0)] if len(names) else np.empty(0, object)
    file.write((",".join(map(_quoted, columns)) + "\n").encode())
    form = "%r,%r,%r,%r,%r,%r,%s" + ",%.9g" * len(names)
    rows = center, np.tile(cells.size, (len(center), 1)), largest, rock_shares.T
    write_rows(file, form, *rows, step=lambda share: step(0.5 + 0.5 * share))
    step(1.0)


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n') else text


def write_vti(model: ModelData, file: BinaryIO, step: Step, cell_size: CellSize = None) -> None:
    """A VTK image with the cell arrays `block` (number in the model's list of the block with the largest
    share,
    -1: none) and `share NAME` of each block."""
    cells = regular_cells(model, cell_size, lambda share: step(0.5 * share))
    names = distinct_names(block.name for block in model.blocks)
    shares = cells.shares
    block = (
        np.where(shares.sum(axis=0) > 0, shares.argmax(axis=0), -1) if len(names) else np.zeros(cells.counts)
    )
    arrays = [
        ("block", block.astype("<i4")),
        *((f"share {n}", s) for n, s in zip(names, shares, strict=True)),
    ]
    write_image(file, cells.origin, cells.size, cells.counts, arrays)
    step(1.0)


def _grids(model: ModelData, cell_size: CellSize) -> tuple:
    """The grids, and (name, heights (ny, nx)) of each: the ground, then of each block its top and thickness,
    then of each its true thickness, and of each interpolated
    surface the standard deviation of its heights, where that is known."""
    grids = plan_grids(model, cell_size)
    bands = [("elevation", grids.top)]
    names = distinct_names(block.name for block in model.blocks)
    for number, name in enumerate(names):
        bands.append((f"top of {name}", grids.upper[number]))
        bands.append((f"thickness of {name}", grids.thickness[number]))
    bands += [(f"true thickness of {name}", grids.true_thickness[n]) for n, name in enumerate(names)]
    surfaces = distinct_names(name for name, _ in grids.deviation)
    for name, (_, values) in zip(surfaces, grids.deviation, strict=True):
        bands.append((f"standard deviation of {name}", values))
    return grids, bands


def write_ascii_grids(
    model: ModelData, path: Path, outputs: Outputs, step: Step, cell_size: CellSize = None
) -> None:
    """ESRI ASCII grids: the elevation in the file itself; beside it NAME_top_of_BLOCK,
    NAME_thickness_of_BLOCK, NAME_true_thickness_of_BLOCK and NAME_standard_deviation_of_SURFACE."""
    grids, bands = _grids(model, cell_size)
    step(0.5)
    (west, north), (dx, dy) = grids.north_west, grids.size
    rows, columns = grids.top.shape
    head = f"ncols {columns}\nnrows {rows}\nxllcorner {west!r}\nyllcorner {north - rows * dy!r}\n"
    head += f"cellsize {dx!r}\n" if dx == dy else f"dx {dx!r}\ndy {dy!r}\n"
    words = solver_names([name for name, _ in bands])
    for number, ((_, values), word) in enumerate(zip(bands, words, strict=True)):
        target = path if number == 0 else path.with_name(f"{path.stem}_{word}{path.suffix}")
        with outputs.file(target) as file:
            file.write(f"{head}NODATA_value {_NO_HEIGHT:g}\n".encode())
            write_rows(file, " ".join(["%r"] * columns), np.where(np.isfinite(values), values, _NO_HEIGHT))
    step(1.0)


def write_geotiff(model: ModelData, file: BinaryIO, step: Step, cell_size: CellSize = None) -> None:
    """A GeoTIFF (OGC 19-008) with a band for each grid, 64-bit numbers, uncompressed, named by GDAL's
    metadata. It names the project's coordinate system, where that is one of EPSG's."""
    tifffile = vendored("tifffile", "tifffile", "writing GeoTIFF")
    grids, bands = _grids(model, cell_size)
    step(0.5)
    rows, columns = grids.top.shape
    (west, north), (dx, dy) = grids.north_west, grids.size
    items = "".join(
        f'<Item name="DESCRIPTION" sample="{k}" role="description">{escape(name)}</Item>'
        for k, (name, _) in enumerate(bands)
    )
    metadata = f"<GDALMetadata>{items}</GDALMetadata>".encode()
    keys = [(1025, 0, 1, 1)]  # heights are of areas
    if (code := epsg_code(model.project.crs)) is not None and code <= _LARGEST_CODE:
        keys = [(1024, 0, 1, 1), *keys, (3072, 0, 1, code)]  # a projected system
    keys = [(1, 1, 0, len(keys)), *keys]
    tags = [  # code, type, count, values
        (33550, "d", 3, (dx, dy, 0.0)),
        (33922, "d", 6, (0.0, 0.0, 0.0, west, north, 0.0)),
        (34735, "H", 4 * len(keys), tuple(number for key in keys for number in key)),
        (42112, "s", len(metadata) + 1, metadata),
        (42113, "s", 4, b"nan"),
    ]
    tifffile.imwrite(
        file,
        (np.ascontiguousarray(values, "<f8") for _, values in bands),
        shape=(len(bands), rows, columns),
        dtype="<f8",
        bigtiff=True,
        byteorder="<",
        photometric="minisblack",
        planarconfig="separate" if len(bands) > 1 else None,
        rowsperstrip=rows,
        extratags=[(*tag, True) for tag in tags],
        metadata=None,
        software=False,
    )
    step(1.0)
