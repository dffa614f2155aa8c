# SPDX-License-Identifier: GPL-3.0-or-later
"""What Python and notebooks show of a model, and its meshes for PyVista."""

from __future__ import annotations

import base64
import io
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.units import number_text
from ..cells.model_data import ModelData, UsedSurfaces
from ..drawing.drawing import BLACK, Drawing
from ..drawing.png import write_png
from ..exporters.page import page_of
from ..notebook import blocks_of_meshes, polygon_mesh, with_data
from ..results.automatic_library import model_with_library
from ..results.sections.section_data import SectionData, rgb_bytes
from ..results.sections.section_drawing import block_outlines, flat_of, flattened
from ..simulation import PolyhedralMesh
from .cutting import section

if TYPE_CHECKING:
    import pyvista

_PICTURE = (240.0, 150.0)  # points, at most
_MOST_EXAGGERATION = 20.0
_LARGEST_PAGE = 2_000_000  # characters
_MOST_FACES = 100_000  # pages of more are larger
_FRAME = "width:100%;height:480px;border:0"
_BOX = "display:inline-block;width:1em;height:1em"
_NUMBERS = "text-align:right;font-variant-numeric:tabular-nums"


def summary(model: ModelData) -> str:
    """Three lines: blocks and volume; what it is made of; where it is."""
    unit = model.project.units
    kinds = np.bincount(model.surface_kind, minlength=3).tolist()
    parts = [
        _count(len(model.cell_block), f"cell ({model.cell_kind})", f"cells ({model.cell_kind})"),
        _count(len(model.face_cells), "face"),
        _count(len(model.vertices), "vertex", "vertices"),
        _count(kinds[0], "surface"),
        *(_count(kinds[1], "fault") for _ in range(kinds[1] > 0)),
        *(_count(kinds[2], "body", "bodies") for _ in range(kinds[2] > 0)),
    ]
    where = "no cells"
    if len(model.vertices):
        low, high = model.vertices.min(axis=0).tolist(), model.vertices.max(axis=0).tolist()
        where = ", ".join(f"{axis} {a:.9g} to {b:.9g}" for axis, a, b in zip("xyz", low, high, strict=True))
    half = " (half of a cut)" if model.is_cut else ""
    return "\n".join(
        [
            f"Model {model.project.name!r}{half}: {_count(len(model.blocks), 'block')}, "
            f"{number_text(model.volume)} {unit}³",
            f"  {', '.join(parts)}",
            f"  {where} {unit}; {_count(len(model.warnings), 'warning')}",
        ]
    )


def _count(number: int, one: str, several: str = "") -> str:
    return f"{number:,} {one if number == 1 else several or f'{one}s'}"


def html(model: ModelData) -> str:
    """The summary, a picture and the table of blocks, youngest first, as HTML."""
    model = model_with_library(model)
    unit, total = escape(model.project.units), model.volume
    colors = rgb_bytes(model.block_colors).tolist()
    heads = ("", "block", "rock", f"volume ({unit}³)", "share", "parts", "cells")
    rows = [f"<tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr>"]
    for number, block in reversed(list(enumerate(model.blocks))):
        box = f"{_BOX};background:#{bytes(colors[number]).hex()}"
        texts = [escape(block.name), escape(model.project.rocks[block.rock].name)]
        share = f"{100 * block.volume / total:.1f} %" if total else ""
        numbers = [number_text(block.volume), share, f"{block.components:,}", f"{block.cells:,}"]
        rows.append(
            f'<tr><td><span style="{box}"></span></td>'
            + "".join(f'<td style="text-align:left">{text}</td>' for text in texts)
            + "".join(f'<td style="{_NUMBERS}">{text}</td>' for text in numbers)
            + "</tr>"
        )
    picture = _picture(model)
    return f"<div><pre>{escape(summary(model))}</pre>{picture}<table>{''.join(rows)}</table></div>"


def _picture(model: ModelData) -> str:
    """The page of the model in a frame; of a large one a vertical section through the middle, along the
    longer side, as an image."""
    if not len(model.vertices):
        return ""
    has_page = model.lacks_project is None and len(model.face_cells) <= _MOST_FACES
    page = page_of(model) if has_page else ""
    if 0 < len(page) <= _LARGEST_PAGE:
        return (
            f'<iframe srcdoc="{escape(page)}" title="{escape(model.project.name)}" style="{_FRAME}"></iframe>'
        )
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    normal = (0.0, -1.0, 0.0) if high[0] - low[0] >= high[1] - low[1] else (-1.0, 0.0, 0.0)
    cut = section(model, (low + high) / 2, normal, threads=model.threads)
    if not len(cut):
        return ""
    drawing, exaggeration = _drawn(cut)
    file = io.BytesIO()
    write_png(drawing, file)
    data = base64.b64encode(file.getvalue()).decode()
    axis, at = ("y", low[1] + high[1]) if normal[1] else ("x", low[0] + high[0])
    title = f"section at {axis} = {at / 2:.9g}, vertical exaggeration {exaggeration:.3g}"
    return (
        f'<img src="data:image/png;base64,{data}" alt="{title}" title="{title}" '
        f'style="width:{drawing.width:.0f}pt">'
    )


def _drawn(cut: SectionData) -> tuple[Drawing, float]:
    """The blocks and faults of a section alone, and the exaggeration at which it fits the picture."""
    flat = flattened(cut)
    low, extent = flat.min(axis=0), np.ptp(flat, axis=0)
    scale = _PICTURE[0] / max(extent[0], 1e-300)
    exaggeration = min(max(_PICTURE[1] / max(extent[1] * scale, 1e-300) / 2, 1.0), _MOST_EXAGGERATION)
    scales = np.array([scale, scale * exaggeration])
    scales *= min(1.0, _PICTURE[1] / max(extent[1] * scales[1], 1e-300))
    drawing = Drawing(float(extent[0] * scales[0]) + 2, float(extent[1] * scales[1]) + 2)
    for block in np.unique(cut.block).tolist():
        rings = [(ring - low) * scales + 1 for ring in block_outlines(cut, flat, block)]
        drawing.polygon(rings, tuple(cut.block_colors[block]), BLACK, 0.35)
    for trace in cut.faults:
        for line in flat_of(cut, trace.ends.reshape(-1, 3)).reshape(-1, 2, 2):
            drawing.line((line - low) * scales + 1, BLACK, 1.0)
    return drawing, float(scales[1] / scales[0])


def to_pyvista(model: ModelData) -> pyvista.UnstructuredGrid:
    """The cells as a grid of polyhedra of PyVista, which share their faces: no gap, no overlap.

    Cell data: `block` (the number of its block), `property` (library id, 0: none), `compartment`, `volume`
    (exact; PyVista's own of cells that are not convex are not), `color` (red, green, blue, uint8: plot(
    scalars="color", rgb=True)). Field data: `block_names`. Raises UsageError where PyVista is missing.

    >>> grid = model.to_pyvista()
    >>> grid.n_cells, float(grid["volume"].sum())
    (12, 48.0)
    >>> grid.extract_surface(algorithm=None).n_open_edges
    0
    """
    grid = PolyhedralMesh.of_model(model).to_pyvista()
    colors = rgb_bytes(model_with_library(model).block_colors)[model.cell_block]
    return with_data(grid, {"volume": model.cell_volumes, "color": colors})


def plot(model: ModelData, **options: Any) -> Any:
    """Shows the blocks in their colors with PyVista. options: those of pyvista.plot, such as `screenshot` or
    `off_screen`. Returns what it returns. Raises UsageError where PyVista is missing."""
    return to_pyvista(model).plot(**{"scalars": "color", "rgb": True, **options})


def surfaces_to_pyvista(model: UsedSurfaces) -> pyvista.MultiBlock:
    """The surfaces, faults and bodies as they were used, unclipped, each as a mesh of triangles of PyVista,
    by their names.

    Point data: `height`, `variance`, `distance`, as of surface_attributes. Raises UsageError where PyVista is
    missing.

    >>> model.surfaces_to_pyvista()["ground"].bounds[4:]
    (1.0, 5.0)
    """
    meshes = []
    for number, name in enumerate(model.surface_names):
        vertices, triangles = model.surface(number)
        mesh = polygon_mesh(vertices, 3 * np.arange(len(triangles) + 1), triangles.ravel(), {})
        for attribute, values in model.surface_attributes(number).items():
            mesh.point_data[attribute] = values
        meshes.append((name, mesh))
    return blocks_of_meshes(meshes)
