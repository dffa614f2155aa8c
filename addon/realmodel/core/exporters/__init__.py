# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a model, and what is made of it, is written to, by their ending.

Input: `ModelData`, a mesh for simulation, surfaces, a section or a hole, and a path. Output: a file that
appears whole or not at all, with the same bytes for the same content.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import Outputs, writable_folder, writable_target
from ..base.errors import UsageError
from ..base.formats import Format, by_ending
from ..base.packages import require_extra
from ..base.text import Step, no_step
from ..base.units import MODEL_UNIT
from ..cells.model_data import ModelData
from ..drawing import Drawing
from ..results.corner_point import CornerPointGrid, corner_point_grid
from ..results.faults.juxtaposition import JuxtapositionData
from ..results.faults.juxtaposition_drawing import draw_juxtaposition
from ..results.orientations.stereonet import EQUAL_AREA, StereonetData, draw_stereonet
from ..results.samples import Probabilities, SectionSamples
from ..results.sections.section_data import SectionData
from ..results.sections.section_drawing import draw_section
from ..simulation import PolyhedralMesh, VolumeMesh
from ..simulation.cleaned_cells import cleaned_cells
from ..simulation.elements import ElementFaces
from ..simulation.patches import solver_names
from .formats import CORNER_POINT, FORMATS
from .section_files import draw_probabilities
from .shapes.shape_parts import Part, model_parts, section_parts, surface_parts

_EACH_PART = "{block}"  # in a file's name: a file for each


def _as_it_is(content: Any, _options: dict) -> Any:
    return content


def _polyhedra(model: ModelData, options: dict) -> PolyhedralMesh:
    """The cells of a model, cleaned where there is a tolerance; `cells` are the cleaned ones."""
    tolerance, cells = options.pop("tolerance", None), options.pop("cells", None)
    if cells is not None:
        return cells
    if tolerance is not None:
        return cleaned_cells(model, tolerance, threads=model.threads)
    return PolyhedralMesh.of_model(model)


def _corner_point(model: ModelData, options: dict) -> CornerPointGrid:
    """The corner-point grid of a model; `grid` is one that is made already."""
    size, layers, azimuth, grid = (options.pop(name, None) for name in CORNER_POINT)
    return corner_point_grid(model, size, layers or 1, azimuth or 0.0) if grid is None else grid


def _with_grid(model: ModelData, options: dict) -> tuple[ModelData, CornerPointGrid | None]:
    """A model, and its corner-point grid where the size of cells is given."""
    of_grid = {name: options.pop(name, None) for name in CORNER_POINT}
    return model, None if of_grid["cell_size"] is None else _corner_point(model, of_grid)


def _blocks(model: ModelData, options: dict) -> list[Part]:
    """The blocks of a model, their coordinates from a place."""
    parts, origin = model_parts(model), options.pop("origin", None)
    return parts if origin is None else [replace(p, vertices=p.vertices - np.array(origin)) for p in parts]


def _drawn(section: SectionData, options: dict) -> Drawing:
    names = ("exaggeration", "hole_width", "hole_column")
    return draw_section(section, **{name: options.pop(name) for name in names if name in options})


def _drawn_juxtaposition(sides: JuxtapositionData, options: dict) -> Drawing:
    return draw_juxtaposition(sides, options.pop("exaggeration", 1.0))


def _drawn_net(dips: StereonetData, options: dict) -> Drawing:
    return draw_stereonet(dips, options.pop("net", EQUAL_AREA))


def _drawn_samples(asked: tuple[SectionSamples, Probabilities], options: dict) -> Drawing:
    return draw_probabilities(*asked, options.pop("exaggeration", 1.0))


@dataclass(frozen=True)
class Exporter:
    """Writes what users export, such as models.

    refusal: a sentence with {} for an ending that none of its formats has. views: what formats take of it,
    the preferred one first, with the function (content, options) that makes it, which removes the options
    that it uses. unit(content): of its lengths, where it knows that.
    """

    refusal: str
    views: dict[str, Callable[[Any, dict], Any]]
    unit: Callable[[Any], str] | None = None

    def formats(self) -> list[Format]:
        """Its formats, one of each ending, in the order of the table."""
        chosen: dict[str, Format] = {}
        for view in self.views:
            for file_format in FORMATS:
                if view in file_format.takes:
                    chosen.setdefault(file_format.ending, file_format)
        return [file_format for file_format in FORMATS if file_format is chosen.get(file_format.ending)]

    def endings(self, option: str) -> list[str]:
        """Those of the formats in which a setting has an effect."""
        return [file_format.ending for file_format in self.formats() if option in file_format.options]

    def format(self, path: str | Path) -> Format:
        """The format of the path's ending. Raises UsageError, where its library is missing, too."""
        file_format = by_ending(path, self.formats(), self.refusal)
        if file_format.needs is not None:
            require_extra(*file_format.needs, f"writing {file_format.label}")
        return file_format

    def target(self, path: str | Path) -> Path:
        """The path, links followed, where an output will stand. Raises UsageError, OutputFailed."""
        file_format = self.format(path)
        return writable_folder(path, file_format.folder) if file_format.folder else writable_target(path)

    def view(self, known: Format, content: Any, options: dict) -> Any:
        """What a format takes of content; options that say how it is made are removed."""
        return next(make for name, make in self.views.items() if name in known.takes)(content, options)

    def write(
        self, content: Any, path: str | Path, outputs: Outputs, step: Step = no_step, **options: Any
    ) -> None:
        """Writes content in the format of the path's ending; it appears with the other outputs. options: by
        name; a format takes those that have an effect on it. Raises UsageError, OutputFailed."""
        path, file_format = Path(path), self.format(path)
        if self.unit is not None:
            options["unit"] = self.unit(content)
        options = {name: value for name, value in options.items() if name in file_format.options}
        content = self.view(file_format, content, options)
        if file_format.folder:
            with outputs.folder(path, file_format.folder) as folder:
                file_format.write(content, folder, step)
        elif file_format.has_files:
            file_format.write(content, path, outputs, step, **options)
        elif file_format.has_each and _EACH_PART in path.name:
            for part, word in zip(content, solver_names(part.name for part in content), strict=True):
                with outputs.file(path.with_name(path.name.replace(_EACH_PART, word))) as file:
                    file_format.write([part], file, no_step, **options)
            step(1.0)
        else:
            with outputs.file(path) as file:
                file_format.write(content, file, step, **options)

    def save(self, content: Any, path: str | Path, step: Step = no_step, **options: Any) -> None:
        """Writes content as the only output, whole or not at all. Raises UsageError, OutputFailed."""
        with Outputs() as outputs:
            self.write(content, path, outputs, step, **options)


MODEL = Exporter(
    "files ending in {} are not supported",
    {
        "model": _as_it_is,
        "polyhedra": _polyhedra,
        "parts": _blocks,
        "corner point": _corner_point,
        "model and grid": _with_grid,
    },
    lambda model: model.project.units,
)
SURFACES = Exporter(
    "surfaces are written to no files ending in {}",
    {"surfaces": _as_it_is, "parts": lambda surfaces, _options: surface_parts(surfaces)},
    lambda surfaces: surfaces.project.units,
)
SECTION = Exporter(
    "sections are not written as {}",
    {
        "section": _as_it_is,
        "drawing": _drawn,
        "parts": lambda section, _options: section_parts(section),
    },
    lambda section: section.unit,
)
JUXTAPOSITION = Exporter("juxtaposition diagrams are not written as {}", {"drawing": _drawn_juxtaposition})
STEREONET = Exporter("stereonets are not written as {}", {"drawing": _drawn_net})
SHEETS = Exporter("sheets are not written as {}", {"sheets": _as_it_is})
FIELDS = Exporter("fields are not written as {}", {"fields": _as_it_is})
REPORT = Exporter("reports are not written as {}", {"report": _as_it_is, "block table": _as_it_is})
BOREHOLE = Exporter("boreholes are not written as {}", {"borehole": _as_it_is})
PLANNED_HOLE = Exporter("planned holes are not written as {}", {"planned hole": _as_it_is})
MESH = Exporter(
    "meshes are not written as {}",
    {"elements": _as_it_is, "polyhedra": lambda mesh, _options: ElementFaces(mesh).polyhedral()},
)
POLYHEDRA = Exporter("{} files take prisms and tetrahedra, and no polyhedra", {"polyhedra": _as_it_is})
_OF_SAMPLES = "the probabilities of a {kind} are not written as {{}}"
SAMPLES = {
    "section": Exporter(
        _OF_SAMPLES.format(kind="section"), {"section samples": _as_it_is, "drawing": _drawn_samples}
    ),
    "borehole": Exporter(_OF_SAMPLES.format(kind="borehole"), {"hole samples": _as_it_is}),
    "grid": Exporter(_OF_SAMPLES.format(kind="grid"), {"grid samples": _as_it_is}),
}


def check_tolerance(path: str | Path, tolerance: float | None) -> None:
    """Raises UsageError where models have no such format, or it has no cells that a tolerance would clean."""
    file_format = MODEL.format(path)
    if tolerance is not None and "tolerance" not in file_format.options:
        raise UsageError(f"{path}: {file_format.label} has no polyhedral cells: it takes no tolerance")


def save_mesh(
    mesh: VolumeMesh | PolyhedralMesh, path: str | Path, step: Step = no_step, unit: str = MODEL_UNIT
) -> None:
    """Writes a mesh for simulation, or cleaned cells, to a file or folder by its ending (.foam, .vtu, .msh,
    .inp, .cdb, .exo, ...). It appears whole or not at all.

    step(share) is called now and then, last with 1. unit: of its lengths, for formats that name one. Raises
    UsageError for an unknown extension, OutputFailed if it cannot be written.
    """
    exporter = POLYHEDRA if isinstance(mesh, PolyhedralMesh) else MESH
    exporter.save(mesh, path, step, unit=unit)
