# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume meshes as arrays: of tetrahedra, pyramids, prisms and hexahedra, or of polyhedra."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..cells.model_data import ModelData
from ..notebook import ShortRepr, VtkCells, polyhedron_grid, volume_grid

if TYPE_CHECKING:
    import pyvista
from ..base.errors import BuildWarning
from ..base.work import native_module

# The corners of each kind of element. They stand as in Gmsh, CGNS and Abaqus: of the first face (three or
# four corners) counter-clockwise as seen from the rest of the element, so that volumes are positive; of a
# prism and a hexahedron then the corners above them in the same order. VTK turns prisms the other way round.
CORNERS = {"tetrahedron": 4, "pyramid": 5, "prism": 6, "hexahedron": 8}
_VTK_TYPES = {"tetrahedron": 10, "pyramid": 14, "prism": 13, "hexahedron": 12}
_VTK_PRISM = [0, 2, 1, 3, 5, 4]


@dataclass(frozen=True, eq=False, repr=False)
class PlanMesh(ShortRepr):
    """The planar mesh that columns of elements stand on.

    vertices: (P, 2) float64. triangles: (T, 3) int32, counter-clockwise. column, layer: of the elements of
    each kind, (E,) int32: the triangle that each lies over, and its layer, 0 the highest. layers: how many
    there are.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    column: dict[str, np.ndarray]
    layer: dict[str, np.ndarray]
    layers: int


@dataclass(frozen=True, eq=False, repr=False)
class VolumeMesh(ShortRepr):
    """A mesh of elements for solvers.

    points: (N, 3) float64, model units; every one is used.
    elements: of each kind of CORNERS that there is, (E, corners) int32.
    element_block: of each kind, (E,) int32: the block of each element, an index of block_names.
    faces: "triangle" (F, 3), "quadrilateral" (F, 4) int32: each face of an element that lies on the outside,
    or inside on a surface, once; those of the outside counter-clockwise seen from outside.
    face_surface: of both, (F,) int32: the surface that each lies on, an index of surface_names; -1 a vertical
    wall, -2 the flat base, -3 a cut.
    block_names, block_property (B,) int32 (ids of the library, 0: none), surface_names, surface_kind (S,)
    int32: as of the model; so blocks and surfaces have the numbers that they have there.
    plan: where the elements stand in columns.
    element_compartment: of each kind, (E,) int32, as cell_compartment of the model; None: of one.
    """

    points: np.ndarray
    elements: dict[str, np.ndarray]
    element_block: dict[str, np.ndarray]
    faces: dict[str, np.ndarray]
    face_surface: dict[str, np.ndarray]
    block_names: list[str]
    block_property: np.ndarray
    surface_names: list[str]
    surface_kind: np.ndarray
    plan: PlanMesh | None = None
    element_compartment: dict[str, np.ndarray] | None = None

    @property
    def cells(self) -> int:
        """The number of elements."""
        return sum(map(len, self.elements.values()))

    def vtk_cells(self) -> VtkCells:
        """The elements one after another, kind by kind, as VTK has them."""
        types, sizes, corners = [np.empty(0, np.uint8)], [np.empty(0, np.int64)], [np.empty(0, np.int64)]
        for kind, elements in self.elements.items():
            types.append(np.full(len(elements), _VTK_TYPES[kind], np.uint8))
            sizes.append(np.full(len(elements), CORNERS[kind]))
            corners.append((elements[:, _VTK_PRISM] if kind == "prism" else elements).ravel())
        offsets = np.cumsum(np.concatenate([np.zeros(1, np.int64), *sizes]))
        return VtkCells(np.concatenate(types), offsets, np.concatenate(corners))

    def of_all(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        """(E,) int32: values of the elements of each kind, in the order of vtk_cells."""
        return np.concatenate([np.empty(0, np.int32), *(values[kind] for kind in self.elements)])

    def cell_data(self) -> dict[str, np.ndarray]:
        """(E,) int32 each, in the order of vtk_cells: `block`, an index of block_names, `property`, and where
        there are any `compartment`."""
        block = self.of_all(self.element_block)
        arrays = {"block": block, "property": self.block_property[block] if len(block) else block}
        if self.element_compartment is not None:
            arrays["compartment"] = self.of_all(self.element_compartment)
        return arrays

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The elements as a grid of PyVista: cell data as of cell_data, and of columns `layer` (0 the
        highest) and `column` (an index of plan.triangles); field data `block_names`.

        Raises UsageError where PyVista is missing.
        """
        data = self.cell_data()
        if self.plan is not None:
            data |= {"layer": self.of_all(self.plan.layer), "column": self.of_all(self.plan.column)}
        return volume_grid(self.points, self.vtk_cells(), data, {"block_names": self.block_names})


@dataclass(frozen=True, eq=False, repr=False)
class PolyhedralMesh(ShortRepr):
    """A mesh of polyhedra that share faces, in the layout of a model's arrays (docs/dev/geometry.md).

    points: (N, 3) float64. face_offsets: (F + 1,) int64; face_vertices: int32; face_cells: (F, 2) int32;
    face_surface: (F,) int32; cell_block: (C,) int32. Names and kinds as of VolumeMesh.
    cell_compartment: (C,) int32, 0 for all where none is given.
    """

    points: np.ndarray
    face_offsets: np.ndarray
    face_vertices: np.ndarray
    face_cells: np.ndarray
    face_surface: np.ndarray
    cell_block: np.ndarray
    block_names: list[str]
    block_property: np.ndarray
    surface_names: list[str]
    surface_kind: np.ndarray
    cell_compartment: np.ndarray | None = None

    def __post_init__(self) -> None:
        if self.cell_compartment is None:
            object.__setattr__(self, "cell_compartment", np.zeros(len(self.cell_block), np.int32))

    @property
    def cells(self) -> int:
        """The number of polyhedra."""
        return len(self.cell_block)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The polyhedra as a grid of PyVista: cell data `block` (an index of block_names), `property` and
        `compartment`; field data `block_names`.

        Raises UsageError where PyVista is missing.
        """
        assert self.cell_compartment is not None  # __post_init__ makes it
        block = self.cell_block
        data = {
            "block": block,
            "property": self.block_property[block] if len(block) else block,
            "compartment": self.cell_compartment,
        }
        return polyhedron_grid(
            self.points,
            self.face_offsets,
            self.face_vertices,
            self.face_cells,
            data,
            {"block_names": self.block_names},
        )

    @classmethod
    def of_model(cls, model: ModelData) -> PolyhedralMesh:
        """The exact cells of a model; arrays are shared, not copied."""
        return cls(
            model.vertices,
            model.face_offsets,
            model.face_vertices,
            model.face_cells,
            model.face_surface,
            model.cell_block,
            [block.name for block in model.blocks],
            np.array([block.property for block in model.blocks], np.int32),
            list(model.surface_names),
            model.surface_kind,
            model.cell_compartment,
        )


def model_arrays(model: ModelData) -> dict[str, np.ndarray]:
    """The arrays of a model's cells, as native functions take them."""
    return {
        name: getattr(model, name)
        for name in ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")
    }


_MOST_CHANGE = 0.1  # of a block's volume, without a warning


def changed_volumes(model: ModelData, volumes: np.ndarray, advice: str) -> list[BuildWarning]:
    """A warning for each block whose volume in a mesh, (B,), differs by more than a tenth."""
    return [
        BuildWarning(
            f"block '{block.name}' has a volume of {volume:.6g} in the mesh, and of {block.volume:.6g} in "
            f"the model; {advice}",
            "mesh_volume",
            model.rock_inputs[block.rock].rock.name,
        )
        for block, volume in zip(model.blocks, volumes, strict=True)
        if abs(volume - block.volume) > _MOST_CHANGE * block.volume
    ]


def changed_voids(
    model: ModelData, points: np.ndarray, triangles: np.ndarray, surface: np.ndarray
) -> list[BuildWarning]:
    """A warning for each void whose volume in a mesh differs by more than a tenth.

    triangles (T, 3), surface (T,): of the mesh, on the outside counter-clockwise seen from there."""
    warnings = []
    for body in model.structures.bodies:
        number = model.surface_names.index(body.name)
        faces = np.flatnonzero(model.face_surface == number)
        if not body.void or not len(faces):
            continue
        offsets, corners = model.face_corners(faces, np.zeros(len(faces), bool))
        exact, _ = native_module().triangulate_faces(model.vertices, offsets, corners)
        middle = float(model.vertices[corners, 2].mean())
        was = _enclosed(model.vertices, exact.reshape(-1, 3), middle)
        made = _enclosed(points, triangles[surface == number], middle)
        if abs(made - was) > _MOST_CHANGE * abs(was):
            what = f"void '{body.name}' has a volume of {made:.6g} in the mesh, and of {was:.6g} in the model"
            advice = "use a shorter edge length: one that is wider than the void closes it in places"
            warnings.append(BuildWarning(f"{what}; {advice}", "mesh_volume"))
    return warnings


def _enclosed(points: np.ndarray, triangles: np.ndarray, level: float) -> float:
    """The volume that triangles seen from outside the rock enclose. Vertical walls, in which a void may end,
    have no part of it: it is what lies between the triangles and a level."""
    a, b, c = (points[triangles[:, k]] - (0.0, 0.0, level) for k in range(3))
    u, v = (b - a)[:, :2], (c - a)[:, :2]
    plan = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    return float(-(plan * (a[:, 2] + b[:, 2] + c[:, 2]) / 3).sum())
