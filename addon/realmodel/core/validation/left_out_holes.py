# SPDX-License-Identifier: GPL-3.0-or-later
"""Cross-validation by holes: what a model has where a hole is that it knows nothing of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..base.algebra import norm
from ..base.errors import InputRefused, UsageError
from ..base.named import keyword_only
from ..base.work import Cancel, Progress, Work, run
from ..cells.model_data import ModelData
from ..heights.left_out_places import in_turn, places_of
from ..project.project import Project, Rock
from ..readers.tables.observations import Observations, in_one_interval
from ..structures.setup import make_surfaces, mesh_inputs, read_inputs
from ..surfaces.observed.derived import BlockNumbers
from ..surfaces.rock_input import RockInput
from .closed_form import AIR, ClosedForm, surface_forms
from .observed import PLACES, places_along

DEFAULT_FOLDS = 20  # holes are left out in so many groups, where they are more


@dataclass(frozen=True)
class LeftOutContact:
    """Where a hole that was left out met a surface. depth: along the hole, None where it is not known. place:
    (x, y, z). error: the height of the surface that was made without the hole, less that of the place; None
    where it has none."""

    surface: str
    depth: float | None
    place: tuple[float, float, float]
    error: float | None


@dataclass(frozen=True)
class LeftOutHole:
    """A hole of a rock mass that was left out. length: of its logged intervals, model units; share: of it in
    the right block, None where it has none; intervals of bodies are ignored. contacts: where it met surfaces.
    refused: why no surfaces can be made without it, "" where they can."""

    rock: str
    hole: str
    length: float
    share: float | None
    contacts: tuple[LeftOutContact, ...] = ()
    refused: str = ""

    @property
    def errors(self) -> np.ndarray:
        """(E,) the known errors of its contacts."""
        return np.array([contact.error for contact in self.contacts if contact.error is not None])


@dataclass(frozen=True)
class HoleValidation:
    """Cross-validation by holes: how well models without each hole predict it. holes: as the rock masses have
    them. groups: the number of groups in which they were left out."""

    holes: list[LeftOutHole] = field(default_factory=list)
    groups: int = 0

    @property
    def share(self) -> float | None:
        """The share of the length of all holes in the right block; None where no hole has intervals."""
        total = sum(hole.length for hole in self.holes)
        inside = sum(hole.length * hole.share for hole in self.holes if hole.share is not None)
        return inside / total if total else None

    @property
    def errors(self) -> np.ndarray:
        """(E,) the known errors of the contacts of all holes."""
        return np.concatenate([np.empty(0), *(hole.errors for hole in self.holes)])

    def summary(self) -> str:
        """A line about all of it."""
        errors = self.errors
        share = "" if self.share is None else f", {100 * self.share:.1f} % of their length in the right block"
        heights = ""
        if len(errors):
            worst = float(np.abs(errors).max())
            rmse, middle = float(np.sqrt((errors**2).mean())), float(np.median(np.abs(errors)))
            heights = (
                f"; elevations of {len(errors)} contacts: root mean square error {rmse:.4g}, median "
                f"{middle:.4g}, largest {worst:.4g}"
            )
        refused = sum(bool(hole.refused) for hole in self.holes)
        lost = f"; without {refused} of them there are no surfaces" if refused else ""
        return f"{len(self.holes)} holes left out in {self.groups} groups{share}{heights}{lost}"


@keyword_only
def cross_validate_holes(
    model: ModelData,
    folds: int | None = None,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> HoleValidation:
    """Makes the surfaces of a `model` again without each hole: without its contacts, its intervals and the
    bounds that follow, all at once. For each hole it computes the share of its length in the right block, and
    the errors of its contacts, in models of the other holes.

    folds: the number of groups in which holes are left out; None: each hole separately, but in at most 20
    groups. Holes that are clustered, as twins are, are left out together (places_of). Outcrops, dips and
    points that no hole met stay. Variograms are fitted anew each time, and "auto" stays what it chose.

    Raises InputRefused for a model without holes, or of a file without its project; UsageError, Cancelled.
    """
    return run(lambda work: validated_holes(work, model, folds), progress, cancel, threads=threads)


def validated_holes(work: Work, model: ModelData, folds: int | None = None) -> HoleValidation:
    """cross_validate_holes as the present phase of the work."""
    model.require_project("cross-validation")
    if folds is not None and (isinstance(folds, bool) or not isinstance(folds, int) or folds < 2):
        raise UsageError(f"folds must be a whole number from 2, not {folds!r}")
    rocks = [entry.rock for entry in model.rock_inputs]
    holes = [[(number, hole) for hole in _holes_of(rock)] for number, rock in enumerate(rocks)]
    every = [hole for rock_holes in holes for hole in rock_holes]
    if len(every) < 2:
        raise InputRefused(
            f"the model has {len(every)} holes: leaving one out takes two or more",
            advice="give boreholes with intervals or picks",
        )
    turns = in_turn(_places(work, rocks, every), folds or DEFAULT_FOLDS)
    results: dict[tuple[int, str], LeftOutHole] = {}
    groups = len(turns)
    for group, chosen in enumerate(turns):
        out = [every[number] for number in np.flatnonzero(chosen).tolist()]
        with work.part(group / groups, (group + 1) / groups):
            try:
                results |= _without(work, model.project, model.rock_inputs, out)
            except InputRefused as error:
                lost = [LeftOutHole(rocks[n].name, hole, 0.0, None, (), str(error)) for n, hole in out]
                results |= dict(zip(out, lost, strict=True))
    return HoleValidation([results[hole] for hole in every], groups)


def _holes_of(rock: Rock) -> list[str]:
    """The holes of a rock mass that have intervals or picks, in their order."""
    observed = rock.observed
    logged = [] if observed is None else [hole for hole in observed.holes.tolist() if hole]
    picked = [hole for hole, (_, picks) in rock.hole_picks.items() if picks]
    return list(dict.fromkeys([*logged, *picked]))


def _places(work: Work, rocks: Sequence[Rock], every: Sequence[tuple[int, str]]) -> np.ndarray:
    """(H,) the numbers of the places of holes, (rock mass, name): twins are at one place."""
    plan = np.zeros((len(every), 2))
    for row, (number, hole) in enumerate(every):
        observed = rocks[number].observed
        met = [place for _, place in rocks[number].hole_picks.get(hole, (None, ()))[1]]
        logged = [] if observed is None else observed.places[observed.holes == hole].tolist()
        plan[row] = np.mean([place[:2] for place in (*met, *logged)], axis=0)
    places = places_of(work, plan)
    return np.arange(len(every)) if places is None else places


def _without(
    work: Work, project: Project, inputs: Sequence[RockInput], out: Sequence[tuple[int, str]]
) -> dict[tuple[int, str], LeftOutHole]:
    """What the surfaces made without some holes, (rock mass, name), say of these."""
    rocks = [
        _rock_without(entry, {hole for number, hole in out if number == n}) for n, entry in enumerate(inputs)
    ]
    with work.phase(0.0, 0.1, "leaving out holes"):
        without, reduced = read_inputs(work, replace(project, rocks=rocks))
    with work.part(0.1, 0.4):
        mesh_inputs(work, without)
    with work.part(0.4, 1.0):
        structures = make_surfaces(work, reduced, without, None)
    forms = surface_forms(without, structures)
    return {(number, hole): _judged(work, inputs[number], forms[number], hole) for number, hole in out}


def _rock_without(entry: RockInput, holes: set[str]) -> Rock:
    """The rock mass of a RockInput without what some holes say."""
    rock, observed, left_out = entry.rock, entry.rock.observed, sorted(holes)
    if not holes:
        return rock
    surfaces = []
    for surface, data in zip(rock.surfaces, entry.data, strict=True):
        gone = [row for row, sources in data.picks.items() if not holes.isdisjoint(s.hole for s in sources)]
        points = np.delete(data.own, gone, axis=0)
        is_some = surface.has_points and len(points)
        surfaces.append(replace(surface, points=points if is_some else None))
    observations = None if observed is None else observed.some(~np.isin(observed.holes, left_out))
    picks = {hole: hole_picks for hole, hole_picks in rock.hole_picks.items() if hole not in holes}
    return replace(rock, surfaces=surfaces, observations=observations, hole_picks=picks)


def _judged(work: Work, entry: RockInput, form: ClosedForm, hole: str) -> LeftOutHole:
    rock, observed = entry.rock, entry.rock.observed
    length, share = 0.0, None
    if observed is not None:
        length, share = _length_in_block(work, rock, form, observed.some(observed.holes == hole))
    contacts = []
    for number, (surface, data) in enumerate(zip(rock.surfaces, entry.data, strict=True)):
        depths = {
            tuple(data.points[row].tolist()): source.depth
            for row, sources in sorted(data.sources.items(), reverse=True)
            for source in sources
            if source.hole == hole
        }
        if depths:
            above = form.above(work, number, np.array(list(depths)))
            for (place, depth), away in zip(depths.items(), above.tolist(), strict=True):
                error = None if away != away else away
                contacts.append(LeftOutContact(surface.name, depth, place, error))
    return LeftOutHole(rock.name, hole, length, share, tuple(contacts))


def _length_in_block(
    work: Work, rock: Rock, form: ClosedForm, log: Observations
) -> tuple[float, float | None]:
    """The length of the intervals of a hole, and the share of it in the right block."""
    blocks = BlockNumbers(rock).of(log.blocks)
    if form.base_elevation is None:
        blocks[blocks == 0] = -1  # without a base there is no such block
    ends = np.flatnonzero(in_one_interval(log, log.in_use & (blocks >= 0)))
    if not len(ends):
        return 0.0, None
    lengths = norm(log.places[ends] - log.places[ends - 1])
    blocks_met = form.blocks_at(work, places_along(log, ends)).reshape(-1, PLACES)
    numbers = np.array(form.blocks)
    right = (blocks_met == numbers[blocks[ends]][:, None]) & (blocks_met != AIR)
    total = float(lengths.sum())
    return total, float((right.mean(axis=1) * lengths).sum() / total) if total else None
