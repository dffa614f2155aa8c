# SPDX-License-Identifier: GPL-3.0-or-later
"""RESQML 2.0.1 (Energistics, "RESQML Technical Usage Guide") by resqpy: an .epc file of XML, and an .h5 file
with its arrays.

Surfaces are triangulated sets of horizons, faults and boundaries of geobodies. Blocks are closed ones of
geologic units and geobodies: few programs read the format's sealed frameworks. Boreholes are trajectories
with frames of intervals and of markers.
"""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...base.atomic import Outputs
from ...base.packages import extra
from ...base.text import Step
from ...cells.model_data import ModelData
from ...results.corner_point import CornerPointGrid
from ...settings.crs import epsg_code
from ..model_arrays import model_arrays
from ..shapes.shape_parts import Part, block_materials
from .object_contents import BODIES, FAULTS, Contents, Hole, SurfaceShape, stable_uuid

_UNITS = {"us-ft": "ft[US]"}  # the others have the names that they have here
_LONG_AGO = "1970-01-01T00:00:00Z"  # of all that the library dates: the same model has the same bytes
_DATES, _PERSONS = ("Creation", "created"), ("Originator", "creator")
_UNKNOWN = -1  # in lists of names
_LINEAR = 1  # the kind of a trajectory


def write_resqml(
    content: tuple[ModelData, CornerPointGrid | None], path: Path, outputs: Outputs, step: Step
) -> None:
    """Writes a model, and its corner-point grid where there is one. The .h5 file is named as the path is."""
    model, grid = content
    contents = Contents.of(model)
    step(0.2)
    with outputs.path(path) as target, outputs.path(path.with_suffix(".h5")) as arrays:
        plain = target.parent / "written" / f"{path.stem}.epc"  # the library finds the .h5 file beside it
        plain.parent.mkdir()
        with _numbered(_digest(model, grid)):
            made = _Objects(model, contents, plain)
            made.write()
            step(0.5)
            if grid is not None:
                made.grid(grid)
            made.store()
        step(0.9)
        _pack(plain, target)
        plain.with_suffix(".h5").replace(arrays)
    step(1.0)


def _digest(model: ModelData, grid: CornerPointGrid | None) -> str:
    """Of the geometry, so that files of different models have no object in common."""
    digest = hashlib.blake2b(model.project.name.encode(), digest_size=16)
    for array in [*model_arrays(model).values(), *([] if grid is None else [grid.zcorn])]:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


@contextmanager
def _numbered(digest: str) -> Iterator[None]:
    """Within it the library's identifiers count on from one that the digest gives."""
    identifiers = extra("resqpy.olio.uuid", "writing RESQML", "resqml")
    identifiers.switch_on_test_mode(stable_uuid("resqml", digest).int)
    try:
        yield
    finally:
        identifiers.switch_off_test_mode()


def _pack(plain: Path, target: Path) -> None:
    """Writes the files of an archive to another one, compressed, with a fixed date."""
    with zipfile.ZipFile(plain) as read, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in read.namelist():
            entry = zipfile.ZipInfo(name)
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            packed.writestr(entry, read.read(name), zipfile.ZIP_DEFLATED)


class _Objects:
    """Makes the objects of a file. Coordinates are written less a place in plan, in whole units, which the
    coordinate system has, so that programs with short numbers show them."""

    def __init__(self, model: ModelData, contents: Contents, path: Path):
        library = extra("resqpy.model", "writing RESQML", "resqml")
        from resqpy import crs, grid, organize, property, strata, surface, well
        from resqpy.olio.xml_namespaces import curly_namespace

        self._grid, self._organize, self._property = grid, organize, property
        self._strata, self._surface, self._well = strata, surface, well
        self._model, self._contents, self._spaces = model, contents, curly_namespace
        self._unit = _UNITS.get(model.project.units, model.project.units)
        self._file = library.new_model(str(path), quiet=True)
        self._origin = np.zeros(3)
        if len(model.vertices):
            self._origin[:2] = np.floor(model.vertices[:, :2].min(axis=0))
        east, north, _ = self._origin.tolist()
        code = epsg_code(model.project.crs)
        self._crs = crs.Crs(
            self._file,
            x_offset=east,
            y_offset=north,
            xy_units=self._unit,
            z_units=self._unit,
            z_inc_down=False,
            epsg_code=None if code is None else str(code),
            title=model.project.crs or "local",
        )
        self._crs.create_xml()
        self._lookups: dict[tuple[str, ...], Any] = {}
        self._horizons: dict[str, Any] = {}

    def write(self) -> None:
        """All but the grid."""
        for name, shape in zip(self._model.surface_names, self._contents.surfaces, strict=True):
            self._add_surface(name, shape)
        for shell in self._contents.blocks:
            block = self._model.blocks[shell.number]
            about = {
                "rock_mass": self._model.project.rocks[block.rock].name,
                "block": block.name,
                "property": block.property,
                "volume": block.volume,
                **shell.known,
            }
            is_body = block.surface >= 0 and self._contents.surfaces[block.surface].group == BODIES
            made = self._triangles(shell.part, self._unit_of_rock(shell.part.name, is_body), about)
            self._named(made, "surface", "faces", shell.surface, self._contents.boundary_names)
            self._named(made, "neighbor", "faces", shell.neighbor, self._contents.block_names)
        for hole in self._contents.holes:
            (self._hole if len(hole.places) > 1 else self._pick)(hole)

    def store(self) -> None:
        """Writes the files, with dates and names that are always the same."""
        for *_, tree in (*self._file.parts_forest.values(), *self._file.other_forest.values()):
            for node in list(tree.iter()):
                self._mend(node)
        self._file.store_epc(quiet=True)

    def _mend(self, node: Any) -> None:
        """Also what the schema has otherwise than the library writes it."""
        word, kind = node.tag.rpartition("}")[2], f"{self._spaces['xsi']}type"
        if word in _DATES:
            node.text = _LONG_AGO
        elif word in _PERSONS:
            node.text = "RealModel"
        elif word == "EpsgCode":
            node.tag = f"{self._spaces['eml']}{word}"
        elif word == "VerticalCrs":  # it has the code of the plan
            node.clear()
            node.set(kind, "eml:VerticalUnknownCrs")
            self._file.create_unknown(root=node)
        elif node.get(kind) == "resqml2:Hdf5Dataset":
            node.set(kind, "eml:Hdf5Dataset")

    def _add_surface(self, name: str, shape: SurfaceShape) -> None:
        boundary = self._boundary(shape)
        if shape.group not in (FAULTS, BODIES):
            # picks name a surface of their rock mass, so a name that two have says too little
            self._horizons[name] = None if name in self._horizons else boundary
        made = self._triangles(shape.part, boundary, {})
        for key, values in shape.values.items():
            is_variance = key == "variance"
            self._property.Property.from_array(
                self._file,
                np.sqrt(values) if is_variance else values,
                "RealModel",
                "standard deviation" if is_variance else key,
                made.uuid,
                property_kind="length",
                indexable_element="nodes",
                uom=self._unit,
            )

    def _boundary(self, shape: SurfaceShape) -> Any:
        """The interpretation that a surface represents."""
        name, rqo = shape.part.name, self._organize
        if shape.group == FAULTS:
            feature = rqo.TectonicBoundaryFeature(self._file, kind="fault", feature_name=name)
            made = rqo.FaultInterpretation(self._file, tectonic_boundary_feature=feature)
        else:
            is_body = shape.group == BODIES
            kind = "geobody boundary" if is_body else "horizon"
            feature = rqo.GeneticBoundaryFeature(self._file, kind=kind, feature_name=name)
            interpretation = rqo.GeobodyBoundaryInterpretation if is_body else rqo.HorizonInterpretation
            made = interpretation(self._file, genetic_boundary_feature=feature)
        return self._created(feature, made)

    def _unit_of_rock(self, name: str, is_body: bool) -> Any:
        """The interpretation that a block represents."""
        rqo = self._organize
        if is_body:
            feature = rqo.GeobodyFeature(self._file, feature_name=name)
            return self._created(feature, rqo.GeobodyInterpretation(self._file, geobody_feature=feature))
        feature = self._strata.StratigraphicUnitFeature(self._file, title=name)
        made = self._strata.StratigraphicUnitInterpretation(
            self._file, title=name, stratigraphic_unit_feature=feature
        )
        return self._created(feature, made)

    def _created(self, feature: Any, interpretation: Any) -> Any:
        feature.create_xml(reuse=False)
        interpretation.title = feature.title
        interpretation.create_xml(reuse=False)
        return interpretation

    def _triangles(self, part: Part, represents: Any, about: dict) -> Any:
        made = self._surface.Surface(
            self._file, title=part.name, crs_uuid=self._crs.uuid, extra_metadata=about
        )
        made.set_from_triangles_and_points(part.triangles, part.vertices - self._origin)
        made.set_represented_interpretation_root(represents.root)
        made.write_hdf5()
        made.create_xml()
        return made

    def _pick(self, hole: Hole) -> None:
        """A pick alone, of a hole whose collar is not known: a trajectory takes two places."""
        made = self._surface.PointSet(
            self._file,
            points_array=hole.places - self._origin,
            crs_uuid=self._crs.uuid,
            title=f"pick of {hole.name}",
            extra_metadata={"hole": hole.name, "surface": hole.surfaces[0]},
        )
        if horizon := self._horizons.get(hole.surfaces[0]):
            made.set_represented_interpretation_root(horizon.root)
        made.write_hdf5()
        made.create_xml()

    def _hole(self, hole: Hole) -> None:
        well, depths, places = self._well, hole.depths, hole.places - self._origin
        datum = well.MdDatum(
            self._file,
            crs_uuid=self._crs.uuid,
            location=tuple(places[0]),
            md_reference="arbitrary point" if hole.surfaces[0] else "ground level",
        )
        datum.create_xml(title=f"datum of {hole.name}")
        path = well.Trajectory(
            self._file,
            crs_uuid=self._crs.uuid,
            md_datum=datum,
            length_uom=self._unit,
            well_name=hole.name,
            mds=depths,
            control_points=places,
        )
        path.create_feature_and_interpretation()
        path.line_kind_index = _LINEAR
        path.write_hdf5()
        path.create_xml()
        frame = well.WellboreFrame(
            self._file,
            trajectory=path,
            mds=depths,
            represented_interp=path.wellbore_interpretation,
            title=f"intervals of {hole.name}",
        )
        frame.write_hdf5()
        frame.create_xml()
        self._named(frame, "block", "intervals", hole.blocks, self._contents.block_names)
        if any(hole.surfaces):
            self._markers(hole, path)

    def _markers(self, hole: Hole, path: Any) -> None:
        frame = self._well.WellboreMarkerFrame(
            self._file, trajectory_uuid=path.uuid, title=f"markers of {hole.name}"
        )
        at = [number for number, surface in enumerate(hole.surfaces) if surface]
        frame.node_count, frame.node_mds = len(at), hole.depths[at]
        frame.marker_list = []
        for rank, number in enumerate(at):
            name = hole.surfaces[number]
            horizon = self._horizons.get(name)
            frame.marker_list.append(
                self._well.WellboreMarker(
                    self._file, frame, rank, None, "horizon", horizon and horizon.uuid, name
                )
            )
        frame.write_hdf5()
        frame.create_xml()

    def grid(self, grid: CornerPointGrid) -> None:
        """The corner-point grid: of each active cell the block and the property."""
        nx, ny, nz = grid.shape
        heights, pillars, columns, ends = _coordinate_lines(grid)
        made = self._grid.Grid(self._file)
        made.grid_representation = "IjkGrid"
        made.extent_kji = np.array([nz, ny, nx])
        made.nk, made.nj, made.ni = nz, ny, nx
        made.k_direction_is_down, made.pillar_shape = True, "vertical"
        made.grid_is_right_handed = False  # i to the right of j, and heights count up
        made.crs_uuid, made.crs = self._crs.uuid, self._crs
        made.points_cached = np.empty((*heights.shape, 3))
        plan = grid.coord[:, :, :2].reshape(-1, 2) - self._origin[:2]
        made.points_cached[..., :2] = np.concatenate([plan, plan[pillars]])
        made.points_cached[..., 2] = heights
        made.has_split_coordinate_lines = len(pillars) > 0
        if len(pillars):
            made.split_pillars_count, made.split_pillar_indices_cached = len(pillars), pillars
            made.cols_for_split_pillars, made.cols_for_split_pillars_cl = columns, ends
        else:
            made.points_cached = made.points_cached.reshape(nz + 1, ny + 1, nx + 1, 3)
        made.geometry_defined_for_all_cells_cached = made.geometry_defined_for_all_pillars_cached = True
        is_active = grid.actnum > 0
        made.inactive = ~is_active
        made.write_hdf5()
        made.create_xml(title="corner-point grid")
        blocks = np.where(is_active, grid.fipnum - 1, _UNKNOWN)
        self._named(made, "block", "cells", blocks, self._contents.block_names)
        properties = np.append([block.property for block in self._model.blocks], _UNKNOWN)
        self._named(made, "property", "cells", properties[blocks], block_materials(self._model))

    def _named(
        self,
        support: Any,
        name: str,
        where: str,
        numbers: Sequence[int] | np.ndarray,
        names: Sequence[str] | dict[int, str],
    ) -> None:
        """Numbers in a list of names; -1 is what is not known."""
        by_number = names if isinstance(names, dict) else dict(enumerate(names))
        key = (name, *map(str, by_number.items()))
        if key not in self._lookups:
            lookup = self._property.StringLookup(self._file, int_to_str_dict=by_number, title=name)
            lookup.create_xml(reuse=False)
            self._lookups[key] = lookup.uuid
        self._property.Property.from_array(
            self._file,
            np.asarray(numbers, np.int32),
            "RealModel",
            name,
            support.uuid,
            property_kind=name,
            indexable_element=where,
            discrete=True,
            null_value=_UNKNOWN,
            string_lookup_uuid=self._lookups[key],
        )


def _coordinate_lines(grid: CornerPointGrid) -> tuple[np.ndarray, ...]:
    """The lines that the corners of columns are on: one of each pillar, then those of columns with other
    heights there, as beyond a fault.

    Returns the heights (nz + 1, L), and of the further lines the pillar (M,), the columns that they are of,
    one after another, and where these end (M,).
    """
    nx, ny, nz = grid.shape
    corners = 0.0 - grid.zcorn.reshape(nz, 2, ny, 2, nx, 2)
    corners = np.concatenate([corners[:, 0], corners[-1:, 1]])
    around = np.full((nz + 1, ny + 1, nx + 1, 4), np.nan)  # of the columns around each pillar
    column = np.full((ny + 1, nx + 1, 4), -1)
    for corner, (j, i) in enumerate(np.ndindex(2, 2)):
        around[:, j : j + ny, i : i + nx, corner] = corners[:, :, j, :, i]
        column[j : j + ny, i : i + nx, corner] = np.arange(ny * nx).reshape(ny, nx)
    line = np.tile(np.arange(4), (ny + 1, nx + 1, 1))  # that of the first column with these heights
    for corner, other in ((1, 0), (2, 0), (3, 0), (2, 1), (3, 1), (3, 2)):
        is_same = (around[..., corner] == around[..., other]).all(axis=0) & (line[..., corner] == corner)
        line[is_same, corner] = line[is_same, other]
    line[column < 0] = 4
    first = line.min(axis=2, keepdims=True)
    is_further = (column >= 0) & (line == np.arange(4)) & (line != first)
    j, i, at = np.nonzero(is_further)
    heights = np.take_along_axis(around, first[None], axis=3).reshape(nz + 1, -1)
    heights = np.concatenate([heights, around[:, j, i, at]], axis=1)
    number = np.zeros(line.shape, np.int64)
    number[is_further] = np.arange(len(j))
    is_user = (column >= 0) & (line != first)
    users = np.take_along_axis(number, np.minimum(line, 3), axis=2)[is_user]
    columns = column[is_user][np.argsort(users, kind="stable")]
    return heights, j * (nx + 1) + i, columns, np.cumsum(np.bincount(users, minlength=len(j)))
