# SPDX-License-Identifier: GPL-3.0-or-later
"""What boreholes, observations, maps and dips tell of the surfaces of a rock mass: read, and applied to
them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..base.errors import BuildWarning, counted, naming, number_list
from ..base.work import Work
from ..project.project import Project, Rock, Surface
from ..project.series import Series
from ..project.structure_history import body_times
from ..readers import Picks, UnitNames, read_dips_of_rock, read_observed_places, read_picks
from ..readers.tables.boreholes import Pick
from ..readers.tables.observations import IN_TABLES, KINDS, LeftOut, Observations
from ..settings.dips import Dips, SpaceDips
from ..settings.series_kinds import FIELD, SHEETS
from .map_data import blocks_on_map, read_map, with_ground
from .observed.derived import BlockNumbers, PlaceContext, derive, with_contacts, without_contradictions
from .observed.edge_crossings import with_crossings
from .rock_input import RockInput
from .wrong_sides import heights_at

_LISTED = 12  # observations that a warning names; the report has all


@dataclass
class FieldData:
    """Of one rock mass. rock: with arrays instead of boreholes and observations. picks: of its
    boreholes. surfaces: each as it was before it is read, with the picks to be added to it, or None.
    unnamed: names of picks that no
    surface from points has. left_out: rows of tables that are not used. map_warnings: sentences. ground: the
    number of the surface that is the ground of the map, None for none. mapped: (D,) texts, the blocks that
    the map shows at dips of the rock mass, "" where these do not need it; None without a map."""

    rock: Rock
    picks: Picks
    surfaces: list[tuple[Surface, list[Pick] | None]]
    unnamed: list[str]
    left_out: list[LeftOut]
    map_warnings: list[str]
    ground: int | None
    mapped: np.ndarray | None


def read_field_data(project: Project, rock: Rock) -> FieldData:
    """Reads the boreholes, observations, map and dips of a rock mass. Raises InputRefused."""
    project_rock = rock
    rock, map_warnings = with_ground(rock), list[str]()
    bodies = [body.name for body in project.bodies]
    names = [surface.name for surface in rock.surfaces]
    units = UnitNames(names, rock.block_names(), bodies, rock.names)
    picks, parts = Picks(), [rock.observations] if isinstance(rock.observations, Observations) else []
    with naming(rock.item):
        if rock.boreholes is not None:
            step = rock.edge_length if isinstance(rock.edge_length, (int, float)) else None
            picks = read_picks(rock.boreholes, project.units, units=units, plan_step=step)
            parts += picks.observations
        left_out = list(picks.left_out)
        if rock.observation_file is not None:
            observed, not_used = read_observed_places(rock.observation_file, units, project.units)
            parts.append(observed)
            left_out += not_used
        dips, not_used = _dips(project, rock, units)
        left_out += not_used
        series = [
            _with_sheet_dips(project, rock, rock_series, units, left_out) for rock_series in rock.series
        ]
    mapped = _mapped(project, rock, units, dips)
    if rock.map is not None:
        observed, not_used, map_warnings = read_map(project, rock, units)
        if (ground := project_rock.ground_number) is not None:
            observed = replace(observed, on=np.full(len(observed), rock.surfaces[ground].name))
        parts.append(observed)
        left_out += not_used
    observations = Observations.joined(parts).along_holes() if parts else None
    if observations is not None and not (picks.holes or rock.hole_picks):
        map_warnings += _on_the_ground_alone(rock, observations, dips, series)
    takes_picks = {
        surface.name
        for number, surface in enumerate(rock.surfaces)
        if surface.has_points and number != rock.terrain_number
    }
    surfaces = [
        (_without_picks(surface, picks), picks.of_surfaces.get(surface.name))
        if surface.name in takes_picks
        else (surface, None)
        for surface in rock.surfaces
    ]
    unnamed = picks.of_surfaces.keys() - takes_picks
    read = replace(
        rock,
        boreholes=None,
        observations=observations,
        dips=dips,
        map=None,
        names={},
        series=series,
        hole_picks=picks.holes or rock.hole_picks,
        hole_ends=picks.ends or rock.hole_ends,
        hole_values=picks.logs or rock.hole_values,
    )
    return FieldData(
        read,
        picks,
        surfaces,
        [name for name in picks.of_surfaces if name in unnamed],
        left_out,
        map_warnings,
        project_rock.ground_number,
        mapped,
    )


def thicknesses_without_effect(rock: Rock) -> list[str]:
    """A warning where observations of a rock mass have thicknesses of blocks that are in no field."""
    seen = rock.observed
    if seen is None:
        return []
    fields = {series.name for series in rock.series if series.kind == FIELD}
    pairs = enumerate(pairwise(rock.surfaces), 1)
    of_fields = [top for top, (a, b) in pairs if a.series == b.series and b.series in fields]
    tops = BlockNumbers(rock).of(seen.blocks)
    count = int((seen.in_use & ~np.isnan(seen.thicknesses_there) & ~np.isin(tops, of_fields)).sum())
    if not count:
        return []
    return [
        f"the thickness of {counted(count, 'observation')} has no effect, as the block is not between two "
        'surfaces of a field: add a pick where it ends, or use the method "parallel" with a thickness'
    ]


def _on_the_ground_alone(
    rock: Rock, observations: Observations, dips: Dips | None, series: Sequence[Series]
) -> list[str]:
    """A warning where outcrops or a map alone say where surfaces are: nothing shows them below the ground."""
    slopes = [
        dips,
        *(rock_series.dips for rock_series in series),
        *(surface.dips for surface in rock.surfaces),
    ]
    if (observations.holes != "").any() or any(map(_are_some, slopes)):
        return []
    shown = [
        surface.name
        for surface in rock.surfaces[:-1]
        if surface.has_points and surface.points is None and surface.needs_points
    ]
    if not shown:
        return []
    names = number_list([f"'{name}'" for name in shown])
    return [
        f"only outcrops or a map say where {names} {'is' if len(shown) == 1 else 'are'}, and no data "
        "show what is below the ground, so blocks may be very thin: add dips, boreholes or points"
    ]


def _are_some(dips: object) -> bool:
    return dips is not None and not (isinstance(dips, (Dips, SpaceDips)) and not len(dips))


def _dips(project: Project, rock: Rock, units: UnitNames) -> tuple[Dips | None, list[LeftOut]]:
    """The dips of a rock mass with what they are of, and those that are not used."""
    if rock.dip_file is not None:
        dips, not_used = read_dips_of_rock(rock.dip_file, units, project.units)
        return dips.checked(), not_used
    assert rock.dips is None or isinstance(rock.dips, Dips)
    return None if rock.dips is None else rock.dips.checked(), []


def _with_sheet_dips(
    project: Project, rock: Rock, series: Series, units: UnitNames, left_out: list[LeftOut]
) -> Series:
    """A series; one of sheets with its dips as arrays. Those that are not used are added to left_out."""
    if series.kind != SHEETS:
        return series
    with naming(f"{rock.item}, {series.item}"):
        if series.dip_file is None:
            return replace(series, dips=series.sheet_dips())
        dips, not_used = read_dips_of_rock(series.dip_file, units, project.units)
        left_out += not_used
        return replace(series, dips=dips.checked())


def _mapped(project: Project, rock: Rock, units: UnitNames, dips: Dips | None) -> np.ndarray | None:
    """(D,) texts: the block that a map shows at dips without a name and a height, which were measured on the
    ground, by the surface over it; "" for others. None where there is no map or no dip."""
    if dips is None or rock.map is None:
        return None
    surfaces, blocks = dips.named
    bare = (surfaces == "") & (blocks == "") & np.isnan(dips.heights)
    shown = np.full(len(dips), "", object)  # texts of any length
    if bare.any():
        shown[bare] = blocks_on_map(project, rock, units, dips.positions[bare])
    return shown


def bodies_of(project: Project, rock: Rock) -> PlaceContext:
    """The bodies that there may be in a rock mass, before their shapes are known."""
    number = [project_rock.name for project_rock in project.rocks].index(rock.name)
    bodies_and_times = [(body, body_times(project, body)) for body in project.bodies]
    in_rock = [(body, times[number]) for body, times in bodies_and_times if number in times]
    return PlaceContext(
        after=[after for _, after in in_rock],
        bodies=[body.name for body, _ in in_rock],
        voids=[body.void for body, _ in in_rock],
    )


def _without_picks(surface: Surface, picks: Picks) -> Surface:
    """The surface with the picks that are switched off among its points that are left out."""
    off = picks.switched_off.get(surface.name)
    if off is None or not surface.has_points:
        return surface
    left_out = [] if surface.left_out is None else [np.asarray(surface.left_out, np.float64).reshape(-1, 3)]
    return replace(surface, left_out=np.concatenate([*left_out, off]))


def observed_on_mesh(entry: RockInput, observations: Observations) -> tuple[Observations, np.ndarray]:
    """Observations of a RockInput with more along its intervals where its surfaces are linear only between
    edges of its planar mesh, once it is meshed; and (N,) bool, those that are not new."""
    if entry.region is None or not entry.rock.interpolates:
        return observations, np.ones(len(observations), bool)
    return with_crossings(observations, entry.region)


def apply_observations(
    work: Work, entry: RockInput, situation: PlaceContext, given: tuple[Observations, np.ndarray]
) -> None:
    """Gives the surfaces of a RockInput that is read the contacts and bounds that follow from its
    observations, instead of those that they have. situation: where these lie, but for where surfaces
    reach. given: as of observed_on_mesh."""
    observations, is_own = given
    situation = replace(situation, covered=_covered(work, entry, observations.places))
    derived = derive(entry.rock, observations, situation)
    entry.data = with_contacts(entry.rock, entry.data, derived)
    entry.used = derived.used[is_own]
    of_tables = [observation for observation in entry.left_out if observation.kind in IN_TABLES]
    entry.left_out = [*of_tables, *derived.left_out]
    if situation.sides is None or not situation.sides.shape[1]:  # a bound counts on its side of a fault
        entry.data, contradictions = without_contradictions(entry.rock, entry.data)
        entry.left_out += contradictions


def _covered(work: Work, entry: RockInput, places: np.ndarray) -> np.ndarray | None:
    """(N, S) bool: over or under which surfaces places (N, 3) lie; None where all surfaces are interpolated
    or level sets, and reach everywhere."""
    reach = [surface.has_points for surface in entry.rock.surfaces]
    if all(reach):
        return None
    plan = np.ascontiguousarray(places[:, :2])
    covered = np.ones((len(places), len(entry.rock.surfaces)), bool)
    for number, shape in enumerate(entry.surfaces):
        if not reach[number] and shape is not None:
            covered[:, number] = np.isfinite(heights_at(work, shape, plan))
    return covered


def left_out_warnings(entry: RockInput) -> list[BuildWarning]:
    """A warning for each reason why observations of a RockInput are left out, and for each surface that none
    of them is on."""
    warnings = []
    for surface, data in zip(entry.rock.surfaces, entry.data, strict=True):
        if data.has_only_bound_points:
            text = (
                "it has no points, and no observation is on it: it goes through the "
                f"{len(data.points)} places nearest to which observations allow it"
            )
            warnings.append(BuildWarning(text, "no_contact", entry.rock.name, surface.name))
    texts = left_out_texts(entry.left_out)
    return [*warnings, *(BuildWarning(text, kind, entry.rock.name) for kind, text in texts.items())]


def left_out_texts(left_out: Sequence[LeftOut]) -> dict[str, str]:
    """A sentence for each kind of observations that are left out."""
    texts = {}
    for kind, says in KINDS.items():
        if listed := [observation.text for observation in left_out if observation.kind == kind]:
            texts[kind] = f"{says} ({len(listed)}): {number_list(listed, _LISTED)}"
    return texts
