# SPDX-License-Identifier: GPL-3.0-or-later
"""Realizations of a model: its surfaces and fields with random errors, cut as in every build."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.errors import InputRefused
from ..base.named import keyword_only
from ..base.triangles import Sheet
from ..base.work import Cancel, Progress, Work, native_module, on_threads, run
from ..cells.assembly import assemble, intersect
from ..fields import FieldDraws
from ..fields.series_field import SeriesField
from ..heights.realizations.draws import Draw
from ..heights.realizations.sheet_draws import SeriesDraw
from ..heights.realizations.turning_bands import FieldArea, Noise
from ..model.model import Model
from ..structures.parts.parts import Structures
from ..structures.setup import make_surfaces
from ..surfaces.observed.conformable import sheets_beside
from ..surfaces.rock_input import RockInput
from ..validation.closed_form import ClosedForm, closed_forms

_INTERPOLATED, _INTERSECTED = 0.5, 0.98  # of the time
_MOST_BYTES = 256_000_000  # of the closed forms of realizations that are kept


@dataclass
class Realizer:
    """Makes the realizations of a built model, each from the seed and its number alone.

    model: as `build` gives it. seed: from 0. correlation: of the errors of each surface with those of the
    next older one of its rock mass, from -1 to 1, for surfaces without a correlation; exact where both have
    the same variogram.
    """

    model: Model
    seed: int = 0
    correlation: float = 0.0
    _known: dict[tuple[int, int], dict] = field(default_factory=dict, repr=False)
    _forms: dict[int, list[ClosedForm]] = field(default_factory=dict, repr=False)
    _size: int = field(default=0, repr=False)  # of these, in bytes

    def __post_init__(self) -> None:
        self.model.require_project("an ensemble")
        places = [entry.region.vertices for entry in self.model.rock_inputs if entry.region is not None]
        for entry in self.model.rock_inputs:
            places += [data.points[:, :2] for data in entry.data]
        places = [points for points in places if len(points)] or [np.zeros((1, 2))]
        low = np.min([points.min(axis=0) for points in places], axis=0)
        high = np.max([points.max(axis=0) for points in places], axis=0)
        self._area = FieldArea(low, high)

    @keyword_only
    def realization(
        self,
        number: int,
        cells: str = "blocks",
        *,
        threads: int = 0,
        progress: Progress | None = None,
        cancel: Cancel | None = None,
    ) -> Model:
        """The model with heights and fields drawn for the number-th time, from 0. Ready meshes, faults and
        bodies stay. cells: as of `build`.

        Raises InputRefused, BuildFailed, Cancelled.
        """
        try:
            return run(lambda work: self._make(work, number, cells), progress, cancel, threads=threads)
        except InputRefused as error:
            raise error.within(f"realization {number}") from error

    def prepare(self, threads: int = 0) -> None:
        """Computes the data that all realizations share, so that workers do not compute them again."""
        run(lambda work: self._interpolated(work, 0), threads=threads)

    def closed_forms(self, work: Work, number: int) -> list[ClosedForm]:
        """The closed form of each rock mass of a realization by its number: which block is where, without
        its cells. They are kept, as far as memory is worth it: the next hole meets the same. work: of `run`.
        Raises InputRefused, Cancelled."""
        if number in self._forms:
            return self._forms[number]
        return self._keep(number, *self._interpolated(work, number))

    def _keep(self, number: int, inputs: list[RockInput], structures: Structures) -> list[ClosedForm]:
        forms = closed_forms(replace(self.model, rock_inputs=inputs, structures=structures))
        sheets = {id(mesh): mesh for form in forms for row in form.sheets for mesh in row if mesh is not None}
        size = sum(mesh.vertices.nbytes + mesh.triangles.nbytes for mesh in sheets.values())
        size += sum(grid.values.nbytes for form in forms for series in form.fields for grid in series.fields)
        if self._size + size <= _MOST_BYTES:
            self._forms[number] = forms
            self._size += size
        return forms

    def _make(self, work: Work, number: int, cells: str) -> Model:
        began = time.perf_counter()
        with work.part(0.0, _INTERPOLATED):
            inputs, structures = self._interpolated(work, number)
            self._keep(number, inputs, structures)
        interpolated = time.perf_counter()
        with work.part(_INTERPOLATED, _INTERSECTED):
            built = intersect(work, inputs, cells, structures)
        timings = {"interpolate": interpolated - began, "intersect": time.perf_counter() - interpolated}
        project = self.model.project
        with work.part(_INTERSECTED, 1.0):
            return Model.of(assemble(work, project, inputs, built, timings, structures))

    def _interpolated(self, work: Work, number: int) -> tuple:
        """The rock masses with heights drawn, and the structures."""
        inputs = [self._drawn(entry, rock, number) for rock, entry in enumerate(self.model.rock_inputs)]
        project = self.model.project
        structures = make_surfaces(work, project, inputs, None)
        return inputs, structures

    def correlations(self, entry: RockInput) -> list[float]:
        """The correlations of the errors of each surface of a rock mass, an entry of the model's rock_inputs,
        with those of the next older one."""
        correlations = [surface.correlation for surface in entry.rock.surfaces]
        return [self.correlation if value is None else value for value in correlations]

    def _drawn(self, entry: RockInput, rock: int, number: int) -> RockInput:
        """An entry without heights, whose surfaces will be drawn."""
        surfaces = entry.rock.surfaces
        draws: list[Draw] = []
        noise, of_series = None, None
        for index, correlation in enumerate(self.correlations(entry)):
            surface_noise = Noise((self.seed, number, rock, index), noise, correlation)
            beside = sheets_beside(entry.rock, index)
            if entry.rock.is_level_set(surfaces[index]):
                noise, of_series = None, None
            elif index in beside[1:]:  # drawn together with the oldest, whose noise is that of all
                assert of_series is not None
                surface_noise = Noise((self.seed, number, rock, index))
                of_series.noises.append(surface_noise)
            else:
                noise, of_series = surface_noise, SeriesDraw([surface_noise]) if beside else None
            interpolation = None if self.model.structures.is_divided else entry.interpolations[index]
            cache = self._known.setdefault((rock, index), {})
            draws.append(Draw(self._area, surface_noise, cache, interpolation, of_series))
        return replace(
            entry,
            surfaces=[
                None if entry.rock.is_interpolated(surface) else shape
                for surface, shape in zip(surfaces, entry.surfaces, strict=True)
            ],
            interpolations=[None] * len(surfaces),
            warnings=[],
            attributes={},
            structure=None,
            draws=draws,
            field_draws={series.name: self._field_draws(series, rock, number) for series in entry.fields},
            left_out=list(entry.left_out),
        )

    def _field_draws(self, series: SeriesField, rock: int, number: int) -> FieldDraws:
        """How the fields of a series of a rock mass are drawn."""
        noise = Noise((self.seed, number, rock, series.first))
        return FieldDraws(noise.normal, self._known.setdefault((rock, series.first), {}), series.top)


def heights(model: Model) -> list[np.ndarray | None]:
    """The heights (V,) float64 of each surface: at the nodes of the planar mesh, or where faults divide the
    rock mass at the vertices of its sheets, one after another; None for ready meshes and level sets."""
    return [
        None if _is_ready(entry, number) else _own(entry, number)
        for entry in model.rock_inputs
        for number in range(len(entry.surfaces))
    ]


def differences(base: Model, drawn: Model, threads: int = 0) -> list[np.ndarray | None]:
    """The differences (V,) float64 of each surface: the heights of a realization minus those of the model, as
    of `heights`. NaN where a sheet of the realization does not reach."""
    return [
        None if _is_ready(entry, number) else _difference(entry, other, number, threads)
        for entry, other in zip(base.rock_inputs, drawn.rock_inputs, strict=True)
        for number in range(len(entry.surfaces))
    ]


def _is_ready(entry: RockInput, number: int) -> bool:
    return entry.interpolations[number] is None


def _own(entry: RockInput, number: int) -> np.ndarray:
    if entry.structure is None:
        return entry.interpolation(number).z
    return np.concatenate([vertices[:, 2] for _, (vertices, _) in _sheets(entry, number)])


def _difference(entry: RockInput, drawn: RockInput, number: int, threads: int) -> np.ndarray:
    if entry.structure is None:
        return drawn.interpolation(number).z - entry.interpolation(number).z
    changes = []
    for compartment, (vertices, _) in _sheets(entry, number):
        nodes, triangles = drawn.divided().sheet(compartment, number)
        if np.array_equal(nodes[:, :2], vertices[:, :2]):
            z = nodes[:, 2]
        else:
            plan = np.ascontiguousarray(vertices[:, :2])
            z = native_module().surface_heights(nodes, triangles, plan, execution=on_threads(threads))
        changes.append(z - vertices[:, 2])
    return np.concatenate(changes)


def _sheets(entry: RockInput, number: int) -> list[tuple[int, Sheet]]:
    """The different sheets of a surface, as of RockStructure.distinct, each with its first compartment."""
    first: dict[Sheet, int] = {}
    structure = entry.divided()
    for compartment in range(len(structure.sheets)):
        sheet = structure.sheet(compartment, number)
        first.setdefault(sheet, compartment)
    return [(compartment, sheet) for sheet, compartment in first.items()]
