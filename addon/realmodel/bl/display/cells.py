# SPDX-License-Identifier: GPL-3.0-or-later
"""The polyhedral cells of blocks as meshes in which each stands by itself, drawn a little smaller."""

import itertools

import numpy as np

SHRINK = 0.88  # of a cell's size: the gaps let each be seen


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
    order = np.lexsort((faces, cells, block))
    faces, cells, turned, block = faces[order], cells[order], turned[order], block[order]
    ends = np.searchsorted(block, np.arange(len(model.blocks) + 1))
    found = []
    for begin, end in itertools.pairwise(ends):
        some = slice(begin, end)
        found.append(_shell(model, faces[some], cells[some], turned[some], shrink) if end > begin else None)
    return found


def _shell(model, faces, cells, turned, shrink):
    size = np.diff(model.face_offsets)[faces]
    offsets = np.concatenate([[0], np.cumsum(size)])
    owner = np.repeat(np.arange(len(faces)), size)
    rank = np.arange(len(owner)) - offsets[owner]
    rank = np.where(turned[owner], size[owner] - 1 - rank, rank)
    vertices = model.face_vertices[model.face_offsets[faces][owner] + rank]
    _, cell = np.unique(cells, return_inverse=True)
    key = cell[owner].astype(np.int64) * len(model.vertices) + vertices
    key, corners = np.unique(key, return_inverse=True)
    cell, vertex = np.divmod(key, len(model.vertices))
    coordinates = model.vertices[vertex]
    count = np.bincount(cell)
    centre = np.column_stack([np.bincount(cell, coordinates[:, k]) / count for k in range(3)])[cell]
    coordinates = centre + shrink * (coordinates - centre)
    return coordinates, offsets.astype(np.int32), corners.astype(np.int32), model.face_surface[faces]
