# SPDX-License-Identifier: GPL-3.0-or-later
"""The built model: blocks of polyhedral cells that share faces, as flat arrays (docs/dev/geometry.md)."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from . import cutting
from .assembly import build_stage
from .blocks import Block, BlockBoundary
from .build_warning import BuildWarning
from .contours import contours
from .erosion import Erosion, eroded
from .errors import UsageError
from .exporters import save_model
from .exporters.surfaces import save_surfaces
from .geological_map import geological_map
from .heights import Interpolation
from .model_boreholes import borehole
from .project import Project
from .rock_input import RockInput
from .simulation import cleaned_cells, simulation_mesh
from .structures.parts import Structures
from .surface_set import triangle_sheets, vertex_attributes
from .validation import PLACES_OF_CHECK, ValidationReport, validate
from .work import Cancel, Progress, native_module

_GOLDEN = 0.618034  # of the circle of hues: no two of the first dozens come near each other


@dataclass(eq=False)
class Model:
    """A built model. The arrays are those of docs/dev/geometry.md, under the same names.

    `cell_kind` is "columns" or "blocks". `surface_names` go with the global indices of the surfaces.
    `project` holds the arrays that the model was built from, so that nothing is read again.
    `rock_inputs` are what the stack builder took, by rock mass. `timings` are seconds by phase.
    `is_cut`: it is a half of another model (docs/dev/geometry.md, "Cutting").
    """

    vertices: np.ndarray
    face_offsets: np.ndarray
    face_vertices: np.ndarray
    face_cells: np.ndarray
    face_surface: np.ndarray
    cell_block: np.ndarray
    cell_kind: str
    blocks: list[Block]
    surface_vertices: np.ndarray
    surface_triangles: np.ndarray
    surface_vertex_offsets: np.ndarray
    surface_triangle_offsets: np.ndarray
    surface_names: list[str]
    project: Project
    rock_inputs: list[RockInput] = field(default_factory=list, repr=False)
    warnings: list[BuildWarning] = field(default_factory=list)
    timings: dict[str, float] = field(default_factory=dict)
    threads: int = 0
    is_cut: bool = False
    surface_kind: np.ndarray | None = None
    cell_compartment: np.ndarray | None = None
    compartment_names: list[str] = field(default_factory=list)
    compartment_sides: np.ndarray | None = field(default=None, repr=False)
    structures: Structures | None = field(default=None, repr=False)

    def __post_init__(self):
        if self.surface_kind is None:
            self.surface_kind = np.zeros(len(self.surface_names), np.int32)
        if self.cell_compartment is None:
            self.cell_compartment = np.zeros(len(self.cell_block), np.int32)

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

    def surface_attributes(self, number: int) -> dict[str, np.ndarray]:
        """What is known of the vertices of one input surface, by its global index, (V,) float64 each:
        `height`; `variance` of the error of an interpolated height, squared model units; `distance` in plan
        to the nearest point that it was interpolated from. NaN where there is no such thing, as for all
        vertices of a ready mesh."""
        return vertex_attributes(self.rock_inputs, number, self.surface(number)[0])

    def surface(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (V, 3) and triangles (T, 3) of one input surface by its global index."""
        v, t = self.surface_vertex_offsets, self.surface_triangle_offsets
        return (
            self.surface_vertices[v[number] : v[number + 1]],
            self.surface_triangles[t[number] : t[number + 1]],
        )

    @property
    def surface_triangle_sheet(self) -> np.ndarray:
        """(Ts,) int32: of each of `surface_triangles` the sheet of its surface that it is of, from 0."""
        structures = np.flatnonzero(self.surface_kind)
        count = sum(len(self.surface(number)[1]) for number in structures)
        return np.append(triangle_sheets(self.rock_inputs), np.zeros(count, np.int32))

    def sheet_triangles(self, number: int) -> list[np.ndarray]:
        """The triangles (T, 3) of each sheet of a surface, by its global index; a surface that no fault
        displaces has one."""
        triangles = self.surface(number)[1]
        begin, end = self.surface_triangle_offsets[number : number + 2]
        sheet = self.surface_triangle_sheet[begin:end]
        return [np.ascontiguousarray(triangles[sheet == each]) for each in np.unique(sheet)]

    def save(
        self,
        path: str | Path,
        cell_size: float | Sequence[float] | None = None,
        contour_interval: float | None = None,
        tolerance: float | None = None,
    ) -> None:
        """Writes the model to a file or folder, by its ending: those of exporters.FORMATS. It appears whole
        or not at all.

        cell_size: of regular grids (.csv, .vti, .tif, .asc), one number, two (in plan, in height) or three;
        None: a hundredth of the longest side. contour_interval: of maps (.gpkg, .geojson); None: one of about
        fifteen levels. tolerance: of formats with the model's cells (.vtu, .foam, .exo, .disu): they are
        cleaned as cleaned_cells does; None: the exact cells. Raises UsageError for an ending that is not
        known, OutputFailed where it cannot be written.
        """
        save_model(self, path, cell_size=cell_size, contour_interval=contour_interval, tolerance=tolerance)

    def save_surfaces(self, path: str | Path) -> None:
        """Writes the surfaces, faults and bodies as they were used, by the file's ending (.obj, .ply, .stl,
        .glb, .dxf, .ts with a part for each, .npz, .vtu). It appears whole or not at all.

        Raises UsageError for an ending that is not known, OutputFailed where it cannot be written.
        """
        save_surfaces(self, path)

    def stage(self, m: int, progress: Progress | None = None, cancel: Cancel | None = None) -> Model:
        """The model as it was just after surface m (from 0) of each rock mass. Raises UsageError where no
        rock mass has a surface m, or the model is a half: cut the stage instead. It is built anew from the
        surfaces up to m."""
        if self.is_cut:
            raise UsageError("a cut model has no stages: take the stage of the whole model, then cut that")
        return build_stage(self, m, progress, cancel)

    def eroded(self, progress: Progress | None = None, cancel: Cancel | None = None) -> Erosion:
        """What each surface removed of each block when it came: (S, B) volumes, and their sums.

        The volume of a block just before the surface, less that just after. For each surface that cuts the
        model is built once more up to the surface before, with whole blocks as cells; what rounding alone
        makes is given as 0. Raises UsageError where the model is a half, Cancelled.
        """
        if self.is_cut:
            raise UsageError("a cut model has no erosion: ask the whole model")
        return eroded(self, self.threads, progress, cancel)

    def validate(
        self,
        places: int = PLACES_OF_CHECK,
        seed: int = 1,
        threads: int = 0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> ValidationReport:
        """Tests the model as docs/dev/geometry.md says: every cell, face and vertex of it; and whether at
        about `places` plan positions it is what the closed form says. 0 places, or a half: only the first.

        seed draws the places. threads: 0 for all that there are; the findings are the same for any number.
        A model that fails is no error here: the report says what is wrong and where.
        Raises UsageError, Cancelled.
        """
        return validate(self, places, seed, threads, progress, cancel)

    simulation_mesh = simulation_mesh
    cleaned_cells = cleaned_cells
    geological_map = geological_map
    contours = contours
    cut_by_plane = cutting.cut_by_plane
    cut_by_surface = cutting.cut_by_surface
    cut_by_block = cutting.cut_by_block
    section = cutting.section
    fence = cutting.fence
    borehole = borehole

    @cached_property
    def face_blocks(self) -> np.ndarray:
        """(F, 2) int32: the block on each side of a face; -1 outside."""
        padded = np.append(self.cell_block, np.int32(-1))
        return padded[self.face_cells]

    def block_boundary(self, block: int) -> BlockBoundary:
        """The closed boundary of one block, all its connected parts together."""
        first, second = self.face_blocks[:, 0] == block, self.face_blocks[:, 1] == block
        faces = np.flatnonzero(first != second)
        turned = second[faces]
        offsets, corners = self.face_corners(faces, turned)
        used = np.zeros(len(self.vertices), bool)
        used[corners] = True
        number = np.cumsum(used, dtype=np.int64) - 1
        return BlockBoundary(
            np.ascontiguousarray(self.vertices[used]),
            offsets,
            number[corners].astype(np.int32),
            self.face_surface[faces],
            faces,
        )

    def face_corners(self, faces: np.ndarray, turned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The corners of some faces, one face after the other.

        faces: (N,) numbers of faces. turned: (N,) bool, those that are taken the other way round.
        Returns offsets (N + 1,) int64 and vertex numbers (sum,) as `face_vertices`.
        """
        begin, end = self.face_offsets[faces], self.face_offsets[1:][faces]
        offsets = np.zeros(len(faces) + 1, np.int64)
        np.cumsum(end - begin, out=offsets[1:])
        step = np.where(turned, -1, 1)
        start = np.where(turned, end - 1, begin) - step * offsets[:-1]
        size = np.diff(offsets)
        at = np.repeat(start, size) + np.repeat(step, size) * np.arange(offsets[-1])
        return offsets, self.face_vertices[at]

    @cached_property
    def cell_volumes(self) -> np.ndarray:
        """(C,) float64: the volume of each cell, model units cubed."""
        return native_module().cell_volumes(
            self.vertices,
            self.face_offsets,
            self.face_vertices,
            self.face_cells,
            len(self.cell_block),
            self.threads,
        )

    @cached_property
    def component_volumes(self) -> list[np.ndarray]:
        """For each block the volumes of its connected parts, largest first."""
        volume = np.bincount(self.cell_component, self.cell_volumes, len(self.cell_block))
        roots = np.flatnonzero(self.cell_component == np.arange(len(self.cell_block)))
        order = roots[np.lexsort((roots, -volume[roots], self.cell_block[roots]))]
        counts = np.bincount(self.cell_block[order], minlength=len(self.blocks))
        return np.split(volume[order], np.cumsum(counts)[:-1]) if len(counts) else []

    @cached_property
    def cell_component(self) -> np.ndarray:
        """(C,) int32: the least cell of the connected part of a block that each cell belongs to."""
        return native_module().cell_components(self.face_cells, self.cell_block)
