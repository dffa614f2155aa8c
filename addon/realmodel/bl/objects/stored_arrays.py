# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in the .blend: data that were read from files are stored with the model.

They are custom properties of what they belong to, so they follow it through undo, copies and links: doubles,
which Blender's attributes are not, or whole numbers; text is one string. A group holds them by name, beside a
digest by which caches know them.
"""

import hashlib
from collections.abc import Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ...core import InputRefused

_BETWEEN = "\0"  # texts of an array
# MemoryError: a few bytes of a damaged file may say that they are far more
_BROKEN = (AttributeError, KeyError, TypeError, ValueError, MemoryError)


class StoredArrays(Mapping):
    """The arrays that a row of the settings, or an object, has under a key: copies, by name. False where it
    has none, which is known without a look at them. Not to be kept: undo ends it. Raises InputRefused for
    arrays of a damaged file."""

    def __init__(self, owner, key):
        self._owner, self._key = owner, key

    def __bool__(self):
        return self._key in self._owner

    @property
    def digest(self):
        """A text that differs where arrays do; "" where there are none."""
        try:
            return self._owner[self._key]["digest"] if self else ""
        except _BROKEN:
            return "damaged"

    def __getitem__(self, name):
        part = self._parts()[name]
        with _refusing():
            return _array(**part)

    def __contains__(self, name):
        return name in self._parts()

    def __iter__(self):
        return iter(self._parts())

    def __len__(self):
        return len(self._parts())

    def count(self, name):
        """How many rows an array has, without a look at it."""
        with _refusing():
            return self._parts()[name]["shape"][0]

    def _parts(self):
        with _refusing():
            return dict(self._owner[self._key]["arrays"].items()) if self else {}


class ArraysProperty:
    """A property of a class of settings: StoredArrays. Arrays by name can be assigned, none remove it."""

    def __set_name__(self, _owner, name):
        self._key = name

    def __get__(self, row, _owner=None):
        return StoredArrays(row, self._key)

    def __set__(self, row, arrays):
        store(row, self._key, arrays)


def store(owner, key, arrays):
    """Stores arrays by name, in place of those that an owner has under a key; None where they are none."""
    digest, parts = hashlib.blake2b(digest_size=16), {}
    for name, content in arrays.items():
        array = np.asarray(content)
        values, kind, shape = _values(array), array.dtype.str, list(array.shape)
        digest.update(repr((name, kind, shape)).encode())
        digest.update(values.encode() if isinstance(values, str) else values)
        parts[name] = {"kind": kind, "shape": shape, "values": values}
    if key in owner:
        del owner[key]  # Blender 4.5 does not let a property become one of another type
    if parts:
        owner[key] = {"digest": digest.hexdigest(), "arrays": parts}


def _values(array):
    """The numbers of an array as Blender has arrays, in one row; its texts as one."""
    if array.dtype.kind == "U":
        return _BETWEEN.join(array.ravel().tolist())
    return array.ravel().astype(np.int32 if np.can_cast(array.dtype, np.int32) else np.float64)


def _array(kind, shape, values):
    if np.dtype(kind).kind not in "Ubiuf":
        raise ValueError(f"arrays of {kind}")
    if isinstance(values, str):
        array = np.array(values.split(_BETWEEN) if np.prod(shape) else [], str)
    else:
        array = np.array(values).astype(kind)
    return array.reshape(shape)


@contextmanager
def _refusing():
    try:
        yield
    except InputRefused:
        raise
    except _BROKEN as error:
        raise InputRefused(
            f"the data stored in the .blend file are damaged: {error}",
            advice="choose its file again, or open an older copy of the .blend",
        ) from error


def file_stamp(path):
    """The path, time and size of a file, by which changes of it are detected; "" where it does not exist."""
    try:
        stat = Path(path).stat()
    except (OSError, ValueError):
        return ""
    return f"{path}|{stat.st_mtime_ns}|{stat.st_size}"
