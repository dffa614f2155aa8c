# SPDX-License-Identifier: GPL-3.0-or-later
"""The arrays of NumPy's .npz files, read at the speed of the disk: each once, into its own memory.

They are not mapped, though .npz of models are not compressed: so a file may be replaced while its model is in
use, also on Windows, and the checksums of the zip show any damage.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import IO

import numpy as np

from ..base.errors import RealModelError

_PIECE = 1 << 24  # bytes read at once
_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}


def read_npz(path: Path, step: Callable[[float], None] = lambda _: None) -> dict[str, np.ndarray]:
    """All arrays of an .npz by name. step(share) is called after each. Raises OSError where the file cannot
    be opened, ValueError where it is no such file or damaged."""
    with path.open("rb") as file:
        try:
            with zipfile.ZipFile(file) as archive:
                entries = archive.infolist()
                total, done, arrays = sum(entry.file_size for entry in entries) or 1, 0, {}
                for entry in entries:
                    with archive.open(entry) as member:
                        arrays[entry.filename.removesuffix(".npy")] = _array(member, entry.file_size)
                    done += entry.file_size
                    step(done / total)
                return arrays
        except RealModelError:  # canceled
            raise
        except Exception as error:  # whatever zipfile and NumPy make of a damaged file
            raise ValueError(str(error) or type(error).__name__) from error


def _array(member: IO[bytes], size: int) -> np.ndarray:
    """The array of a member of `size` bytes."""
    shape, is_fortran, dtype = _HEADERS[np.lib.format.read_magic(member)](member)
    count = math.prod(shape)
    if dtype.hasobject or min(shape, default=0) < 0 or count * dtype.itemsize != size - member.tell():
        raise ValueError("the size of an array differs from its header")
    array = np.empty(count, dtype)
    content = memoryview(array.view(np.uint8)) if array.nbytes else memoryview(b"")
    for at in range(0, len(content), _PIECE):
        piece = content[at : at + _PIECE]
        while len(piece):
            read = member.readinto(piece)  # type: ignore[attr-defined]  # zipfile's are buffered
            if not read:
                raise ValueError("the file ends within an array")
            piece = piece[read:]
    member.read(1)  # the checksum is compared at the end
    return array.reshape(shape, order="F" if is_fortran else "C")
