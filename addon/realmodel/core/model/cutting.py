# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished model cut: halves that are models again, and sections."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import InputRefused, UsageError, number_list, place_text
from ..base.named import keyword_only, number_of
from ..base.triangles import checked_triangulation
from ..base.work import Cancel, NativeError, Progress, Work, native_module, refused_as, run
from ..cells.blocks import named_blocks
from ..cells.cell_complex import CellComplex
from ..cells.model_data import ModelData, SomeModel
from ..drawing.svg import write_svg
from ..exporters import SECTION
from ..notebook import ShortRepr
from ..results.automatic_library import model_with_library
from ..results.sections.section_data import FenceData, SectionData, traces_on_fence, traces_on_plane
from ..results.sections.section_drawing import draw_section
from ..results.sections.section_holes import hole_lines, hole_places, hole_values, line_through
from ..settings.method_options import check_threads


class Section(SectionData):
    """Convex polygons on a cutter."""

    def save(
        self,
        path: str | Path,
        exaggeration: float = 1.0,
        hole_width: float = 0.0,
        hole_column: str | None = None,
    ) -> None:
        """Writes the polygons, with block and property, to a file in the format of its extension, or a
        drawing of them to a .svg, .pdf, .dxf or .png. exaggeration: of heights in drawings. hole_width:
        drawings have the boreholes within this distance of the section, model units. hole_column: beside
        these as a curve, a column of `hole_values`; its unit may be left out. The file appears whole or not
        at all. Raises UsageError, OutputFailed."""
        of_holes: dict[str, Any] = {"hole_width": hole_width, "hole_column": hole_column}
        SECTION.save(self, path, exaggeration=exaggeration, **of_holes)

    def _repr_svg_(self) -> str | None:
        """The drawing that `save` writes; None where there is none, as of the section by a surface."""
        if not len(self) or not (self.plane or isinstance(self, FenceData)):
            return None
        file = BytesIO()
        write_svg(draw_section(self), file)
        return file.getvalue().decode()


class Fence(Section, FenceData):
    """Vertical sections along a polyline in plan."""


_CUT_SHARE = 0.97


@dataclass(eq=False, repr=False)
class Cut(ShortRepr, Generic[SomeModel]):
    """Both halves of a model, each a model with the same blocks, surfaces and project.

    above: the half to which the plane's normal points, above the surface, or outside of a closed surface or
    block. outside, inside: other names of above and below. The caps have face_surface -3 and are the polygons
    of `section`. above_cells, below_cells: (C,) int32, for each cell of a half the cell of the original model
    that it is or was part of.
    """

    above: SomeModel
    below: SomeModel
    section: Section
    above_cells: np.ndarray
    below_cells: np.ndarray

    @property
    def inside(self) -> SomeModel:
        """The half inside a closed surface or block: `below`."""
        return self.below

    @property
    def outside(self) -> SomeModel:
        """The half outside a closed surface or block: `above`."""
        return self.above


@keyword_only
def cut_by_plane(
    model: SomeModel,
    point: Sequence[float] | np.ndarray,
    normal: Sequence[float] | np.ndarray,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Cut[SomeModel]:
    """Cuts a model by a plane. Returns both halves, above (where the normal points) and below, and the
    section.

    point, normal: three numbers each; the normal may have any length. The model itself does not change.
    Raises UsageError for an invalid plane, BuildFailed, Cancelled.

    >>> cut = model.cut_by_plane(point=(2, 2, 2), normal=(1, 0, 0))
    >>> cut.above.volume, cut.below.volume, cut.section.area
    (32.0, 16.0, 12.0)
    """
    point, normal = _plane(point, normal)
    return _cut(model, lambda native: (native.cut_by_plane, point, normal), threads, progress, cancel)


@keyword_only
def cut_by_surface(
    model: SomeModel,
    vertices: ArrayLike,
    triangles: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Cut[SomeModel]:
    """Cuts a model by a triangulated surface in any position: above and below it; outside and inside of a
    closed one.

    vertices: (V, 3) float64; triangles: (T, 3) whole numbers, of any orientation.
    Raises InputRefused for a surface that does not separate the model, branches, has no two sides or crosses
    itself; BuildFailed, Cancelled.

    >>> sheet = [[-1, -1, 2], [5, -1, 2], [5, 5, 2], [-1, 5, 2]], [[0, 1, 2], [0, 2, 3]]
    >>> cut = model.cut_by_surface(*sheet)
    >>> round(cut.below.volume, 9)
    30.0
    """
    vertices, triangles = checked_triangulation(vertices, triangles)
    return _cut(model, lambda native: (native.cut_by_surface, vertices, triangles), threads, progress, cancel)


@keyword_only
def cut_by_block(
    model: SomeModel,
    other: ModelData,
    block: int | str,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Cut[SomeModel]:
    """Cuts a model by a block (number or name) of the `other` model, which may be the same one: inside and
    outside.

    Raises UsageError for a block that does not exist, InputRefused, BuildFailed, Cancelled.
    """
    number = number_of(block, other.blocks.names, "block")
    return _cut(
        model,
        lambda native: (native.cut_by_block, other.native(), number),
        threads,
        progress,
        cancel,
    )


def _cut(
    model: SomeModel, call: Callable, threads: int, progress: Progress | None, cancel: Cancel | None
) -> Cut[SomeModel]:
    """The cut made by call(native), a native function and its arguments after the model."""
    threads = check_threads(threads)
    native = native_module()

    def task(work: Work) -> Cut[SomeModel]:
        began = time.perf_counter()
        function, *cutter = call(native)
        with work.phase(0.0, _CUT_SHARE, "cutting"), refused_as(_refused):
            halves = work.native(function, model.native(), *cutter)
        return _assembled(work, model, halves, began)

    return run(task, progress, cancel, threads=threads)


_ADVICE = {
    "ends_inside": "extend it beyond the model, or close it",
    "branching": "remove the triangles where it branches",
    "one_sided": "remove triangles until it has one upper and one lower side",
    "two_sides": "cut by each part in turn",
    "no_block": "choose a block that has cells",
    "open_cell": "move the surface that cuts a little, or repair the model",
}


def _refused(error: NativeError) -> InputRefused:
    place = tuple(error.place) if error.place is not None else None
    near = f" near {place_text(place)}" if place else ""
    triangles = tuple(int(i) for i in error.items) if error.kind in ("branching", "one_sided") else ()
    named = f": triangles {number_list(triangles)}" if triangles else ""
    return InputRefused(
        f"{error}{named}{near}",
        item="the cut",
        advice=_ADVICE.get(error.kind),
        triangles=triangles,
        place=place,
    )


@keyword_only
def section(
    model: ModelData,
    point: Sequence[float] | np.ndarray,
    normal: Sequence[float] | np.ndarray,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Section:
    """The section by a plane alone, in a fraction of the time of cut_by_plane.

    point, normal: as of cut_by_plane; in drawings the plane is seen from where the normal points. Raises
    UsageError for an invalid plane, BuildFailed, Cancelled.

    >>> section = model.section(point=(2, 2, 2), normal=(0, -1, 0))
    >>> section
    Section of 'three layers': 6 polygons of 3 blocks, 12 m²
    >>> section.area_by_block()
    array([7.5, 2.5, 2. ])
    """
    point, normal = _plane(point, normal)
    threads = check_threads(threads)
    native_module()

    def task(work: Work) -> Section:
        with work.phase(0.0, 1.0, "cutting"):
            arrays = work.native(
                native_module().section_by_plane,
                model.native(),
                point,
                normal,
            )
        return Section(
            **section_arrays(model, arrays),
            plane=(point, normal),
            faults=traces_on_plane(model, point, normal),
            holes=hole_lines(model),
            hole_values=hole_values(model.project),
        )

    return run(task, progress, cancel, threads=threads)


_AXES = dict(zip(("x", "y", "z", "-x", "-y", "-z"), np.vstack([np.eye(3), -np.eye(3)]).tolist(), strict=True))


def slice_model(
    model: ModelData,
    normal: str | Sequence[float] | np.ndarray = "x",
    origin: Sequence[float] | np.ndarray | None = None,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Section:
    """`section` with the arguments of PyVista's slice. normal: an axis, "x" or "-x", or three numbers.
    origin: a point of the plane; None: the middle of the model.

    >>> model.slice("y").area
    12.0
    """
    point, normal = _axis_plane(model, normal, origin)
    return section(model, point, normal, threads=threads, progress=progress, cancel=cancel)


def clip(
    model: SomeModel,
    normal: str | Sequence[float] | np.ndarray = "x",
    origin: Sequence[float] | np.ndarray | None = None,
    *,
    invert: bool = True,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> SomeModel:
    """One half of cut_by_plane, with the arguments of PyVista's clip: the one away from the normal, or with
    invert=False that to which it points. normal, origin: as of `slice`.

    >>> model.clip("x").volume, model.clip("x", invert=False).volume
    (16.0, 32.0)
    """
    point, normal = _axis_plane(model, normal, origin)
    cut = cut_by_plane(model, point, normal, threads=threads, progress=progress, cancel=cancel)
    return cut.below if invert else cut.above


def _axis_plane(
    model: ModelData, normal: str | ArrayLike, origin: ArrayLike | None
) -> tuple[np.ndarray, np.ndarray]:
    if isinstance(normal, str):
        if normal not in _AXES:
            raise UsageError(f"normal must be one of {', '.join(_AXES)}, or three numbers, not {normal!r}")
        normal = _AXES[normal]
    if origin is None:
        places = model.vertices if len(model.vertices) else np.zeros((1, 3))
        origin = (places.min(axis=0) + places.max(axis=0)) / 2
    return np.asarray(origin), np.asarray(normal)


@keyword_only
def fence(
    model: ModelData,
    polyline: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Fence:
    """Vertical sections along a polyline in plan, (N, 2), each between its two ends.

    Raises UsageError for an invalid polyline, BuildFailed, Cancelled.

    >>> fence = model.fence([[0, 2], [2, 2], [2, 4]])
    >>> fence.length, fence.area
    (4.0, 10.0)
    """
    try:
        polyline = np.ascontiguousarray(polyline, np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError("polyline must be an array (N, 2) of numbers") from error
    if polyline.ndim != 2 or polyline.shape[1] != 2 or len(polyline) < 2:
        raise UsageError(f"polyline must be an array (N, 2) with N > 1, not {polyline.shape}")
    if not np.isfinite(polyline).all():
        raise UsageError("polyline must be finite")
    if not np.diff(polyline, axis=0).any(axis=1).all():
        raise UsageError("polyline has two consecutive points that are equal; remove one")
    threads = check_threads(threads)
    native_module()

    def task(work: Work) -> Fence:
        panels = []
        for number, (start, end) in enumerate(itertools.pairwise(polyline)):
            with work.phase(number / (len(polyline) - 1), (number + 1) / (len(polyline) - 1), "cutting"):
                panels.append(
                    work.native(
                        native_module().fence_panel,
                        model.native(),
                        tuple(start),
                        tuple(end),
                    )
                )
        numbers = [np.full(len(panel["cells"]), k, np.int32) for k, panel in enumerate(panels)]
        return Fence(
            **section_arrays(model, _joined(panels)),
            polyline=polyline,
            panel=np.concatenate(numbers),
            faults=traces_on_fence(model, polyline),
            holes=hole_lines(model),
            hole_values=hole_values(model.project),
        )

    return run(task, progress, cancel, threads=threads)


@keyword_only
def fence_through_holes(
    model: ModelData,
    holes: Sequence[str],
    extend: float | None = None,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> Fence:
    """Vertical sections through boreholes of the project, in the order of their names.

    holes: names. extend: how far the line continues at both ends, model units; None: a twentieth of its
    length. Raises InputRefused for an unknown hole, or if all are at one place, UsageError, BuildFailed,
    Cancelled.
    """
    line = line_through(hole_places(model.project), holes, extend)
    return fence(model, line, threads=threads, progress=progress, cancel=cancel)


def _joined(panels: list[dict]) -> dict:
    """Several sections joined to one."""
    vertices = np.cumsum([0, *(len(panel["vertices"]) for panel in panels)])
    corners = np.cumsum([0, *(len(panel["polygon_vertices"]) for panel in panels)])
    polygons = [p["polygon_vertices"] + v for p, v in zip(panels, vertices, strict=False)]
    offsets = [p["offsets"][:-1] + c for p, c in zip(panels, corners, strict=False)]
    return {
        "vertices": np.concatenate([panel["vertices"] for panel in panels]),
        "offsets": np.concatenate([*offsets, corners[-1:]]).astype(np.int64),
        "polygon_vertices": np.concatenate(polygons).astype(np.int32),
        "cells": np.concatenate([panel["cells"] for panel in panels]),
    }


def _plane(
    point: Sequence[float] | np.ndarray, normal: Sequence[float] | np.ndarray
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    vectors = []
    for name, value in (("point", point), ("normal", normal)):
        try:
            numbers = np.asarray(value, np.float64)
        except (TypeError, ValueError) as error:
            raise UsageError(f"{name} must be three numbers") from error
        if numbers.shape != (3,) or not np.isfinite(numbers).all():
            raise UsageError(f"{name} must be three finite numbers, not {value!r}")
        vectors.append(tuple(numbers.tolist()))
    if not any(vectors[1]):
        raise UsageError("normal must not be zero: it gives the orientation of the plane and its upper side")
    return vectors[0], vectors[1]


def section_arrays(model: ModelData, arrays: dict) -> dict:
    """The arrays of a Section. arrays: vertices, offsets, polygon_vertices, and cells below and above."""
    cells = arrays["cells"]
    blocks = np.append(model.cell_block, np.int32(-1))[cells].astype(np.int32, copy=False)
    block = np.where(blocks[:, 0] >= 0, blocks[:, 0], blocks[:, 1])
    compartment = np.append(model.cell_compartment, np.int32(-1))[cells].astype(np.int32, copy=False)
    library_ids = np.array([entry.property for entry in model.blocks], np.int32)
    return {
        "vertices": arrays["vertices"],
        "offsets": arrays["offsets"],
        "polygon_vertices": arrays["polygon_vertices"],
        "cells": cells,
        "blocks": blocks,
        "block": block,
        "property": library_ids[block] if len(block) else np.empty(0, np.int32),
        "compartment": np.where(blocks[:, 0] >= 0, compartment[:, 0], compartment[:, 1]),
        "block_names": [entry.name for entry in model.blocks],
        "compartment_names": list(model.compartment_names),
        "block_colors": model_with_library(model).block_colors,
        "name": model.project.name,
        "unit": model.project.units,
    }


def _assembled(work: Work, model: SomeModel, halves: dict, began: float) -> Cut[SomeModel]:
    with work.phase(_CUT_SHARE, 1.0, "assembling the halves"):
        plane_section = Section(**section_arrays(model, halves["section"]))
        above = _half(work, model, halves["above"], halves["above_touches"])
        work.step(0.5)
        below = _half(work, model, halves["below"], halves["below_touches"])
    for half in (above, below):
        half.timings["cut"] = time.perf_counter() - began
    return Cut(above, below, plane_section, halves["above"]["cells"], halves["below"]["cells"])


def _half(work: Work, model: SomeModel, arrays: dict, touches: bool) -> SomeModel:
    cell_complex = CellComplex.of(arrays, "blocks" if touches else model.cell_kind)
    cell_complex.find_components(work)
    cells, components = cell_complex.count_blocks(len(model.blocks))
    blocks = [
        replace(
            block,
            volume=float(arrays["volumes"][number]),
            cells=int(cells[number]),
            components=int(components[number]),
        )
        for number, block in enumerate(model.blocks)
    ]
    return replace(
        model,
        complex=cell_complex,
        blocks=named_blocks(blocks),
        is_cut=True,
        warnings=list(model.warnings),
        timings={},
        cell_compartment=model.cell_compartment[arrays["cells"]],
        compartment_names=model.compartment_names,
    )
