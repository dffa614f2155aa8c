# SPDX-License-Identifier: GPL-3.0-or-later
"""OMF 1, the Open Mining Format, by the library omf: blocks and surfaces as surfaces, boreholes as lines,
their picks as points, regular cells as a volume.

Data of triangles, segments, points and cells are numbers with legends: `surface`, `neighbor`, `property`,
`block`, `hole`.
"""

from __future__ import annotations

import datetime
import json
import uuid
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...base.atomic import Outputs
from ...base.packages import omf_library, quiet
from ...base.text import Step
from ...cells.model_data import ModelData
from ...results.samples import CellSize, RegularCells, regular_cells
from ...results.sections.section_data import rgb_bytes
from ..shapes.shape_parts import Part
from .object_contents import BlockShell, Contents, Hole, SurfaceShape, largest_share, stable_uuid

_LONG_AGO = datetime.datetime(1970, 1, 1)  # of all that the library dates: the same model has the same bytes


def write_omf(model: ModelData, path: Path, outputs: Outputs, step: Step, cell_size: CellSize = None) -> None:
    """Writes a model. cell_size: of the cells of a block model, as of Model.save; None: none."""
    omf = omf_library("writing OMF")
    contents = Contents.of(model)
    step(0.2)
    with quiet():
        elements = _Elements(omf, model, contents)
        omf_elements = elements.all()
        step(0.4)
        if cell_size is not None:
            cells = regular_cells(model, cell_size, lambda share: step(0.4 + 0.3 * share))
            omf_elements.append(elements.cells(cells))
        step(0.7)
        project = omf.Project(
            name=model.project.name,
            description=f"RealModel, in {crs}" if (crs := model.project.crs) else "RealModel",
            units=model.project.units,
            elements=omf_elements,
        )
        project.validate()
        _date(project, "project")
        with outputs.path(path) as target, target.open("wb") as file:
            _write(omf, project, file)
    step(1.0)


def _write(omf: Any, project: Any, file: BinaryIO) -> None:
    """As the library's OMFWriter does, which wants a name in small letters."""
    writer = omf.OMFWriter
    writer.initialize_header(file, project.uid)
    text = json.dumps(project.serialize(open_file=file, skip_validation=True))
    writer.update_header(file)
    file.write(text.encode())


def _date(entity: Any, *words: str) -> None:
    """Gives an entity and all in it identifiers and dates that are always the same."""
    entity._backend.update(uid=stable_uuid("omf", *words), date_created=_LONG_AGO, date_modified=_LONG_AGO)
    for name, value in list(entity._backend.items()):
        inner = value if isinstance(value, list) else [value]
        for number, member in enumerate(inner):
            if hasattr(member, "_backend") and isinstance(member._backend.get("uid"), uuid.UUID):
                _date(member, *words, name, str(number))


class _Elements:
    """Makes the elements of a project."""

    def __init__(self, omf: Any, model: ModelData, contents: Contents):
        self._omf, self._model, self._contents = omf, model, contents
        self._block_names = contents.block_names

    def all(self) -> list:
        """All but the cells."""
        contents = self._contents
        elements = [self._block(shell) for shell in contents.blocks]
        elements += [self._surface(shape) for shape in contents.surfaces]
        if any(hole.blocks for hole in contents.holes):
            elements.append(self._boreholes([hole for hole in contents.holes if hole.blocks]))
        if contents.holes:
            elements.append(self._picks(contents.holes))
        return elements

    def _block(self, shell: BlockShell) -> Any:
        block = self._model.blocks[shell.number]
        rock = self._model.project.rocks[block.rock].name
        data = [
            self._mapped("surface", "faces", shell.surface, self._contents.boundary_names),
            self._mapped("neighbor", "faces", shell.neighbor, self._block_names),
            self._property(shell),
        ]
        text = f"Block of rock mass {rock}; property {block.property}; volume {block.volume!r}"
        return self._triangles(shell.part, text, data)

    def _property(self, shell: BlockShell) -> Any:
        """The property of a block, the same on each triangle, with a legend for each thing known of it."""
        indices = np.zeros(len(shell.surface), np.int64)
        data = self._mapped("property", "faces", indices, [shell.part.material])
        legends = [self._legend("id", self._omf.ScalarArray(np.array([shell.part.property])))]
        for key, value in shell.known.items():
            if key == "name":  # it is the legend of the numbers
                continue
            is_text = isinstance(value, str)
            array = (
                self._omf.StringArray(array=[value]) if is_text else self._omf.ScalarArray(np.array([value]))
            )
            legends.append(self._legend(key, array))
        data.legends = [*data.legends, *legends]
        return data

    def _surface(self, shape: SurfaceShape) -> Any:
        data = [
            self._omf.ScalarData(name=name, location="vertices", array=self._omf.ScalarArray(values))
            for name, values in shape.values.items()
        ]
        return self._triangles(shape.part, shape.group, data)

    def _triangles(self, part: Part, description: str, data: list) -> Any:
        omf = self._omf
        return omf.SurfaceElement(
            name=part.name,
            description=description,
            color=tuple(rgb_bytes(np.array(part.color)).tolist()),
            geometry=omf.SurfaceGeometry(
                vertices=omf.Vector3Array(part.vertices),
                triangles=omf.Int3Array(part.triangles.astype(np.int64)),
            ),
            data=data,
        )

    def _boreholes(self, holes: Sequence[Hole]) -> Any:
        omf = self._omf
        sizes = [len(hole.places) for hole in holes]
        first = np.cumsum([0, *sizes[:-1]])
        begins = np.concatenate([at + np.arange(size - 1) for at, size in zip(first, sizes, strict=True)])
        number = np.arange(len(holes))
        names = [hole.name for hole in holes]
        blocks = np.concatenate([hole.blocks for hole in holes])
        surfaces = [surface for hole in holes for surface in hole.surfaces]
        picked = sorted({surface for surface in surfaces if surface})
        at_places = [picked.index(surface) if surface else -1 for surface in surfaces]
        return omf.LineSetElement(
            name="boreholes",
            subtype="borehole",
            color="gray",
            geometry=omf.LineSetGeometry(
                vertices=omf.Vector3Array(np.concatenate([hole.places for hole in holes])),
                segments=omf.Int2Array(np.column_stack([begins, begins + 1])),
            ),
            data=[
                self._mapped("hole", "segments", np.repeat(number, np.array(sizes) - 1), names),
                self._mapped("block", "segments", blocks, self._block_names),
                self._mapped("hole", "vertices", np.repeat(number, sizes), names),
                self._mapped("surface", "vertices", at_places, picked),
            ],
        )

    def _picks(self, holes: Sequence[Hole]) -> Any:
        omf = self._omf
        picks = [
            (place, number, surface)
            for number, hole in enumerate(holes)
            for place, surface in zip(hole.places, hole.surfaces, strict=True)
            if surface
        ]
        surfaces = list(dict.fromkeys(surface for *_, surface in picks))
        return omf.PointSetElement(
            name="picks",
            color="gray",
            geometry=omf.PointSetGeometry(
                vertices=omf.Vector3Array(np.array([place for place, *_ in picks]))
            ),
            data=[
                self._mapped("hole", "vertices", [at for _, at, _ in picks], [hole.name for hole in holes]),
                self._mapped("surface", "vertices", [surfaces.index(name) for *_, name in picks], surfaces),
            ],
        )

    def cells(self, cells: RegularCells) -> Any:
        """A block model: of each cell the block with the largest share, and all shares. The last axis, w,
        runs first."""
        omf = self._omf
        shares = cells.shares.transpose(0, 3, 2, 1).reshape(len(self._block_names), -1)
        largest = largest_share(shares)
        tensors = {
            f"tensor_{axis}": np.full(count, width)
            for axis, count, width in zip("uvw", cells.counts, cells.size.tolist(), strict=True)
        }
        data = [self._mapped("block", "cells", largest, self._block_names)]
        data += [
            omf.ScalarData(name=f"share {name}", location="cells", array=omf.ScalarArray(share))
            for name, share in zip(self._block_names, shares, strict=True)
        ]
        return omf.VolumeElement(
            name="cells",
            color="gray",
            geometry=omf.VolumeGridGeometry(origin=cells.origin, **tensors),
            data=data,
        )

    def _mapped(
        self, name: str, location: str, indices: Sequence[int] | np.ndarray, names: Iterable[str]
    ) -> Any:
        """Numbers in a list of names."""
        omf = self._omf
        return omf.MappedData(
            name=name,
            location=location,
            indices=omf.ScalarArray(np.asarray(indices, np.int64)),
            legends=[self._legend("name", omf.StringArray(array=list(names)))],
        )

    def _legend(self, name: str, values: Any) -> Any:
        return self._omf.Legend(name=name, values=values)
