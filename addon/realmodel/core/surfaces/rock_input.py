# SPDX-License-Identifier: GPL-3.0-or-later
"""A rock mass, read and interpolated: what the cells are made of."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..base.errors import BuildWarning, InputRefused, naming
from ..base.stored_objects import NOT_STORED
from ..base.triangles import Sheet, median_edge
from ..fields import FieldDraws, LevelSolid, ScalarField
from ..fields.series_field import SeriesField
from ..heights import Interpolation
from ..heights.realizations.draws import Draw
from ..project.project import Rock, surface_item
from ..readers.tables.observations import LeftOut
from ..settings.methods import SURFACE_OPTIONS
from .observed.surface_data import SurfaceData
from .rock_structure import RockFaults, RockStructure


@dataclass
class RockInput:
    """A rock mass, read and interpolated.

    rock: as given, with arrays instead of files. surfaces: oldest first. region: its triangulation in
    plan, or None. interpolations: the result for each surface, None for ready meshes. file_faces: for each
    surface None, or the face of its file that each triangle belongs to. attributes: of the vertices of each
    interpolated surface, by its number (`variance`, `distance`). warnings: of reading and interpolating.
    structure: the compartments of a rock mass with faults, and their sheets; a surface is all its sheets.
    overlapping: by number, the error of a surface whose triangles overlap in a sheet because of a fault.
    draws: how each surface is drawn in a realization of an ensemble; else None. field_draws: the same of
    series of fields, by their names. left_out: the observations that are not used. used: of Rock.observations
    (N,) bool, those that are. edge: of the region's mesh the median edge before contacts became its vertices;
    None where none did. has_faults: whether the project has faults, which may divide it. data: what is known
    of each surface. fields: of series whose surfaces are level sets; such a surface is a level set, in each
    compartment of its field. level_solids: of fields, until cells are made of them. untied: of sheets that
    were tied to their data what they were before, until the warnings about doubtful heights are made.
    joint_fits: what was fitted to the data of several surfaces, as of Alike."""

    rock: Rock
    surfaces: list[Sheet | None]
    region: Sheet | None = None
    interpolations: list[Interpolation | None] = field(default_factory=list)
    file_faces: list[np.ndarray | None] = field(default_factory=list)
    warnings: list[BuildWarning] = field(default_factory=list)
    attributes: dict[int, dict[str, np.ndarray]] = field(default_factory=dict)
    structure: RockStructure | None = None
    overlapping: dict[int, InputRefused] = field(default_factory=dict)
    draws: list[Draw] | None = field(default=None, metadata=NOT_STORED)
    field_draws: dict[str, FieldDraws] = field(default_factory=dict, metadata=NOT_STORED)
    left_out: list[LeftOut] = field(default_factory=list)
    used: np.ndarray | None = None
    edge: float | None = None
    has_faults: bool = False
    data: list[SurfaceData] = field(default_factory=list)
    fields: list[SeriesField] = field(default_factory=list)
    level_solids: dict[ScalarField, list[LevelSolid]] = field(default_factory=dict, metadata=NOT_STORED)
    untied: dict[Sheet, Sheet] = field(default_factory=dict, metadata=NOT_STORED)
    joint_fits: dict[bytes, Any] = field(default_factory=dict, metadata=NOT_STORED)

    def __post_init__(self) -> None:
        self.data = self.data or [SurfaceData() for _ in self.rock.surfaces]

    def surface(self, number: int) -> Sheet:
        """The triangulation of a surface that is a ready mesh or interpolated already."""
        surface = self.surfaces[number]
        assert surface is not None
        return surface

    def named(self, number: int) -> AbstractContextManager:
        """Within it errors name a surface, and where its shape comes from."""
        surface = self.rock.surfaces[number]
        return naming(surface_item(self.rock, surface), surface.shape_source)

    def planar_mesh(self) -> Sheet:
        """The triangulation of the region of a rock mass that has one and is meshed."""
        assert self.region is not None
        return self.region

    def median_edge(self) -> float:
        """The median length of the edges of the planar mesh, but for what contacts make it finer."""
        return median_edge(*self.planar_mesh()) if self.edge is None else self.edge

    def interpolation(self, number: int) -> Interpolation:
        """The result for a surface that is interpolated."""
        result = self.interpolations[number]
        assert result is not None
        return result

    def divided(self) -> RockStructure:
        """The compartments and their sheets; a rock mass without faults is one, with its surfaces."""
        if self.structure is None:
            return RockStructure(RockFaults([], [], []), np.zeros((1, 0), np.int8), [""], [self.surfaces])
        return self.structure

    def field_of(self, surface: int) -> SeriesField | None:
        """The field that a surface is a level set of; None for a sheet."""
        return next((series_field for series_field in self.fields if surface in series_field.numbers), None)

    @property
    def is_clipped(self) -> bool:
        """Whether there is a region that ends its surfaces; those on its own mesh end where it ends."""
        return self.region is not None and not all(map(self.rock.is_interpolated, self.rock.surfaces))

    @property
    def reaches_base(self) -> bool:
        """Whether sheets that are made reach down to the base elevation, or below it, and are cut there."""
        base, pairs = self.rock.base_elevation, zip(self.rock.surfaces, self.surfaces, strict=True)
        if base is None:
            return False
        heights = [
            shape.vertices[:, 2]
            for of, shape in pairs
            if shape is not None and not self.rock.is_level_set(of)
        ]
        return any(len(z) > 0 and z.min() <= base for z in heights)

    def native(self) -> tuple:
        """The arguments of the native stack builder: surfaces, region, base elevation, rules."""
        rules = [surface.rule for surface in self.rock.surfaces]
        surfaces = [self.surface(number).arrays for number in range(len(self.surfaces))]
        region = None if self.region is None else self.region.arrays
        return surfaces, region, self.rock.base_elevation, rules

    def stage(self, m: int) -> RockInput:
        """The entry with the surfaces up to m only; the region stays the same. A surface that depends on a
        removed one keeps its heights as a ready mesh, if it has them already."""
        gone = {surface.name for surface in self.rock.surfaces[m + 1 :]}
        surfaces, data = self.rock.surfaces[: m + 1], self.data[: m + 1]
        for number, surface in enumerate(surfaces):
            shape = self.surfaces[number]
            if shape is not None and gone.intersection(named_surfaces(self.rock, number)):
                vertices, triangles = shape
                data[number] = data[number].through(np.empty((0, 3)))
                surfaces[number] = replace(
                    surface,
                    points=None,
                    method=None,
                    options={},
                    minimum_thickness=None,
                    true_thickness=False,
                    observed=False,
                    correlation=None,
                    vertices=vertices,
                    triangles=triangles,
                )
        return RockInput(
            replace(self.rock.stage(m), surfaces=surfaces),
            self.surfaces[: m + 1],
            self.region,
            self.interpolations[: m + 1],
            self.file_faces[: m + 1],
            [warning for warning in self.warnings if warning.surface not in gone],
            {number: values for number, values in self.attributes.items() if number <= m},
            None if self.structure is None else self.structure.stage(m),
            self.overlapping,
            left_out=self.left_out,
            used=self.used,
            edge=self.edge,
            has_faults=self.has_faults,
            data=data,
            fields=[staged for series_field in self.fields if (staged := series_field.stage(m)) is not None],
        )


def named_surfaces(rock: Rock, number: int) -> dict[str, int]:
    """The surfaces of the rock mass that the options of one of them name: numbers by names."""
    numbers = {surface.name: n for n, surface in enumerate(rock.surfaces)}
    options = rock.surfaces[number].options
    names = [options[option] for option in SURFACE_OPTIONS if isinstance(options.get(option), str)]
    return {name: numbers[name] for name in names}
