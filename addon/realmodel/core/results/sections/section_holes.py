# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes and sections: the lines of holes, with the blocks that were logged or picked along them, as far
as they lie beside a section; and lines in plan through holes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...base.algebra import begins_run, norm
from ...base.errors import InputRefused, UsageError, number_list
from ...cells.model_data import ModelData
from ...project.project import Project, Rock
from ...readers.tables.interval_values import IntervalValues
from ...readers.tables.observations import Observations

UNKNOWN = -1  # block of a part of a hole that nothing is known of
_BEYOND = 0.05  # of its length: how far a line continues at both ends, where nothing is given


@dataclass(frozen=True, eq=False)
class HoleLine:
    """A borehole. places: (N, 3) float64 along it, from above. blocks: (N - 1,) int32, the number of the
    model's block that is known of each part, UNKNOWN for none."""

    name: str
    places: np.ndarray
    blocks: np.ndarray


def hole_lines(model: ModelData) -> list[HoleLine]:
    """The boreholes of a model: with intervals by these; with picks alone below a pick the block beneath its
    surface, above the first one that over it."""
    lines, first = [], 0
    for rock in model.project.rocks:
        names = [surface.name for surface in rock.surfaces]
        numbers = {block.surface: n for n, block in enumerate(model.blocks)}
        below = [numbers.get(first + at, UNKNOWN) for at in range(len(names))]
        blocks = dict(zip(rock.block_names(), below, strict=True)) | dict(zip(names, below, strict=True))
        for n, block in enumerate(model.blocks):
            blocks.setdefault(block.name, n)
        logged = [] if rock.observed is None else list(_of_logs(rock.observed, blocks))
        lines += logged
        lines += _of_picks(rock, below, {hole.name for hole in logged})
        first += len(names)
    return lines


def _of_logs(observations: Observations, blocks: dict[str, int]) -> Iterator[HoleLine]:
    observations = observations.along_holes()
    for name in dict.fromkeys(observations.holes.tolist()):
        log = observations.some(observations.holes == name)
        if not name or len(log) < 2:
            continue
        same = log.goes_on[1:]
        of_parts = [blocks.get(block, UNKNOWN) for block in log.blocks[1:].tolist()]
        yield HoleLine(name, *_joined(log.places, np.where(same, of_parts, UNKNOWN)))


def _of_picks(rock: Rock, below: list[int], logged: set[str]) -> Iterator[HoleLine]:
    number = {surface.name: at for at, surface in enumerate(rock.surfaces)}
    for name, (collar, picks) in rock.hole_picks.items():
        met = [(surface, place) for surface, place in picks if surface in number]
        if name in logged or not met:
            continue
        over = number[met[0][0]] + 1
        stops = [] if collar is None else [(below[over] if over < len(below) else UNKNOWN, collar)]
        stops += [(below[number[surface]], place) for surface, place in met]
        stops += [(UNKNOWN, rock.hole_ends[name])] if name in rock.hole_ends else []
        if len(stops) > 1:
            places = np.array([place for _, place in stops], np.float64)
            yield HoleLine(name, *_joined(places, np.array([block for block, _ in stops[:-1]])))


def _joined(places: np.ndarray, blocks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Without parts of no length."""
    differs = np.append(True, (places[1:] != places[:-1]).any(axis=1))
    return places[differs], blocks[differs[1:]].astype(np.int32)


def near_plane(
    begin: np.ndarray, end: np.ndarray, plane: tuple[np.ndarray, np.ndarray], width: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The parts of lines from begin to end, (N, 3) each, that lie within a width of a plane on each side of
    it: the numbers (K,) of the lines, and both ends (K, 3) of the parts, moved onto the plane. plane: its
    point and normal."""
    begin, end = (np.asarray(places, np.float64).reshape(-1, 3) for places in (begin, end))
    point, normal = (np.asarray(vector, np.float64) for vector in plane)
    normal = normal / norm(normal)
    away = [((places - point) * normal).sum(axis=1) for places in (begin, end)]
    way = away[1] - away[0]
    low, high = np.zeros(len(begin)), np.ones(len(begin))
    for side in (-width, width):
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (side - away[0]) / way
        enters = way * side < 0  # the line comes from beyond this side
        low = np.where(enters & (way != 0), np.maximum(low, share), low)
        high = np.where(~enters & (way != 0), np.minimum(high, share), high)
    numbers = np.flatnonzero((low < high) & ((way != 0) | (np.abs(away[0]) <= width)))
    ends = []
    for share in (low[numbers], high[numbers]):
        at = begin[numbers] + share[:, None] * (end - begin)[numbers]
        ends.append(at - (away[0][numbers] + share * way[numbers])[:, None] * normal)
    return numbers, *ends


def near_panel(
    begin: np.ndarray,
    end: np.ndarray,
    plane: tuple[np.ndarray, np.ndarray],
    width: float,
    span: tuple[np.ndarray, np.ndarray] | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As near_plane, of a plane that is cut to a panel. span: both ends (2,) of this in plan; None: the whole
    plane."""
    numbers, begin, end = near_plane(begin, end, plane, width)
    if span is None or not len(numbers):
        return numbers, begin, end
    middle, way = 0.5 * (begin + end)[:, :2], span[1] - span[0]
    share = ((middle - span[0]) * way).sum(axis=1) / (way * way).sum()
    inside = (share >= 0.0) & (share <= 1.0)
    return numbers[inside], begin[inside], end[inside]


def parts_near(
    holes: Iterable[HoleLine],
    plane: tuple[np.ndarray, np.ndarray],
    width: float,
    span: tuple[np.ndarray, np.ndarray] | None = None,
) -> list[HoleLine]:
    """What of holes lies within a width of a plane, moved onto it. span: as of near_panel."""
    parts = []
    for hole in holes:
        numbers, begin, end = near_panel(hole.places[:-1], hole.places[1:], plane, width, span)
        for run in _runs(numbers):
            places = np.concatenate([begin[run], end[run[-1:]]])
            parts.append(HoleLine(hole.name, places, hole.blocks[numbers[run]]))
    return parts


def _runs(numbers: np.ndarray) -> Iterator[np.ndarray]:
    """The places of numbers that follow one another."""
    starts = [0, *(np.flatnonzero(np.diff(numbers) != 1) + 1).tolist(), len(numbers)]
    for a, b in pairwise(starts):
        if b > a:
            yield np.arange(a, b)


def hole_values(project: Project) -> IntervalValues | None:
    """The values along the boreholes of a project; None where there are none."""
    parts = [rock.hole_values for rock in project.rocks if rock.hole_values is not None]
    return IntervalValues.joined(parts) if parts else None


def hole_places(project: Project) -> dict[str, np.ndarray]:
    """(3,) where each borehole of a project begins: its collar, or the highest of its data. Of two holes of
    one name that of the first rock mass."""
    places: dict[str, np.ndarray] = {}
    for rock in project.rocks:
        for name, (collar, picks) in rock.hole_picks.items():
            place = collar if collar is not None else picks[0][1] if picks else None
            if place is not None:
                places.setdefault(name, np.asarray(place, np.float64))
        for name, log in ({} if rock.observed is None else rock.observed.logs()).items():
            places.setdefault(name, log.places[0])
    return places


def line_through(
    places: Mapping[str, np.ndarray], holes: Sequence[str], extend: float | None = None
) -> np.ndarray:
    """(N, 2) float64: a line in plan through holes, in their order, that continues by `extend` at both ends;
    None: by a twentieth of its length. places: where the holes are. Raises InputRefused for an unknown hole,
    or holes at fewer than two places, UsageError."""
    if extend is not None and not (np.isfinite(extend) and extend >= 0):
        raise UsageError(f"extend must be 0 or more, not {extend!r}")
    if unknown := [name for name in holes if name not in places]:
        choices = number_list(sorted(places)) if places else "there are none"
        raise InputRefused(f"there is no hole {number_list(unknown)}", advice=f"holes: {choices}")
    line = np.array([places[name][:2] for name in holes], np.float64).reshape(-1, 2)
    line = line[begins_run(line)]
    if len(line) < 2:
        raise InputRefused(
            "a section needs holes at two places at least", advice="name two holes that are apart"
        )
    steps = norm(np.diff(line, axis=0))
    length = _BEYOND * float(steps.sum()) if extend is None else extend
    first = line[0] + (line[0] - line[1]) * (length / steps[0])
    last = line[-1] + (line[-1] - line[-2]) * (length / steps[-1])
    return np.vstack([[first], line[1:-1], [last]])
