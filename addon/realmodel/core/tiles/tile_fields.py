# SPDX-License-Identifier: GPL-3.0-or-later
"""The fields of a model in tiles: they are made once, as a whole, and kept in a file of its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import Outputs
from ..base.errors import InputRefused
from ..base.stored_objects import NamedArrays, StoredClasses
from ..cells.model_record import RECORD, RECORDED
from ..exporters.model_arrays import write_arrays
from ..readers.npz import read_npz
from ..results.layer_values import RockFields

FIELDS = "fields.npz"  # in the folder
_STORED = StoredClasses((*RECORDED, RockFields))


def write_rock_fields(rocks: list[RockFields], path: Path) -> None:
    """Raises OutputFailed."""
    arrays = NamedArrays({}, f"{RECORD}_")
    text = _STORED.write(rocks, arrays)
    with Outputs() as outputs, outputs.file(path) as file:
        write_arrays({RECORD: np.frombuffer(text, np.uint8), **arrays}, file)


def read_rock_fields(path: Path) -> list[RockFields]:
    """Raises InputRefused where the file is not what write_rock_fields wrote."""
    try:
        arrays = read_npz(path)
        rocks: Any = _STORED.read(arrays[RECORD].tobytes(), arrays)
        if not isinstance(rocks, list) or not all(isinstance(rock, RockFields) for rock in rocks):
            raise ValueError("it has no fields")
        return rocks
    except OSError as error:
        raise InputRefused(f"cannot be read: {error.strerror}", file=path) from error
    except (KeyError, ValueError) as error:
        raise InputRefused(f"it is damaged, build the model again: {error}", file=path) from error
