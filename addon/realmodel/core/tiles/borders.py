# SPDX-License-Identifier: GPL-3.0-or-later
"""What two tiles have on the line between them.

Both see the same surfaces on the line, so their interfaces are the same broken lines there. But a tile may
have vertices on a straight stretch that its neighbor has not (where it divided a facet). So tiles exchange
these vertices; then, between two neighboring vertices of the line, a block is one quadrilateral that both
tiles have with the same doubles, for any division into cells on either side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.algebra import begins_run, ranks_in_runs
from ..base.mapped_arrays import ROWS_AT_ONCE, in_pieces
from ..cells.model_data import ModelData, SomeModel

_BASE = -2  # face_surface of the flat base


@dataclass(frozen=True)
class Side:
    """One of the four sides of a tile: on the line where coordinate `axis` is `line`."""

    name: str
    axis: int
    line: float
    step: tuple[int, int]  # to the neighbor: columns, rows

    @property
    def along(self) -> int:
        return 1 - self.axis


OPPOSITE = {"west": "east", "east": "west", "south": "north", "north": "south"}


def sides_of(box: tuple[float, float, float, float]) -> list[Side]:
    low_x, low_y, high_x, high_y = box
    return [
        Side("west", 0, low_x, (-1, 0)),
        Side("east", 0, high_x, (1, 0)),
        Side("south", 1, low_y, (0, -1)),
        Side("north", 1, high_y, (0, 1)),
    ]


@dataclass(frozen=True)
class Interfaces:
    """The edges of interfaces on a side: what each lies on (E,) int64, a surface or below -1 the base of a
    block; and its ends (E, 2), vertices."""

    on: np.ndarray
    ends: np.ndarray


@dataclass(frozen=True)
class BorderEdges:
    """What of a model is on its border. vertices (N,): all there, ascending.
    face, at, first, second (E,): the edges of all faces between two of them: the face, the place of the
    first corner in face_vertices, and both vertices."""

    vertices: np.ndarray
    face: np.ndarray
    at: np.ndarray
    first: np.ndarray
    second: np.ndarray

    @classmethod
    def of(cls, model: ModelData, vertices: np.ndarray, faces: np.ndarray | None = None) -> BorderEdges:
        """vertices: all on the border, ascending. faces: among which all are that have an edge there,
        ascending; None: not known."""
        on = np.zeros(len(model.vertices), bool)
        on[vertices] = True
        corners = model.face_vertices
        if faces is None:
            at = np.concatenate(
                [np.flatnonzero(on[piece]) + n * ROWS_AT_ONCE for n, piece in enumerate(in_pieces(corners))]
                or [np.empty(0, np.int64)]
            )
            face = np.searchsorted(model.face_offsets, at, "right") - 1
        else:
            size = model.face_offsets[faces + 1] - model.face_offsets[faces]
            at, face = _spread(model.face_offsets[faces], size), np.repeat(faces, size)
            at, face = at[on[corners[at]]], face[on[corners[at]]]
        following = np.where(at + 1 == model.face_offsets[face + 1], model.face_offsets[face], at + 1)
        is_edge = on[corners[following]]
        at, face, following = at[is_edge], face[is_edge], following[is_edge]
        return cls(vertices, face, at, corners[at], corners[following])

    def on(self, model: ModelData, side: Side) -> BorderEdges:
        """What is on one side; of the edges those that are not vertical."""
        places = model.vertices
        vertices = self.vertices[places[self.vertices, side.axis] == side.line]
        is_on = (places[self.first, side.axis] == side.line) & (places[self.second, side.axis] == side.line)
        is_edge = is_on & (places[self.first, side.along] != places[self.second, side.along])
        return BorderEdges(
            vertices, *(array[is_edge] for array in (self.face, self.at, self.first, self.second))
        )


def _pairs(edges: BorderEdges) -> np.ndarray:
    """(E,) int64: a number for each edge's two vertices, whichever comes first."""
    low = np.minimum(edges.first, edges.second).astype(np.int64)
    return low << 32 | np.maximum(edges.first, edges.second)


def _interfaces_of(model: ModelData, edges: BorderEdges) -> tuple[np.ndarray, np.ndarray]:
    """Of the edges that lie on interfaces: their pairs of vertices, each once, and what they lie on."""
    surface = model.face_surface[edges.face].astype(np.int64)
    block = model.cell_block[model.face_cells[edges.face, 0]]
    on = np.where(surface == _BASE, _BASE - block, surface)
    of_interface = surface != -1
    pairs, first = np.unique(_pairs(edges)[of_interface], return_index=True)
    return pairs, on[of_interface][first]


def interfaces_on(model: ModelData, edges: BorderEdges) -> Interfaces:
    """The interfaces of a model on one side of it. edges: on this side."""
    pairs, on = _interfaces_of(model, edges)
    return Interfaces(on, np.column_stack([pairs >> 32, pairs & 0xFFFFFFFF]))


@dataclass(frozen=True)
class _Insertion:
    """Vertices to insert on one side. places (N, 3): of new ones. face, at (E,): into which faces and after
    which corners, by their places in face_vertices; count (E,): how many after each; and their numbers, one
    corner after another."""

    places: np.ndarray
    face: np.ndarray
    at: np.ndarray
    count: np.ndarray
    numbers: np.ndarray


def with_vertices_of(
    model: SomeModel, border: BorderEdges, neighbors: Sequence[tuple[Side, Interfaces, np.ndarray]]
) -> SomeModel:
    """The model with the vertices that its neighbors have on their interfaces, in all faces there; the model
    itself where there are none. border: of the model. neighbors: the side of each, its interfaces there, and
    the places (N, 3) of its vertices."""
    inserted, count = [], len(model.vertices)
    for side, theirs, places in neighbors:
        insertion = _insertion(model, side, border.on(model, side), theirs, places, count)
        if insertion is not None:
            inserted.append(insertion)
            count += len(insertion.places)
    if not inserted:
        return model
    face, at, size, numbers = (
        np.concatenate([getattr(insertion, name) for insertion in inserted])
        for name in ("face", "at", "count", "numbers")
    )
    begin = np.cumsum(size) - size
    order = np.argsort(at)  # and so by face
    face, at, size = face[order], at[order], size[order]
    numbers = numbers[_spread(begin[order], size)].astype(model.face_vertices.dtype)
    cells = replace(
        model.complex,
        vertices=np.concatenate([model.vertices, *(insertion.places for insertion in inserted)]),
        face_vertices=_with_inserted(model.face_vertices, at + 1, size, numbers),
        face_offsets=_moved_on(model.face_offsets, face + 1, size),
    )
    return replace(model, complex=cells)


def _with_inserted(array: np.ndarray, at: np.ndarray, count: np.ndarray, values: np.ndarray) -> np.ndarray:
    """An array with the first count[0] values before element at[0], the next before at[1], and so on."""
    pieces, done, first = [], 0, 0
    for place, size in zip(at.tolist(), count.tolist(), strict=True):
        pieces += [array[done:place], values[first : first + size]]
        done, first = place, first + size
    return np.concatenate([*pieces, array[done:]])


def _moved_on(offsets: np.ndarray, first: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Offsets of which those from first[0] on are more by by[0], those from first[1] on by by[1] more."""
    moved = offsets.copy()
    ends = [*first[1:].tolist(), len(moved)]
    for begin, end, more in zip(first.tolist(), ends, np.cumsum(by).tolist(), strict=True):
        moved[begin:end] += more
    return moved


def _insertion(
    model: ModelData, side: Side, edges: BorderEdges, other: Interfaces, places: np.ndarray, first_number: int
) -> _Insertion | None:
    """What of a neighbor's vertices is inserted on a side; None: nothing. first_number: of new vertices."""
    pairs, on = _interfaces_of(model, edges)
    if not len(pairs):
        return None
    ends = np.column_stack([pairs >> 32, pairs & 0xFFFFFFFF])
    along = np.sort(model.vertices[ends, side.along], axis=1)
    begin, count = np.zeros((2, len(pairs)), np.int64)
    points: list[np.ndarray] = []
    for number in np.unique(on):
        theirs = places[np.unique(other.ends[other.on == number])]
        theirs = theirs[np.unique(theirs[:, side.along], return_index=True)[1]]  # and ascending
        is_on = on == number
        present = _on_line(model.vertices[ends[is_on].ravel()], side)
        theirs = theirs[~np.isin(_on_line(theirs, side), present)]
        start = np.searchsorted(theirs[:, side.along], along[is_on, 0], "right")
        stop = np.searchsorted(theirs[:, side.along], along[is_on, 1], "left")
        begin[is_on], count[is_on] = start + sum(len(piece) for piece in points), np.maximum(stop - start, 0)
        points.append(theirs)
    if not count.any():
        return None
    added = np.concatenate(points)[_spread(begin, count)]
    added, numbers = _numbered(model, side, edges.vertices, added, first_number)
    first_new = np.cumsum(count) - count
    # of each edge of a face the new vertices in its direction
    place = np.searchsorted(pairs, _pairs(edges))
    place[place == len(pairs)] = 0
    needed = (pairs[place] == _pairs(edges)) & (count[place] > 0)
    face, at, place = edges.face[needed], edges.at[needed], place[needed]
    first, second = (model.vertices[vertices[needed], side.along] for vertices in (edges.first, edges.second))
    backward = first > second
    size = count[place]
    inserted = _spread(first_new[place], size)
    step = ranks_in_runs(size)
    inserted = np.where(
        np.repeat(backward, size), np.repeat(first_new[place] + size - 1, size) - step, inserted
    )
    return _Insertion(added, face, at, size, numbers[inserted])


def _on_line(places: np.ndarray, side: Side) -> np.ndarray:
    """(N,) complex128: places (N, 3) on the line of a side, each a number that sorts as they do."""
    return places[:, side.along] + 1j * places[:, 2]


def _numbered(
    model: ModelData, side: Side, present: np.ndarray, added: np.ndarray, first_number: int
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (N, 3) that the model has no vertex at yet, each once, and the vertex number of each given
    one: edges may meet in a vertex that one of them passes. present: the vertices on the side."""
    both = np.concatenate([model.vertices[present], added])
    _, first, same = np.unique(_on_line(both, side), return_index=True, return_inverse=True)
    first = first[same[len(present) :]]  # the first of the equal ones: one that is there
    new, number = np.unique(first[first >= len(present)], return_inverse=True)
    numbers = np.empty(len(added), np.int64)
    numbers[first < len(present)] = present[first[first < len(present)]]
    numbers[first >= len(present)] = first_number + number
    return both[new], numbers


def _spread(begin: np.ndarray, count: np.ndarray) -> np.ndarray:
    """begin[0], begin[0] + 1, ... count[0] of them, then those of the next."""
    return np.repeat(begin, count) + ranks_in_runs(count)


@dataclass(frozen=True)
class Patches:
    """The blocks of a tile on one of its sides, in order: between two neighboring vertices of the line each
    is a quadrilateral. shape: (P, 6), the positions along the line, the lower edge's heights there and the
    upper edge's; block (P,), and cell (P,) of the tile. open: how often a wall had an edge above or
    below alone."""

    shape: np.ndarray
    block: np.ndarray
    cell: np.ndarray
    open: int = 0


def patches_on(model: ModelData, side: Side, edges: BorderEdges, positions: np.ndarray) -> Patches:
    """The patches of a model on one side of it. edges: on this side. positions: where on the line either tile
    has vertices, ascending. An edge that passes one without a vertex is divided there for the patches alone.
    """
    cells = model.face_cells[edges.face]
    wall = (model.face_surface[edges.face] == -1) & (cells[:, 1] == -1)
    face, cell = edges.face[wall], cells[wall, 0]
    along, height = _ends(model, side, np.column_stack([edges.first[wall], edges.second[wall]]))
    first = np.searchsorted(positions, along[:, 0])
    count = np.searchsorted(positions, along[:, 1]) - first
    part = _spread(first, count)
    face, cell = np.repeat(face, count), np.repeat(cell, count)
    along, height = np.repeat(along, count, axis=0), np.repeat(height, count, axis=0)
    divided = np.column_stack([positions[part], positions[part + 1]])
    share = (divided - along[:, :1]) / (along[:, 1:] - along[:, :1])
    between = height[:, :1] + share * (height[:, 1:] - height[:, :1])
    height = np.where(share == 0, height[:, :1], np.where(share == 1, height[:, 1:], between))
    order = np.lexsort((*height.T, height.sum(axis=1), part, face))
    face, part, cell, height, divided = (array[order] for array in (face, part, cell, height, divided))
    begin = np.flatnonzero(begins_run(np.column_stack([face, part])))
    size = np.diff([*begin, len(face)])
    lowest, highest = begin[size > 1], (begin + size - 1)[size > 1]
    shape = np.column_stack([divided[lowest], height[lowest], height[highest]]).reshape(-1, 6)
    cell = cell[lowest]
    order = np.lexsort((*shape.T[::-1], model.cell_block[cell]))
    alone = int((size == 1).sum())
    return Patches(shape[order], model.cell_block[cell[order]], cell[order], alone)


def positions_on(
    model: ModelData, side: Side, edges: BorderEdges, other: Interfaces, places: np.ndarray
) -> np.ndarray:
    """Where on a side a model has vertices, or its neighbor, ascending. edges: on this side."""
    positions = model.vertices[np.concatenate([edges.first, edges.second]), side.along]
    return np.unique(np.concatenate([positions, places[other.ends.ravel(), side.along]]))


def _ends(model: ModelData, side: Side, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(E, 2) positions along the line and heights of edges' ends (E, 2), the lesser position first."""
    along, height = model.vertices[ends, side.along], model.vertices[ends, 2]
    turned = along[:, 0] > along[:, 1]
    along[turned], height[turned] = along[turned, ::-1], height[turned, ::-1]
    return along, height


@dataclass(frozen=True)
class Matched:
    """Two tiles at their line. cells: (N, 2) of both tiles, which one block connects. patches: how many
    quadrilaterals there are; unequal: those that one side alone has. place: of the first of these."""

    cells: np.ndarray
    patches: int
    unequal: int = 0
    place: tuple[float, float, float] | None = None


def matched(one: Patches, other: Patches, side: Side) -> Matched:
    """Compares the patches of two tiles on their line, double for double. side: of the first tile."""
    same = np.array_equal(one.shape, other.shape) and np.array_equal(one.block, other.block)
    if same and one.open == other.open == 0:
        cells = np.unique(np.column_stack([one.cell, other.cell]), axis=0)
        return Matched(cells, len(one.cell))
    rows = {row: k for k, row in enumerate(_rows(other))}
    matches = [rows.get(row, -1) for row in _rows(one)]
    pairs = [(k, m) for k, m in enumerate(matches) if m >= 0]
    alone = [k for k, m in enumerate(matches) if m < 0]
    left = sorted(set(range(len(other.cell))).difference(matches))
    pairs += [(k, m) for k in alone for m in left if _overlap(one, k, other, m)]
    wrong = [one.shape[k] for k in alone] + [other.shape[m] for m in left]
    place = None
    if wrong:
        at = (side.line, float(wrong[0][0]))
        place = (*(at if side.axis == 0 else at[::-1]), float(wrong[0][2]))
    return Matched(
        np.unique(
            np.array([(one.cell[k], other.cell[m]) for k, m in pairs], np.int64).reshape(-1, 2), axis=0
        ),
        max(len(one.cell), len(other.cell)),
        len(wrong) + one.open + other.open,
        place,
    )


def _rows(patches: Patches) -> Sequence[tuple]:
    return list(zip(patches.block.tolist(), *patches.shape.T.tolist(), strict=True))


def _overlap(one: Patches, k: int, other: Patches, m: int) -> bool:
    """Whether patches of one block share an area, as doubles tell."""
    if one.block[k] != other.block[m]:
        return False
    a, b = one.shape[k], other.shape[m]
    low, high = max(a[0], b[0]), min(a[1], b[1])
    if not low < high:
        return False
    middle = (low + high) / 2
    bottom = max(np.interp(middle, shape[:2], shape[2:4]) for shape in (a, b))
    return bottom < min(np.interp(middle, shape[:2], shape[4:6]) for shape in (a, b))
