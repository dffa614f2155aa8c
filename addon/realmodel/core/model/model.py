# SPDX-License-Identifier: GPL-3.0-or-later
"""The built model: what it holds (model_data.py), and all that can be made of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Self

from ..base.errors import UsageError
from ..base.named import keyword_only, number_of
from ..base.work import Cancel, Progress, run
from ..cells.assembly import build_stage
from ..cells.model_data import ModelData
from ..exporters import MODEL, SHEETS, SURFACES, check_tolerance
from ..exporters.page import page_of
from ..exporters.report import Report, model_report
from ..fields import ScalarField
from ..results.contours import contours
from ..results.corner_point import corner_point_grid
from ..results.geological_map import geological_map
from ..results.layer_values import field_of, rock_fields
from ..results.model_holes import borehole
from ..results.sections.section_data import SectionData
from ..results.sheets import DEFAULT_SIZE, draw_sheets
from ..results.tables import block_table, borehole_table, map_dataset
from ..results.volumes import Erosion, eroded
from ..settings.method_options import check_threads
from ..simulation import CleanedCells, SimulationMesh, cleaned_cells, simulation_mesh
from ..validation.closed_form import block_at, grid
from ..validation.left_out_holes import cross_validate_holes
from ..validation.misfits import misfits
from ..validation.observed import observed
from ..validation.validation import PLACES_OF_CHECK, ValidationReport, validate
from . import cutting, notebook_view
from .juxtapositions import juxtaposition
from .model_file import read_model
from .planned_hole import planned_hole
from .stereonets import stereonet


class Model(ModelData):
    """A built model: blocks of polyhedral cells that share faces."""

    @classmethod
    @keyword_only
    def load(
        cls,
        path: str | Path,
        *,
        threads: int = 0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> Self:
        """The model that `save` wrote to an .npz. All methods work on it as on the built one, and give the
        same bytes; only its timings are empty.

        A file of RealModel 0.1 has no project: what needs that (stage, eroded, validate with places, the
        report, .npz) raises InputRefused then. threads: 0 for all, for later calls. Raises InputRefused where
        the file is no model, or damaged, Cancelled.
        """
        threads = check_threads(threads)
        return cls.of(run(lambda work: read_model(work, Path(path)), progress, cancel, threads=threads))

    def save(
        self,
        path: str | Path,
        cell_size: float | Sequence[float] | None = None,
        contour_interval: float | None = None,
        tolerance: float | None = None,
        grid_layers: int | None = None,
        grid_azimuth: float | None = None,
    ) -> None:
        """Writes the model to a file or folder, by its ending (docs/reference/output_files.md). It appears
        whole or not at all.

        cell_size: of regular grids (.csv, .vti, .tif, .asc) and maps of values (.gpkg), one number, two (in
        plan, in height) or three; None: a hundredth of the longest side; in .omf, .geoh5 and .epc there are
        cells only where it is given. contour_interval: of maps (.gpkg, .geojson); None: one of about fifteen
        levels. tolerance: of formats with the model's cells (.vtu, .foam, .exo, .disu): they are cleaned as
        cleaned_cells does; None: the exact cells. grid_layers, grid_azimuth: of corner-point grids (.grdecl,
        .epc), the layers of each block and the direction of their columns, as of corner_point_grid. Raises
        UsageError for an ending that is not known, or whose library is missing, OutputFailed where it cannot
        be written.
        """
        check_tolerance(path, tolerance)
        MODEL.save(
            self,
            path,
            cell_size=cell_size,
            contour_interval=contour_interval,
            tolerance=tolerance,
            grid_layers=grid_layers,
            grid_azimuth=grid_azimuth,
        )

    def to_html(self) -> str:
        """The model as one page of HTML, as `save` writes it to an .html. Browsers show it without a network.

        Coordinates have 32 bits there, from a place near the middle. Raises InputRefused for a model without
        a project.
        """
        return page_of(self)

    def save_surfaces(self, path: str | Path) -> None:
        """Writes the surfaces, faults and bodies as they were used, by the file's ending (.obj, .ply, .stl,
        .glb, .dxf, .ts with a part for each, .npz, .vtu). It appears whole or not at all.

        Raises UsageError for an unknown extension, OutputFailed if it cannot be written.
        """
        SURFACES.save(self, path)

    def save_sheets(
        self,
        path: str | Path,
        sections: Sequence[SectionData] = (),
        size: str = DEFAULT_SIZE,
        scale: float | None = None,
        exaggeration: float = 1.0,
        hole_width: float = 0.0,
        hole_column: str | None = None,
    ) -> None:
        """Writes sheets to print, with the geological map and sections, to a .pdf of as many pages as they
        take; an .svg has one, and several where its name has {sheet}. They appear whole or not at all.

        sections: as of `section` and `fence`; vertical ones are lines on the map, A-A', B-B', ... size: "A4"
        to "A0", as "A3" wide or as "A3-portrait" high. scale: N of 1 : N, of map and sections; None: the
        largest round one at which all fit. exaggeration, hole_width, hole_column: as of Section.save. Raises
        UsageError for what does not fit, naming a size and a scale that do, OutputFailed.
        """
        SHEETS.format(path)
        of_sections = exaggeration, hole_width, hole_column
        SHEETS.save(draw_sheets(self, sections, size, scale, *of_sections), path)

    def field(self, series: str, compartment: str | None = None) -> ScalarField:
        """The field of a series: its lattice, the values of the nodes, and the level of each surface.

        compartment: a name of compartment_names, where faults divide the series; None: there is one field.
        Raises UsageError for a series that has none, and where it has several fields and none is named.
        """
        return field_of(self.project, rock_fields(self.rock_inputs), series, compartment)

    @keyword_only
    def stage(self, m: int | str, *, progress: Progress | None = None, cancel: Cancel | None = None) -> Model:
        """The model as it was just after surface m (from 0) of each rock mass, or after the surface with this
        name and those of the same number. Raises UsageError where no rock mass has a surface m, or the model
        is a half: cut the stage instead. It is built anew from the surfaces up to m.

        >>> model.stage(1).volume, model.volume  # when the sand had just been laid down, and now
        (48.0, 48.0)
        >>> [block.volume for block in model.stage(1).blocks]
        [32.0, 16.0]
        """
        if self.is_cut:
            raise UsageError("a cut model has no stages: take the stage of the whole model, then cut that")
        if isinstance(m, str):
            numbers = [number for rock in self.project.rocks for number in range(len(rock.surfaces))]
            m = numbers[number_of(m, self.surface_names[: len(numbers)], "surface")]
        return build_stage(self, m, progress, cancel)

    @keyword_only
    def eroded(self, *, progress: Progress | None = None, cancel: Cancel | None = None) -> Erosion:
        """What each surface removed of each block when it came: (S, B) volumes, and their sums.

        The volume of a block just before the surface, less that just after. For each surface that cuts the
        model is built once more up to the surface before, with whole blocks as cells; what rounding alone
        makes is given as 0. Raises UsageError where the model is a half, Cancelled.

        >>> model.eroded().by_block
        array([2., 6., 0.])
        """
        if self.is_cut:
            raise UsageError("a cut model has no erosion: ask the whole model")
        return eroded(self, self.threads, progress, cancel)

    @keyword_only
    def validate(
        self,
        places: int = PLACES_OF_CHECK,
        seed: int = 1,
        *,
        threads: int = 0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> ValidationReport:
        """Validates the model (docs/dev/geometry.md): every cell, face and vertex of it; and whether it
        agrees with the closed form at about `places` plan positions. 0 places, or a half: only the first.

        seed draws the places. threads: 0 for all; the findings are the same for any number. A model that
        fails is no error here: the report has the failures and their positions. Raises UsageError, Cancelled.

        >>> model.validate().passed
        True
        """
        return validate(self, places, seed, threads, progress, cancel)

    def report(
        self,
        validation: ValidationReport | None = None,
        erosion: Erosion | None = None,
        mesh: SimulationMesh | None = None,
        cells: CleanedCells | None = None,
    ) -> Report:
        """The content of report.json (docs/reference/output_files.md): a dict, whose lists are tables of
        pandas, too (Report.table). Volumes are in model units cubed, times in seconds, memory in bytes.

        validation: what `validate` found; None: it is run now. erosion: what `eroded` found, mesh: a mesh of
        the model, cells: its cleaned cells; without them the report has none.

        >>> report = model.report()
        >>> report["volume"], report["validation"]["passed"]
        (48.0, True)
        """
        return model_report(self, validation=validation, erosion=erosion, mesh=mesh, cells=cells)

    def __repr__(self) -> str:
        return notebook_view.summary(self)

    def _repr_html_(self) -> str:
        return notebook_view.html(self)

    to_pyvista = notebook_view.to_pyvista
    surfaces_to_pyvista = notebook_view.surfaces_to_pyvista
    to_xarray = map_dataset
    block_table = block_table
    borehole_table = borehole_table
    plot = notebook_view.plot
    simulation_mesh = simulation_mesh
    cleaned_cells = cleaned_cells
    corner_point_grid = corner_point_grid
    geological_map = geological_map
    contours = contours
    cut_by_plane = cutting.cut_by_plane
    cut_by_surface = cutting.cut_by_surface
    cut_by_block = cutting.cut_by_block
    section = cutting.section
    slice = cutting.slice_model
    clip = cutting.clip
    fence = cutting.fence
    fence_through_holes = cutting.fence_through_holes
    juxtaposition = juxtaposition
    stereonet = stereonet
    borehole = borehole
    block_at = block_at
    grid = grid
    planned_hole = planned_hole
    observed = observed
    misfits = misfits
    cross_validate_holes = cross_validate_holes
