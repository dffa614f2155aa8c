# SPDX-License-Identifier: GPL-3.0-or-later
"""The digest of all that a model is made from. A scene keeps that of its model: where it has another one now,
the model is out of date."""

import dataclasses
import hashlib

import numpy as np

_LOOKS = ("color", "look", "look_scale", "look_seed", "hardness")  # of a property: they follow at once


def of_project(project, read_from=()):
    """The digest of a project, as text.

    read_from: for the entries (rock masses, surfaces, faults, bodies) that come from a file, by their id():
    the entry as its settings name the file, and the stamp of the file. They count in place of the entry, as
    the arrays are the same whether they are still to be read or stored already.
    """
    found = hashlib.blake2b(digest_size=16)
    _add(found.update, project, dict(read_from))
    return found.hexdigest()


def _add(update, value, read_from):
    if id(value) in read_from:
        value, stamp = read_from[id(value)]
        update(f"file {stamp!r}".encode())
    if dataclasses.is_dataclass(value):
        update(type(value).__name__.encode())
        for field in dataclasses.fields(value):
            if field.compare and field.name not in _LOOKS:
                update(f" {field.name} ".encode())
                _add(update, getattr(value, field.name), read_from)
    elif isinstance(value, np.ndarray):
        update(f"{value.dtype.str}{value.shape}".encode())
        update(value.tobytes() if value.dtype != object else repr(value.tolist()).encode())
    elif isinstance(value, dict):
        update(f"dict {len(value)} ".encode())
        for pair in value.items():
            _add(update, pair, read_from)
    elif isinstance(value, (list, tuple)):
        update(f"list {len(value)} ".encode())
        for each in value:
            _add(update, each, read_from)
    else:
        update(f"{value!r};".encode())
