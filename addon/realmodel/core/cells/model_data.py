# SPDX-License-Identifier: GPL-3.0-or-later
"""What a built model holds: its cells, blocks and surfaces, and its input."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol, Self, TypeVar

import numpy as np

from ..base.errors import BuildWarning, InputRefused, UsageError
from ..base.named import NamedList, number_of
from ..base.triangles import Triangulation
from ..heights import Interpolation
from ..project.project import Project
from ..structures.parts.parts import Structures
from ..surfaces.rock_input import RockInput
from ..surfaces.surface_input import SurfaceArrays, sheet_sizes, triangle_sheets, vertex_attributes
from .blocks import Block, BlockBoundary
from .cell_complex import CellComplex

_GOLDEN = 0.618034  # of the circle of hues: no two of the first dozens come near each other


class UsedSurfaces(Protocol):
    """What a Model and a SurfaceSet say of their surfaces, faults and bodies as they were used."""

    project: Project
    rock_inputs: list[RockInput]
    surface_names: list[str]
    surface_kind: np.ndarray
    warnings: list[BuildWarning]
    structures: Structures

    @property
    def interpolations(self) -> list[Interpolation | None]: ...
    @property
    def surface_triangle_sheet(self) -> np.ndarray: ...
    def surface(self, key: int | str) -> Triangulation: ...
    def surface_attributes(self, key: int | str) -> dict[str, np.ndarray]: ...


@dataclass(eq=False)
class ModelData:
    """The data of a Model, and what follows from them at once.

    The arrays of `complex`, the cells, and of `surface_arrays`, the input surfaces, are attributes here, too,
    under the names of docs/dev/geometry.md. `surface_names` go with the global indices of the surfaces.
    `project` holds the arrays that the model was built from, so that nothing is read again. `rock_inputs` are
    what the stack builder took, by rock mass. `timings` are seconds by phase. `is_cut`: it is a half of
    another model (docs/dev/geometry.md, "Cutting"). `warnings`: what was left out or changed, or is probably
    a mistake. `threads`: how many it was built with. `surface_kind` (S,) int32: 0 an interface, 1 a fault, 2
    a body. `cell_compartment` (C,) int32: of each cell, an index of `compartment_names`; `compartment_sides`:
    on which side of each fault the compartments are. `structures`: faults and bodies as they were built.
    `lacks_project`: the file of RealModel 0.1, or of a tile, that it was read from, which has only names,
    properties and shapes of the project.
    """

    complex: CellComplex = field(repr=False)
    blocks: NamedList[Block]
    surface_arrays: SurfaceArrays = field(repr=False)
    surface_names: list[str]
    project: Project
    rock_inputs: list[RockInput] = field(default_factory=list, repr=False)
    warnings: list[BuildWarning] = field(default_factory=list)
    timings: dict[str, float] = field(default_factory=dict)
    threads: int = 0
    is_cut: bool = False
    surface_kind: np.ndarray = None  # type: ignore[assignment]  # __post_init__ makes it: all interfaces
    cell_compartment: np.ndarray = None  # type: ignore[assignment]  # likewise: all in one
    compartment_names: list[str] = field(default_factory=list)
    compartment_sides: np.ndarray | None = field(default=None, repr=False)
    structures: Structures = field(default_factory=lambda: Structures([], [], [], []), repr=False)
    lacks_project: Path | None = None

    @classmethod
    def of(cls, data: ModelData) -> Self:
        """The same as an object of this class."""
        return cls(**{entry.name: getattr(data, entry.name) for entry in fields(data)})

    def __post_init__(self) -> None:
        if self.surface_kind is None:
            self.surface_kind = np.zeros(len(self.surface_names), np.int32)
        if self.cell_compartment is None:
            self.cell_compartment = np.zeros(len(self.cell_block), np.int32)

    def require_project(self, what: str) -> None:
        """Raises InputRefused where the project that `what` needs is not known."""
        if self.lacks_project is not None:
            raise InputRefused(
                f"a model of RealModel 0.1, or a tile, without its project, which {what} needs",
                file=self.lacks_project,
                advice="build it from its project and save it again",
            )

    @property
    def is_stack(self) -> bool:
        """Whether it is made of sheets alone: no faults, no bodies, no level sets of fields."""
        return not self.structures.is_divided and not any(entry.fields for entry in self.rock_inputs)

    @property
    def surface_is_level_set(self) -> np.ndarray:
        """(S,) bool: the surfaces that are level sets of the field of a series."""
        are_level_sets = [
            entry.field_of(number) is not None
            for entry in self.rock_inputs
            for number in range(len(entry.surfaces))
        ]
        return np.array(are_level_sets + [False] * (len(self.surface_names) - len(are_level_sets)), bool)

    def native(self) -> dict[str, Any]:
        """The cells as functions of the native module take them."""
        return self.complex.native(len(self.blocks))

    @property
    def vertices(self) -> np.ndarray:
        """(V, 3) float64, model units."""
        return self.complex.vertices

    @property
    def face_offsets(self) -> np.ndarray:
        """(F + 1,) int64: face k has the corners face_vertices[face_offsets[k] : face_offsets[k + 1]]."""
        return self.complex.face_offsets

    @property
    def face_vertices(self) -> np.ndarray:
        """int32: the corners of all faces, counter-clockwise seen from outside the first cell of each."""
        return self.complex.face_vertices

    @property
    def face_cells(self) -> np.ndarray:
        """(F, 2) int32: the cell on each side of a face; -1 outside, which only the second may be."""
        return self.complex.face_cells

    @property
    def face_surface(self) -> np.ndarray:
        """(F,) int32: the global index of the surface that a face lies on; -1 a vertical wall, -2 the flat
        base, -3 a cut."""
        return self.complex.face_surface

    @property
    def cell_block(self) -> np.ndarray:
        """(C,) int32: the block of each cell, an index of `blocks`."""
        return self.complex.cell_block

    @property
    def cell_kind(self) -> str:
        """ "columns" or "blocks"."""
        return self.complex.cell_kind

    @property
    def surface_vertices(self) -> np.ndarray:
        """(Vs, 3) float64: the vertices of all input surfaces, one surface after another."""
        return self.surface_arrays.vertices

    @property
    def surface_triangles(self) -> np.ndarray:
        """(Ts, 3) int32: their triangles, which index within their own surface."""
        return self.surface_arrays.triangles

    @property
    def surface_vertex_offsets(self) -> np.ndarray:
        """(S + 1,) int64: where the vertices of each surface begin."""
        return self.surface_arrays.vertex_offsets

    @property
    def surface_triangle_offsets(self) -> np.ndarray:
        """(S + 1,) int64: where the triangles of each surface begin."""
        return self.surface_arrays.triangle_offsets

    @property
    def face_blocks(self) -> np.ndarray:
        """(F, 2) int32: the block on each side of a face; -1 outside."""
        return self.complex.face_blocks

    @property
    def cell_component(self) -> np.ndarray:
        """(C,) int32: the least cell of the connected component of a block that each cell belongs to."""
        return self.complex.cell_component

    @cached_property
    def plan_boxes(self) -> np.ndarray:
        """(4, F) float64: the least x and y of each face, and the largest ones."""
        corners, starts = self.vertices[self.face_vertices, :2].T, self.face_offsets[:-1]
        if not len(starts):
            return np.empty((4, 0))
        return np.vstack([end.reduceat(corners, starts, axis=1) for end in (np.minimum, np.maximum)])

    @cached_property
    def cell_volumes(self) -> np.ndarray:
        """(C,) float64: the volume of each cell, model units cubed."""
        return self.complex.cell_volumes(self.threads)

    def block_boundary(self, block: int | str) -> BlockBoundary:
        """The closed boundary of one block, all its connected components together. block: its name, or its
        number from 0; the boundary of an absent block has no faces.

        Raises UsageError for an unknown one, and for a name of several blocks or of an absent one.
        """
        number = number_of(block, self.blocks.names, "block")
        if isinstance(block, str) and not self.blocks[number].cells:
            raise UsageError(f"block '{block}' is absent: the model contains none of it")
        return self.complex.block_boundary(number)

    def face_corners(self, faces: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As CellComplex.face_corners."""
        return self.complex.face_corners(faces, turned)

    @cached_property
    def component_volumes(self) -> list[np.ndarray]:
        """For each block the volumes of its connected components, largest first."""
        volume = np.bincount(self.cell_component, self.cell_volumes, len(self.cell_block))
        roots = np.flatnonzero(self.cell_component == np.arange(len(self.cell_block)))
        order = roots[np.lexsort((roots, -volume[roots], self.cell_block[roots]))]
        counts = np.bincount(self.cell_block[order], minlength=len(self.blocks))
        return np.split(volume[order], np.cumsum(counts)[:-1]) if len(counts) else []

    @property
    def volume(self) -> float:
        """The volume of all blocks, model units cubed."""
        return float(sum(block.volume for block in self.blocks))

    @property
    def block_colors(self) -> np.ndarray:
        """(B, 3) float64: the color of each block's property, sRGB from 0 to 1; where there is none one of a
        circle of hues."""
        library = self.project.library
        entries = [library.get(block.property) if library else None for block in self.blocks]
        return np.array(
            [
                entry.rgb if entry and entry.rgb else colorsys.hsv_to_rgb(number * _GOLDEN % 1.0, 0.35, 0.85)
                for number, entry in enumerate(entries)
            ]
        )

    @property
    def interpolations(self) -> list[Interpolation | None]:
        """The interpolation of each surface, by its global index; None for ready meshes."""
        return [result for entry in self.rock_inputs for result in entry.interpolations]

    def surface_attributes(self, key: int | str) -> dict[str, np.ndarray]:
        """What is known of the vertices of one input surface, by its name or global index, (V,) float64 each:
        `height`; `variance` of the error of an interpolated height, squared model units; `distance` in plan
        to the nearest point that it was interpolated from. NaN where there is no such thing, as for all
        vertices of a ready mesh."""
        number = number_of(key, self.surface_names, "surface")
        return vertex_attributes(self.rock_inputs, number, self.surface(number).vertices)

    @property
    def surfaces(self) -> NamedList[Triangulation]:
        """The input surfaces, faults and bodies, by their names or global indices.

        >>> vertices, triangles = model.surfaces["ground"]
        >>> float(vertices[:, 2].max())
        5.0
        """
        shapes = (shape.arrays for shape in self.surface_arrays.shapes)
        return NamedList(shapes, self.surface_names, "surface")

    def surface(self, key: int | str) -> Triangulation:
        """One of `surfaces`. key: its name or global index. Raises UsageError."""
        return self.surface_arrays.shapes[number_of(key, self.surface_names, "surface")].arrays

    @property
    def surface_triangle_sheet(self) -> np.ndarray:
        """(Ts,) int32: of each of `surface_triangles` the sheet of its surface that it is of, from 0."""
        structures = np.flatnonzero(self.surface_kind).tolist()
        if structures:
            self.require_project("a sheet of a surface")
        count = sum(len(self.surface(number)[1]) for number in structures)
        return np.append(triangle_sheets(self.rock_inputs), np.zeros(count, np.int32))

    def sheet_triangles(self, key: int | str) -> list[np.ndarray]:
        """The triangles (T, 3) of each sheet of a surface; one that no fault displaces has one. key: the name
        or global index of the surface."""
        number = number_of(key, self.surface_names, "surface")
        if self.surface_kind.any():
            self.require_project("a sheet of a surface")
        triangles, sheets = self.surface(number).triangles, [0]
        if not self.surface_kind[number]:
            sheets = sheet_sizes(self.rock_inputs, number)
        return [sheet for sheet in np.split(triangles, np.cumsum(sheets[:-1])) if len(sheet)]


SomeModel = TypeVar("SomeModel", bound=ModelData)  # what is made of a model is of its class
