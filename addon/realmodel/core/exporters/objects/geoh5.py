# SPDX-License-Identifier: GPL-3.0-or-later
"""geoh5, the files of Geoscience ANALYST, by the library geoh5py: blocks and surfaces as surfaces in groups,
boreholes as drillholes, regular cells as a block model.

Data of triangles, intervals and cells are numbers with names: `surface`, `neighbor`, `property`, `block`.
"""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.atomic import Outputs
from ...base.packages import extra
from ...base.text import Step
from ...cells.model_data import ModelData
from ...results.samples import CellSize, RegularCells, regular_cells
from ...results.sections.section_data import rgb_bytes
from .object_contents import BlockShell, Contents, Hole, SurfaceShape, largest_share, stable_uuid

_UNITS = {"m": "meter", "ft": "feet"}  # those that a workspace has
_OUTSIDE = 0  # the number that the format keeps for what is not known


def write_geoh5(
    model: ModelData, path: Path, outputs: Outputs, step: Step, cell_size: CellSize = None
) -> None:
    """Writes a model. cell_size: of the cells of a block model, as of Model.save; None: none."""
    library = extra("geoh5py", "writing geoh5", "geoh5")
    contents = Contents.of(model)
    step(0.2)
    with outputs.path(path) as target:
        plain = Path(target).with_suffix(".geoh5")  # the library takes no other letters
        workspace = _workspace_class(library).create(
            plain, contributors=("RealModel",), distance_unit=_UNITS.get(model.project.units, "meter")
        )
        with workspace:
            made = _Objects(workspace, model, contents)
            made.write()
            step(0.5)
            if cell_size is not None:
                made.cells(regular_cells(model, cell_size, lambda share: step(0.5 + 0.4 * share)))
        plain.replace(target)
    step(1.0)


def _workspace_class(library: Any) -> Any:
    """A workspace whose root always has the same identifier."""

    class _Workspace(library.Workspace):
        def create_root(
            self, entity_attributes: dict | None = None, type_attributes: dict | None = None
        ) -> Any:
            attributes = {"uid": stable_uuid("geoh5", "root"), **(entity_attributes or {})}
            return super().create_root(attributes, type_attributes)

    return _Workspace


class _Objects:
    """Makes the objects of a workspace."""

    def __init__(self, workspace: Any, model: ModelData, contents: Contents):
        from geoh5py import data, groups, objects

        self._data, self._groups, self._objects = data, groups, objects
        self._workspace, self._model, self._contents = workspace, model, contents
        self._made: dict[str, Any] = {}

    def write(self) -> None:
        """All but the cells."""
        for shell in self._contents.blocks:
            self._block(shell)
        for shape in self._contents.surfaces:
            self._surface(shape)
        for hole in self._contents.holes:
            self._hole(hole)

    def _group(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = self._groups.ContainerGroup.create(
                self._workspace, name=name, uid=stable_uuid("geoh5", "group", name)
            )
        return self._made[name]

    def _create(self, kind: str, name: str, group: str, **attributes: Any) -> Any:
        made = getattr(self._objects, kind).create(
            self._workspace,
            name=name,
            parent=self._group(group),
            uid=stable_uuid("geoh5", "object", group, name),
            **attributes,
        )
        if crs := self._model.project.crs:
            made.coordinate_reference_system = {"Code": crs, "Name": crs}
        return made

    def _block(self, shell: BlockShell) -> None:
        block = self._model.blocks[shell.number]
        made = self._triangles(shell, "Blocks")
        made.metadata = {
            **(made.metadata or {}),
            "RealModel": {
                "rock_mass": self._model.project.rocks[block.rock].name,
                "block": block.name,
                "property": block.property,
                "volume": block.volume,
                **shell.known,
            },
        }
        self._named(made, "surface", "CELL", shell.surface, self._contents.boundary_names)
        self._named(made, "neighbor", "CELL", shell.neighbor, self._contents.block_names)
        self._named(made, "property", "CELL", np.zeros(len(shell.surface), int), [shell.part.material])

    def _surface(self, shape: SurfaceShape) -> None:
        made = self._triangles(shape, shape.group)
        for name, values in shape.values.items():
            self._number(made, name, "VERTEX", values)

    def _triangles(self, shape: BlockShell | SurfaceShape, group: str) -> Any:
        part = shape.part
        cells = part.triangles.astype(np.int32)
        made = self._create("Surface", part.name, group, vertices=part.vertices, cells=cells)
        color = rgb_bytes(np.array(part.color)).tolist()
        self._add(made, "Visual Parameters", "OBJECT", _visual_parameters(color), {"primitive_type": "TEXT"})
        return made

    def _hole(self, hole: Hole) -> None:
        """A drillhole whose intervals are between its places; the directions are those between them."""
        ways, depths = np.diff(hole.places, axis=0), hole.depths
        azimuth = np.degrees(np.arctan2(ways[:, 0], ways[:, 1])) % 360.0
        dip = np.degrees(np.arctan2(ways[:, 2], np.hypot(ways[:, 0], ways[:, 1])))
        rows = np.minimum(np.arange(len(depths)), len(ways) - 1)  # the last direction to the end of the hole
        made = self._create(
            "Drillhole",
            hole.name,
            "Boreholes",
            collar=hole.places[0],
            surveys=np.column_stack([depths, azimuth[rows], dip[rows]]) if len(ways) else None,
            vertices=hole.places,
            end_of_hole=float(depths[-1]),
        )
        names = list(dict.fromkeys(hole.surfaces))
        picks = [names.index(name) for name in hole.surfaces]
        self._number(made, "DEPTH", "VERTEX", depths)
        self._named(made, "surface", "VERTEX", picks, names)
        if len(ways):
            made.cells = np.column_stack([np.arange(len(ways)), np.arange(1, len(ways) + 1)]).astype("uint32")
            self._number(made, "FROM", "CELL", depths[:-1])
            self._number(made, "TO", "CELL", depths[1:])
            self._named(made, "block", "CELL", hole.blocks, self._contents.block_names)

    def cells(self, cells: RegularCells) -> None:
        """A block model: of each cell the block with the largest share, and all shares. Cells run along z
        first, then along x."""
        edges = {
            f"{axis}_cell_delimiters": width * np.arange(count + 1)
            for axis, count, width in zip("uvz", cells.counts, cells.size.tolist(), strict=True)
        }
        made = self._create("BlockModel", "cells", "Cells", origin=cells.origin.tolist(), **edges)
        names = self._contents.block_names
        shares = cells.shares.transpose(0, 2, 3, 1).reshape(len(names), -1)
        self._named(made, "block", "CELL", largest_share(shares), names)
        for name, share in zip(names, shares, strict=True):
            self._number(made, f"share {name}", "CELL", share)

    def _number(self, obj: Any, name: str, where: str, values: np.ndarray) -> None:
        self._add(obj, name, where, np.asarray(values, np.float64), {"primitive_type": "FLOAT"})

    def _named(
        self, obj: Any, name: str, where: str, numbers: Sequence[int] | np.ndarray, names: Sequence[str]
    ) -> None:
        """Numbers in a list of names; -1 is what is not known."""
        values = np.asarray(numbers, np.int64) + 1
        names_by_number = {_OUTSIDE: "Unknown"} | dict(enumerate(names, 1))
        kind = {"primitive_type": "REFERENCED", "value_map": names_by_number}
        self._add(obj, name, where, values.astype(np.int32), kind)

    def _add(self, obj: Any, name: str, where: str, values: Any, kind: dict) -> None:
        words = ("geoh5", "data", obj.parent.name, obj.name, name)
        self._workspace.create_entity(
            self._data.Data,
            entity={
                "parent": obj,
                "association": where,
                "name": name,
                "values": values,
                "uid": stable_uuid(*words),
            },
            entity_type={"name": name, "uid": _type_uid(*words), **kind},
        )


def _type_uid(*words: str) -> uuid.UUID:
    return stable_uuid(*words, "type")


def _visual_parameters(color: Sequence[int]) -> str:
    """The color of an object as Geoscience ANALYST has it: alpha, red, green, blue in one number."""
    red, green, blue = color
    number = 255 << 24 | red << 16 | green << 8 | blue
    return f'<IParameterList Version="1.0"><Colour>{number}</Colour></IParameterList>'
