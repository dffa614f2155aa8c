# SPDX-License-Identifier: GPL-3.0-or-later
"""The cache of models that were built in this session of Blender.

A scene refers to its model by `built_stamp`, which is saved and undone with the scene. After a .blend was
opened the model is not in the cache, and is built again when it is needed.
"""

import secrets

import numpy as np

from ..host import caches


def _bytes_of(model):
    """The memory that the arrays of a model take: those of its cells and of its surfaces, and its own."""
    held = [value for part in (model, model.complex, model.surface_arrays) for value in vars(part).values()]
    return sum(value.nbytes for value in held if isinstance(value, np.ndarray))


_models = caches.new(most=1 << 30, size_of=_bytes_of)  # (stamp, cells) -> realmodel.core.Model


def remember(model, stamp=None, instead_of=None):
    """Keeps a model; returns the stamp by which a scene names it. stamp: of the same model with other
    cells. instead_of: the stamp of a model that it replaces, such as that of the previous live build."""
    stamp = stamp or new_stamp()
    for key in [key for key in _models if key[0] == instead_of]:
        del _models[key]
    _models[stamp, model.cell_kind] = model
    return stamp


def new_stamp():
    """A stamp for a model that is yet to be built."""
    return secrets.token_hex(8)


def current(scene, cells=None):
    """The realmodel.core.Model that a scene shows, or None where it is not in the cache.

    cells: "columns" or "blocks"; None: any, preferably columns.
    """
    stamp = scene.realmodel.built_stamp
    kinds = ("columns", "blocks") if cells is None else (cells,)
    return next((_models[stamp, kind] for kind in kinds if (stamp, kind) in _models), None)
