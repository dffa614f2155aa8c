# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of places that are known to lie in a block: outcrops, samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...base.errors import InputRefused
from ...base.text import Step, no_step
from ...base.units import MODEL_UNIT, factors
from ...settings.observation_file import ObservationFile
from .hole_tables import OBSERVED, Row, rows
from .observations import LeftOut, Observations, unknown_block
from .unit_names import UnitNames


def read_observed_places(
    given: ObservationFile, units: UnitNames, model_unit: str = MODEL_UNIT, step: Step = no_step
) -> tuple[Observations, list[LeftOut]]:
    """The places of a table, in the model's unit and in its order, and those that are not used. Raises
    InputRefused naming file and line."""
    plan, height = factors(given.units, model_unit)
    scale = np.array([plan, plan, height])
    places, blocks, holes, depths, used, on, errors = [], [], [], [], [], [], []
    left_out: list[LeftOut] = []
    count = 0
    for row in rows(given, Path(given.file), OBSERVED, ("x", "y", "z", "block"), step):
        count += 1
        code = row.text("block")
        if units.says_nothing(code):
            continue
        hole = row.text("hole") if row.has("hole") else ""
        depth = row.number("depth") if row.has("depth") else float("nan")
        block = units.block(code)
        where = f"line {row.line}, '{code}'"
        lacking = [axis for axis in "xyz" if not row.has(axis)]
        if lacking:
            left_out.append(LeftOut("no_depth", f"{where}: '{lacking[0]}' has no value", code, hole))
            continue
        place = np.array([row.number(axis) for axis in "xyz"]) * scale
        if block is None:
            left_out.append(unknown_block(where, code, hole, place=tuple(place.tolist())))
            continue
        places.append(place)
        blocks.append(block)
        holes.append(hole)
        depths.append(depth)
        used.append(row.is_used)
        on.append(_surface(row, units))
        errors.append(_height_error(row) * height)
    if not count:
        raise InputRefused("there are no observations in it", file=given.file)
    texts = np.array(blocks, str), np.array(holes, str)
    in_use = np.array([] if all(used) else used, bool)
    seen_on = np.array(on if any(on) else [], str)
    observed = Observations(
        np.array(places).reshape(-1, 3),
        *texts,
        np.array(depths),
        used=in_use,
        on=seen_on,
        height_errors=np.array(errors if any(errors) else []),
    )
    return observed, left_out


def _height_error(row: Row) -> float:
    error = row.number("error") if row.has("error") else 0.0
    if error < 0:
        raise row.refuse(f"the error of the height, {error:g}, is negative", "leave it empty where it is 0")
    return error


def _surface(row: Row, units: UnitNames) -> str:
    """The surface on which a place was seen; "" for none."""
    code = row.text("on") if row.has("on") else ""
    name = units.surface(code) if code else ""
    if name and name not in units.surfaces:
        raise row.refuse(f"'{code}' is no surface of the rock mass", "leave it empty, or name a surface")
    return name
