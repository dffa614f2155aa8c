# SPDX-License-Identifier: GPL-3.0-or-later
"""Corner-point grids as GRDECL text, the keywords of the section GRID of Eclipse decks, which OPM Flow and
others read (Open Porous Media, OPM Flow Reference Manual)."""

from __future__ import annotations

import math
from typing import BinaryIO

import numpy as np

from ...base.algebra import begins_run
from ...base.errors import number_list
from ...base.text import Step
from ...base.units import METERS, MODEL_UNIT
from ...results.corner_point import CornerPointGrid
from ..encodings.text_rows import write_wrapped

_A_LINE = 8
_DIGITS = 7  # of depths, of their range
_FEET = {"ft": "feet", "us-ft": "US survey feet"}


def write_grdecl(grid: CornerPointGrid, file: BinaryIO, step: Step, unit: str = MODEL_UNIT) -> None:
    """Writes SPECGRID, COORD, ZCORN, ACTNUM, FIPNUM, and PINCH, by which what lies above and below a layer
    that ends is connected; PORO, PERMX, PERMY and PERMZ where the library has them, 0 where it has none of a
    block. Coordinates are those of the map. unit: of the model; feet stay feet (FIELD), others become meters
    (METRIC)."""
    word, system = ("FEET", "FIELD") if unit in _FEET else ("METRES", "METRIC")
    to_file = 1.0 if unit in _FEET else float(METERS[unit])
    nx, ny, nz = grid.shape
    lines = [
        "-- Corner-point grid of RealModel: depths count down, layers from the top.",
        f"-- DIMENS {nx} {ny} {nz}; units {system}, lengths in {_FEET.get(unit, 'meters')}",
    ]
    rows = zip(grid.names, grid.volumes.tolist(), grid.exact_volumes.tolist(), strict=True)
    for number, (name, volume, exact) in enumerate(rows, 1):
        lines.append(f"-- FIPNUM {number} = {' '.join(name.split())}")
        volumes = f"{volume * to_file**3:.6g}, in the model {exact * to_file**3:.6g}"
        lines.append(f"--   volume {volumes}: {100 * float(grid.difference[number - 1]):+.3g} %")
        layers = (np.flatnonzero(grid.fipnum[:, 0, 0] == number) + 1).tolist()
        lines.append(f"--   layers {number_list(layers, len(layers))}")
    lines += [f"-- {warning.text}" for warning in grid.warnings if "volume" not in warning.kind]
    # identity: the coordinates are those of the map
    lines += [f"MAPUNITS\n  {word} /\nMAPAXES\n  0 1 0 0 1 0 /\nGRIDUNIT\n  {word} /"]
    lines += [f"SPECGRID\n  {nx} {ny} {nz} 1 F /\nPINCH\n/\nCOORD\n"]
    file.write("\n".join(lines).encode())
    write_wrapped(file, " %r", (grid.coord * to_file).ravel(), 6)
    step(0.1)
    depths = grid.zcorn.ravel() * to_file
    places = min(max(_DIGITS - math.ceil(math.log10(max(float(np.ptp(depths)), 1e-300))), 0), 300)
    file.write(b"/\nZCORN\n")
    write_wrapped(file, f" %.{places}f", depths, _A_LINE)
    arrays = [("ACTNUM", grid.actnum), ("FIPNUM", grid.fipnum)]
    known = [("PORO", grid.porosity), *((f"PERM{axis}", grid.permeability) for axis in "XYZ")]
    for keyword, of_blocks in known:
        if np.isfinite(of_blocks).any():
            arrays.append((keyword, np.append(0.0, np.nan_to_num(of_blocks))[grid.fipnum]))
    for keyword, values in arrays:
        step(0.9)
        file.write(f"/\n{keyword}\n".encode())
        _write_runs(file, values.ravel())
    file.write(b"/\n")
    step(1.0)


def _write_runs(file: BinaryIO, values: np.ndarray) -> None:
    """Numbers, equal ones together as 3*7."""
    begins = np.flatnonzero(begins_run(values))
    counts = np.diff(np.append(begins, len(values))).tolist()
    words = [f"{count}*{value}" for count, value in zip(counts, values[begins].tolist(), strict=True)]
    for begin in range(0, len(words), _A_LINE):
        file.write(f" {' '.join(words[begin : begin + _A_LINE])}\n".encode())
