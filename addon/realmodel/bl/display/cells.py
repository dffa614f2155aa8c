# SPDX-License-Identifier: GPL-3.0-or-later
"""The polyhedral cells of blocks as meshes in which each stands by itself, drawn a little smaller."""

import itertools
import json

import numpy as np

from .. import block_shapes, project_settings
from ..origin import offsets_from
from . import cuts, shown_models

SHRINK = 0.88  # of a cell's size: the gaps let each be seen
_kept = {}  # by the name of a scene: (what the cells are of, {(rock mass, block): arrays})


def made_of(scene, stage):
    """What the cells of a scene at a stage are made of, as text."""
    cut = scene.realmodel.view.cut if cuts.is_shown(scene) else ""
    return json.dumps([scene.realmodel.built_stamp, stage, cut])


class Recipe:
    """How the meshes of cells are made: those of the model at a stage, or of its half where the cut is shown.
    Used as `shown_models.Recipe` is. Raises InputRefused."""

    def __init__(self, scene, stage):
        self.scene_name, self.made_of = scene.name, made_of(scene, stage)
        known, shapes = _kept.get(scene.name, ("", None))
        self.shapes = shapes if known == self.made_of else None
        self._half = self._plane = None
        if cuts.is_shown(scene):
            self._half = cuts.known_half(scene, scene.realmodel.view.cut, "columns")
            self._plane = json.loads(scene.realmodel.view.cut)[:2]
        self._model = shown_models.Recipe(scene, stage, "columns") if self._half is None else None
        self._origin = project_settings.model_origin(scene)

    @property
    def is_ready(self):
        return self.shapes is not None

    def make(self, cancel=None):
        """{(rock mass, block): arrays}, in float32 offsets from the model origin. Raises RealModelError."""
        if self.shapes is None:
            model = self._half
            if model is None:
                model = self._model.make(cancel)
                if self._plane is not None:
                    model = model.cut_by_plane(*self._plane, cancel=cancel).below
            shapes = [shell and (offsets_from(self._origin, shell[0]), *shell[1:]) for shell in shells(model)]
            self.shapes = block_shapes.by_name(model, shapes)
        return self.shapes

    def keep(self):
        """Keeps what was made until other cells are asked for."""
        _kept[self.scene_name] = (self.made_of, self.shapes)
        if self._model is not None:
            self._model.keep()


def of_scene(scene, stage):
    """The meshes of the cells, made in this thread if they are not at hand. Raises RealModelError."""
    recipe = Recipe(scene, stage)
    shapes = recipe.make()
    recipe.keep()
    return shapes


def forget():
    """Lets go of the cells: they are in the scene, or no longer wanted."""
    _kept.clear()


def shells(model, shrink=SHRINK):
    """For each block of a model the shells of all its cells, None where it has none.

    model: realmodel.core.Model. Each entry: (coordinates (V, 3) float64 in model units, offsets (F + 1,) and
    corners int32, face_surface (F,) int32). Every cell has its own vertices, drawn towards their mean by
    `shrink`, and its faces counter-clockwise seen from outside.
    """
    owner, other = model.face_cells[:, 0], model.face_cells[:, 1]
    inner = np.flatnonzero(other >= 0)
    faces = np.concatenate([np.arange(len(owner)), inner])
    cells = np.concatenate([owner, other[inner]])
    turned = np.arange(len(faces)) >= len(owner)
    block = model.cell_block[cells]
    order = np.argsort(block.astype(np.int64) * len(model.cell_block) + cells, kind="stable")
    faces, cells, turned, block = faces[order], cells[order], turned[order], block[order]
    ends = np.searchsorted(block, np.arange(len(model.blocks) + 1))
    found = []
    for begin, end in itertools.pairwise(ends):
        some = slice(begin, end)
        found.append(_shell(model, faces[some], cells[some], turned[some], shrink) if end > begin else None)
    return found


def _shell(model, faces, cells, turned, shrink):
    """cells: (F,) in rising order, the cell that each face bounds."""
    offsets, vertices = model.face_corners(faces, turned)
    cell = np.cumsum(np.diff(cells, prepend=cells[:1]) != 0)  # counted from 0
    cell = np.repeat(cell, np.diff(offsets))
    # Corners of a cell are together already, so that a stable sort has little left to do.
    key = cell * len(model.vertices) + vertices
    order = np.argsort(key, kind="stable")
    key = key[order]
    is_first = np.append(True, key[1:] != key[:-1])
    corners = np.empty(len(key), np.int32)
    corners[order] = np.cumsum(is_first, dtype=np.int32) - 1
    cell, vertex = np.divmod(key[is_first], len(model.vertices))
    coordinates = model.vertices[vertex]
    begins = np.flatnonzero(np.diff(cell, prepend=-1))
    count = np.diff(begins, append=len(cell))
    centre = np.add.reduceat(coordinates, begins) / count[:, None]
    coordinates = shrink * coordinates + (1.0 - shrink) * np.repeat(centre, count, axis=0)
    return coordinates, offsets.astype(np.int32), corners, model.face_surface[faces]
