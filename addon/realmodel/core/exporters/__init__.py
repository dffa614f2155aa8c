# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a model is written to, by their ending."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from ..atomic import Outputs
from ..errors import UsageError
from .npz import write_npz
from .vtu import write_vtu

Step = Callable[[float], None]

WRITERS: dict[str, Callable] = {".npz": write_npz, ".vtu": write_vtu}


def writer_for(path: str | Path) -> Callable[..., None]:
    """The function (model, file, step) that writes files of this ending. Raises UsageError."""
    ending = Path(path).suffix.lower()
    if ending not in WRITERS:
        known = " or ".join(WRITERS)
        what = f"files ending in '{ending}' are not supported" if ending else "the file name has no extension"
        raise UsageError(f"{path}: {what}; use {known}")
    return WRITERS[ending]


def no_step(_share: float) -> None:
    """For callers that want no progress."""


def write_model(model, path: str | Path, file: BinaryIO, step: Step = no_step) -> None:
    """Writes a model to an open binary file, in the format of the path's ending."""
    writer_for(path)(model, file, step)


def save_model(model, path: str | Path, step: Step = no_step) -> None:
    """Writes a model to a file that appears whole or not at all."""
    writer_for(path)
    with Outputs() as outputs, outputs.file(path) as file:
        write_model(model, path, file, step)


__all__ = ["WRITERS", "save_model", "write_model", "write_npz", "write_vtu", "writer_for"]
