# SPDX-License-Identifier: GPL-3.0-or-later
"""The unit in which the data of a file lie where the others of its project do, as files may not name it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..base.errors import BuildWarning
from ..base.units import METERS, UNIT_NAMES, factor
from ..project.project import Rock, Surface
from ..project.structure_entries import Shaped
from .rock_input import RockInput

Box = tuple[np.ndarray, np.ndarray]  # the lowest and the highest coordinates in plan

# Units of programs of construction and of surveys, those that are more usual first.
_UNITS = ("mm", "m", "ft", "in", "cm", "km", "us-ft", "yd", "mi")
_NOT_THERE = 0.01  # of the area of both boxes is common, at most
_THERE = 0.3  # at least
_WIDER = 20.0  # than the region, at least, is a body or fault that is there in another unit
_LEAST = 0.02  # of the width of the region
_INSIDE = 0.9  # of the area of a body or fault is within the region, at least


def plan_box(plan: np.ndarray) -> Box:
    """The box of places (P, 2 or 3)."""
    return plan[:, :2].min(axis=0), plan[:, :2].max(axis=0)


def likely_unit(box: Box, region: Box, model_unit: str, is_part: bool = False) -> str | None:
    """The unit, one of METERS, in which data that were read in the unit of the model fill the box of the
    region, where they do not in that of the model: their size or place differs by more than an order of
    magnitude. is_part: they are of a body or a fault, which need not fill the box, but lie within. None where
    no unit makes it so."""
    share, most = (_share_within, _WIDER**-2) if is_part else (_common_share, _NOT_THERE)
    if (there_now := share(box, region)) > most:
        return None
    scales = {unit: factor(unit, model_unit) for unit in _UNITS if METERS[unit] != METERS[model_unit]}
    shares = {unit: share((box[0] * by, box[1] * by), region) for unit, by in scales.items()}
    if is_part:  # a fault may be much wider than the region: in its unit it is no speck there
        least = _LEAST * (region[1] - region[0]).max() if there_now > 0 else 0.0
        widths = {unit: float((box[1] - box[0]).max()) * by for unit, by in scales.items()}
        return next((u for u, there in shares.items() if there > _INSIDE and widths[u] >= least), None)
    best = max(shares, key=lambda unit: shares[unit])
    return best if shares[best] > _THERE else None


def unit_advice(unit: str) -> str:
    """What to write where this unit is the likely one."""
    return f'if its lengths are {UNIT_NAMES[unit].lower()}, write units = "{unit}"'


def surface_unit(entry: RockInput, given: Rock, number: int, model_unit: str) -> str | None:
    """The likely unit of the file of a surface, where no key says it: by the region of its rock mass, or else
    by the other surfaces. given: the rock mass as it was before its files were read."""
    boxes = {n: box for n in range(len(entry.rock.surfaces)) if (box := _box_of(entry, n)) is not None}
    named = {surface.name: surface.mesh_file or surface.point_file for surface in given.surfaces}
    file = named.get(entry.rock.surfaces[number].name)
    if file is None or file.units is not None or number not in boxes:
        return None
    region = _region(entry.rock)
    others = [box for n, box in boxes.items() if n != number] if region is None else [region]
    if not others:
        return None
    low, high = (np.array(ends) for ends in zip(*others, strict=True))
    return likely_unit(boxes[number], (low.min(axis=0), high.max(axis=0)), model_unit)


def surface_unit_warnings(entry: RockInput, given: Rock, model_unit: str) -> list[BuildWarning]:
    """Warnings about surfaces whose lengths are likely in another unit than that in which they are read; as
    surface_unit."""
    warnings = []
    for number, surface in enumerate(entry.rock.surfaces):
        unit = surface_unit(entry, given, number, model_unit)
        if unit is not None:
            read = (
                f"read in {UNIT_NAMES[model_unit].lower()}, it does not have the size or place of the others"
            )
            warnings.append(
                BuildWarning(f"{read}: {unit_advice(unit)}", "units", entry.rock.name, surface.name)
            )
    return warnings


def shape_unit_warnings(
    given: Iterable[Shaped], read: Sequence[Shaped], inputs: Iterable[RockInput], model_unit: str
) -> list[BuildWarning]:
    """The same about faults and bodies. given: with their files; read: the same with arrays."""
    regions = [region for entry in inputs if (region := _region(entry.rock)) is not None]
    warnings = []
    for asked, shape in zip(given, read, strict=True):
        file = asked.mesh_file
        if file is None or file.units is not None or shape.vertices is None or not regions:
            continue
        low, high = (np.array(ends) for ends in zip(*regions, strict=True))
        region = low.min(axis=0), high.max(axis=0)
        unit = likely_unit(plan_box(np.asarray(shape.vertices)), region, model_unit, is_part=True)
        if unit is not None:
            what = f"{asked.item}: read in {UNIT_NAMES[model_unit].lower()}, it does not lie in the region"
            warnings.append(BuildWarning(f"{what}: {unit_advice(unit)}", "units"))
    return warnings


def _region(rock: Rock) -> Box | None:
    return None if rock.region is None else plan_box(np.concatenate(rock.rings()))


def _box_of(entry: RockInput, number: int) -> Box | None:
    surface: Surface = entry.rock.surfaces[number]
    points = entry.data[number].points if entry.rock.is_interpolated(surface) else surface.vertices
    return None if points is None or not len(points) else plan_box(np.asarray(points))


def _area(box: Box) -> float:
    return float(np.maximum(box[1] - box[0], 0.0).prod())


def _common(one: Box, other: Box) -> float:
    return _area((np.maximum(one[0], other[0]), np.minimum(one[1], other[1])))


def _common_share(box: Box, region: Box) -> float:
    """The area of both boxes, as a share of the area of either."""
    common = _common(box, region)
    return common / whole if (whole := _area(box) + _area(region) - common) > 0 else 1.0


def _share_within(box: Box, region: Box) -> float:
    """The share of a box that is within a region; as of a wide one if it has no area."""
    grown = np.maximum(0.5e-3 * (region[1] - region[0]), 1e-9)
    box = box[0] - grown, box[1] + grown
    return _common(box, region) / _area(box)
