# SPDX-License-Identifier: GPL-3.0-or-later
"""What is found in a model as tables: DataFrames of pandas, and maps as Datasets of xarray."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..base.packages import extra
from ..cells.blocks import Block
from ..cells.model_data import ModelData
from ..notebook import data_frame
from ..project.project import Project
from .model_holes import Interval
from .samples import plan_grids

if TYPE_CHECKING:
    import pandas
    import xarray

_BLOCK = ("name", "rock", "surface", "property", "property_name", "volume", "share", "cells", "components")
_INTERVAL = ("block", "name", "property", "top", "bottom", "length")


class WithBlocks(Protocol):
    """A Model, or a TiledModel, as tables take it."""

    @property
    def blocks(self) -> Sequence[Block]: ...
    @property
    def project(self) -> Project: ...
    @property
    def surface_names(self) -> Sequence[str]: ...
    @property
    def volume(self) -> float: ...


class WithBoreholes(WithBlocks, Protocol):
    """The same, where it is asked along vertical lines, too."""

    def borehole(self, x: float, y: float) -> list[Interval]: ...


def block_entry(model: WithBlocks, number: int, total: float) -> dict:
    """What is known of a block, by the names of the report. total: the volume of all blocks."""
    block, library = model.blocks[number], model.project.library
    entry = library.get(block.property) if library else None
    return {
        "name": block.name,
        "rock": model.project.rocks[block.rock].name,
        "surface": model.surface_names[block.surface],
        "property": block.property,
        "property_name": entry.name if entry else None,
        "volume": block.volume,
        "share": block.volume / total if total else 0.0,
        "cells": block.cells,
        "components": block.components,
    }


def block_table(model: WithBlocks) -> pandas.DataFrame:
    """The blocks, a row for each, from the oldest of each rock mass: `name`, `rock`, `surface` (that it was
    deposited beneath), `property` (library id, 0: none), `property_name`, `volume` (model units cubed),
    `share` of the volume of all blocks (from 0 to 1), `cells`, `components` (connected components). The index
    `block` is the number that cell_block and sections have.

    Raises UsageError where pandas is missing.

    >>> model.block_table()[["name", "volume"]]
           name  volume
    block
    0      clay    30.0
    1      sand    10.0
    2      soil     8.0
    """
    total = model.volume
    rows = (block_entry(model, number, total) for number in range(len(model.blocks)))
    return data_frame(rows, _BLOCK).rename_axis("block")


def borehole_table(model: WithBoreholes, x: float, y: float) -> pandas.DataFrame:
    """The intervals of `borehole` at the position (x, y), a row for each, from above downward: `block` (its
    number), `name`, `property` (library id, 0: none), and `top`, `bottom` and `length`, model units.

    Raises UsageError where pandas is missing.

    >>> model.borehole_table(3.5, 1.0)
       block  name  property  top  bottom  length
    0      2  soil         0  4.5     3.0     1.5
    1      1  sand         0  3.0     2.0     1.0
    2      0  clay         0  2.0     0.0     2.0
    """
    rows = [
        {
            "block": interval.block,
            "name": model.blocks[interval.block].name,
            "property": model.blocks[interval.block].property,
            "top": interval.top,
            "bottom": interval.bottom,
            "length": interval.length,
        }
        for interval in model.borehole(x, y)
    ]
    return data_frame(rows, _INTERVAL)


def map_dataset(model: ModelData, cell_size: float | Sequence[float] | None = None) -> xarray.Dataset:
    """Maps of the model at the centers of cells in plan, exact there, as a Dataset of xarray: `elevation`
    (y, x) of the highest rock, NaN where there is none; `top` (block, y, x) of each block, NaN where it is
    not; `thickness` (block, y, x), 0 where it is not, of all its parts over the place together;
    `true_thickness` (block, y, x), how far its top is from its base there, perpendicular to this. The
    coordinates `x` and `y` are the centers, y from north to south, `block` the number of the block and
    `block_name` its name. All values are float64 in model units, which `attrs["units"]` names.

    cell_size: of the cells in plan, one number or two, model units; None: a hundredth of the longest side.
    Raises UsageError where xarray is missing, or for cells that are too many or have no size.

    >>> maps = model.to_xarray(cell_size=0.5)
    >>> maps.thickness.sel(block=1, x=3.75, y=0.25).item()
    1.0
    """
    grids = plan_grids(model, cell_size)
    (west, north), (dx, dy) = grids.north_west, grids.size
    rows, columns = grids.top.shape
    units = {"units": model.project.units}

    def variable(
        names: tuple[str, ...], values: ArrayLike, title: str, attrs: dict[str, str] = units
    ) -> tuple:
        return names, values, {"long_name": title, **attrs}

    plan, stack = ("y", "x"), ("block", "y", "x")
    return extra("xarray", "to_xarray()").Dataset(
        {
            "elevation": variable(plan, grids.top, "elevation of the highest rock"),
            "top": variable(stack, grids.upper, "elevation of the top of the block"),
            "thickness": variable(stack, grids.thickness, "thickness of the block"),
            "true_thickness": variable(stack, grids.true_thickness, "true thickness of the block"),
        },
        {
            "x": variable(("x",), west + dx * (np.arange(columns) + 0.5), "easting"),
            "y": variable(("y",), north - dy * (np.arange(rows) + 0.5), "northing"),
            "block": variable(("block",), np.arange(len(model.blocks)), "number of the block", {}),
            "block_name": variable(("block",), [b.name for b in model.blocks], "name of the block", {}),
        },
        {"title": model.project.name},
    )
