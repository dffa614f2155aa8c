# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes meshes in advance, in slices, so that the window stays responsive while a large model comes in.

No scene refers to these meshes until `meshes.new_mesh` is called for the same shape, which then returns the
prepared mesh. Between two slices the user may undo, open another file, or purge unused data: so only names
are kept, no Blender data, and a mesh counts as made only if it still has its mark.
"""

import secrets
import time

import bpy

from ..host import caches

_MARK = "realmodel_ahead"  # on a mesh that was made ahead: by which slice
_made = caches.new()  # id of a shape -> (the shape, the name of its mesh, its mark)


class Slices:
    """The meshes of some shapes, made one after the other.

    shapes: (name, PolygonMesh) of each. new_mesh(name, shape): makes one.
    """

    def __init__(self, shapes, new_mesh):
        self._shapes, self._new_mesh = list(shapes), new_mesh
        self._at = 0

    def make(self, seconds):
        """Makes meshes for this number of seconds, at least one. Returns whether all are made."""
        until = time.perf_counter() + seconds
        while self._at < len(self._shapes):
            name, shape = self._shapes[self._at]
            self._at += 1
            mesh, mark = self._new_mesh(name, shape), secrets.token_hex(8)
            mesh[_MARK] = mark
            _made[id(shape)] = (shape, mesh.name, mark)
            if time.perf_counter() > until:
                break
        return self._at == len(self._shapes)

    def clear(self):
        """Removes what nobody has taken."""
        for _, shape in self._shapes[: self._at]:
            mesh = take(shape)
            if mesh is not None:
                bpy.data.meshes.remove(mesh)


def has(shape):
    """Whether the mesh of a shape was made ahead, and is still there."""
    return _mesh(shape) is not None


def take(shape):
    """The mesh that was made ahead of a shape, which counts as made no more; None where there is none."""
    mesh = _mesh(shape)
    _made.pop(id(shape), None)
    if mesh is not None:
        del mesh[_MARK]
    return mesh


def _mesh(shape):
    _, name, mark = _made.get(id(shape), (None, "", ""))
    mesh = bpy.data.meshes.get(name)
    is_it = mesh is not None and mesh.get(_MARK) == mark and not mesh.users
    return mesh if is_it else None
