# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays as text in properties of the .blend: data that were read from files are stored with the model."""

import base64
import hashlib
import io
import zipfile
import zlib
from pathlib import Path

import numpy as np

from ...core import InputRefused
from ...core.exporters.npz import write_arrays
from ..host import caches

# MemoryError: a few bytes of a damaged file may say that they are far more
_BROKEN = (KeyError, TypeError, ValueError, OSError, EOFError, MemoryError, zipfile.BadZipFile, zlib.error)


def _bytes_of(arrays):
    return sum(array.nbytes for array in arrays.values())


# by digest of the text: arrays read lately, not to be written to
_unpacked = caches.new(most=256 << 20, size_of=_bytes_of)


def pack(**arrays):
    """A compressed .npz in base64. The same arrays give the same text."""
    file = io.BytesIO()
    write_arrays({name: np.asarray(array) for name, array in arrays.items()}, file, level=1)
    return base64.b64encode(file.getvalue()).decode("ascii")


def pack_mesh(vertices, triangles):
    """A triangulation as `pack` has it."""
    return pack(vertices=np.asarray(vertices, np.float64), triangles=np.asarray(triangles, np.int32))


def unpack(text):
    """The arrays of `pack` by name; they cannot be written to. Raises InputRefused for damaged text."""
    key = hashlib.blake2b(text.encode("ascii", "replace"), digest_size=16).digest()
    if key not in _unpacked:
        try:
            file = io.BytesIO(base64.b64decode(text, validate=True))
            with np.load(file, allow_pickle=False) as archive:
                arrays = {name: archive[name] for name in archive.files}
        except _BROKEN as error:
            raise InputRefused(
                f"what the .blend keeps of it cannot be read: {error}",
                advice="choose its file again, or open an older copy of the .blend",
            ) from error
        for array in arrays.values():
            array.flags.writeable = False
        _unpacked[key] = arrays
    return _unpacked[key]


def file_stamp(path):
    """The path, time and size of a file, by which changes of it are detected; "" where it does not exist."""
    try:
        found = Path(path).stat()
    except (OSError, ValueError):
        return ""
    return f"{path}|{found.st_mtime_ns}|{found.st_size}"
