# SPDX-License-Identifier: GPL-3.0-or-later
"""The digest of all that a model is made from: where it is another one now, the model is out of date."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .project import Project

_LOOKS = ("color", "look", "look_scale", "look_seed", "hardness")  # of a property: they follow at once


def fingerprint(project: Project, files: Mapping[int, tuple[object, str]]) -> str:
    """The digest of a project.

    files: for entries (rock masses, surfaces, faults, bodies) that come from a file, by their id(): the entry
    as its settings name the file, and the stamp of the file. They count in place of the entry, so that it is
    the same whether the file is still to be read or its arrays are stored already.
    """
    digest = hashlib.blake2b(digest_size=16)
    _add(digest.update, project, files)
    return digest.hexdigest()


def _add(update: Callable[[bytes], None], value: Any, files: Mapping[int, tuple[object, str]]) -> None:
    if id(value) in files:
        value, stamp = files[id(value)]
        update(f"file {stamp!r} ".encode())
    if dataclasses.is_dataclass(value):
        update(f"{type(value).__name__} ".encode())
        for field in dataclasses.fields(value):
            if field.compare and field.name not in _LOOKS:
                update(f"{field.name} ".encode())
                _add(update, getattr(value, field.name), files)
    elif isinstance(value, np.ndarray):
        is_text = value.dtype == object
        update(f"{value.dtype.str}{value.shape} ".encode())
        update(repr(value.tolist()).encode() if is_text else np.ascontiguousarray(value).tobytes())
    elif isinstance(value, (Mapping, list, tuple)):
        items = list(value.items()) if isinstance(value, Mapping) else value
        update(f"list {len(items)} ".encode())
        for element in items:
            _add(update, element, files)
    else:
        update(f"{value!r} ".encode())
