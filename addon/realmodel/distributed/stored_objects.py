# SPDX-License-Identifier: GPL-3.0-or-later
"""The window of a tile in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..core import BuildFailed
from ..core.base.mapped_arrays import read_mapped, write_mapped
from ..core.base.stored_objects import NamedArrays, StoredClasses
from ..core.cells.model_record import RECORDED
from ..core.cells.reach import Reach
from ..core.tiles.faulted_windows import Window

_STORED = StoredClasses((*RECORDED, Window, Reach))
_OBJECTS = "objects"  # the table of objects; arrays have numbers for names


def write_object(value: object, file: BinaryIO) -> None:
    """Writes what StoredClasses.write does."""
    arrays = NamedArrays({})
    text = _STORED.write(value, arrays)
    write_mapped({_OBJECTS: np.frombuffer(text, np.uint8), **arrays}, file)


def read_object(path: Path) -> Any:
    """The value of a file of write_object; changes of its arrays stay in memory. Raises BuildFailed."""
    arrays = read_mapped(path)
    try:
        return _STORED.read(arrays[_OBJECTS].tobytes(), arrays)
    except (KeyError, ValueError) as error:
        raise BuildFailed(f"{path}: cannot be read; delete it and start again") from error
