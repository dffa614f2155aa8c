# SPDX-License-Identifier: GPL-3.0-or-later
"""A project from boreholes, or a geological map, alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.errors import InputRefused, UsageError, counted
from ..base.named import keyword_only
from ..base.units import MODEL_UNIT
from ..base.work import run
from ..project.library import Library
from ..project.plan_input import read_rings
from ..project.project import Project, Rock, Surface
from ..project.project_checks import check_project
from ..project.structure_entries import Body
from ..readers import read_mesh
from ..readers.borehole_tables import boreholes_of
from ..readers.code_counts import read_names
from ..readers.formats import MESH, RASTER, format_of
from ..readers.map_input import system_of_map
from ..readers.point_input import read_point_file, read_raster_heights
from ..readers.rasters.geotiff import geotiff_system
from ..settings.crs import projected_code
from ..settings.data_files import Boreholes, MapFile, MapLayer, MeshFile, PointFile
from ..settings.dips import DipFile, dip_file_of
from ..settings.method_options import OptionRefused
from ..structures.shapes.between_walls import Pierced, body_between_walls
from .choices import Proposal
from .colors import library_of
from .extent import base_below, edge_length, region_around
from .folder import save_folder
from .lenses import Lens, Sorted, sort_out, spacing
from .logs import HoleLogs, Log, read_logs
from .maps import MapUnits, map_file_of, read_map_units, unconformities
from .methods import with_methods
from .order import UnitOrder, evidence_of, find_order
from .rules import CUTS, RuleChoice, choose_rules


@dataclass(eq=False)
class ProposedProject(Project):
    """A project with the reasons of its choices, `proposal`."""

    proposal: Proposal = field(default_factory=lambda: Proposal([]), compare=False)

    def save(self, folder: str | Path) -> Path:
        """Writes project.toml, whose comments say why each choice was made, the tables, the library and
        proposal.json to a new folder, whole or not at all; returns the path of project.toml. Raises
        OutputFailed."""
        return save_folder(self, self.proposal, folder)


@dataclass
class _Data:
    """What a project is made of. holes: None without boreholes, likewise the map."""

    boreholes: Boreholes | None
    map: MapFile | None
    dips: DipFile | None
    ground: PointFile | MeshFile | None
    names: Mapping[str, str]
    holes: HoleLogs | None = None
    mapped: MapUnits | None = None

    @property
    def logs(self) -> list[Log]:
        return [] if self.holes is None else self.holes.logs


@keyword_only
def propose_project(
    *,
    boreholes: Boreholes | Mapping | str | Path | None = None,
    map: MapFile | Mapping | str | Path | None = None,
    ground: PointFile | MeshFile | str | Path | None = None,
    region: ArrayLike | MapLayer | str | Path | None = None,
    dips: DipFile | str | Path | None = None,
    names: Mapping[str, str] | str | Path | None = None,
    units: str = MODEL_UNIT,
    name: str | None = None,
    crs: str | None = None,
) -> ProposedProject:
    """A project that builds at once, from data alone.

    boreholes: as the first argument of read_boreholes: a file that holds all tables, or the keys of
    Boreholes: {"collars": ..., "intervals": ...}.
    map: a file of polygons, or a MapFile or its keys; without `block`, the attribute of units is found.
    ground: a raster, points or a mesh; None: the collars. region: (N, 2), or a file; None: around the data.
    dips: a table. names: what codes of the data mean, as `names` of Rock: {"SST": "Sandstone", "Qal*":
    "Alluvium", "LC": ""}, or a table of two columns, code and unit. units: of the model. name:
    of the project. crs: as of Project; None: as files say.

    The order of units follows from which lies over which; see `ProposedProject.proposal`. Raises InputRefused
    naming the file, UsageError.

    >>> project = propose_project(
    ...     boreholes={"collars": "c.csv", "intervals": "i.csv"}
    ... )  # doctest: +SKIP
    """
    of_files = _map(map, ground), dip_file_of(dips), _ground_of(ground)
    meanings = read_names(names) if isinstance(names, (str, Path)) else dict(names or {})
    data = _Data(_boreholes(boreholes, units), *of_files, meanings)
    if data.boreholes is None and data.map is None:
        raise UsageError("propose_project needs boreholes or a map")
    if data.map is not None and data.ground is None and data.boreholes is None:
        advice = "give the elevations of the ground as well: ground = a raster, points or a mesh (--ground)"
        raise UsageError(f"a map alone has no elevations: {advice}")
    if data.boreholes is not None:
        data.holes = read_logs(data.boreholes, units, data.names)
        data.boreholes = data.holes.boreholes
    if data.map is not None:
        heights = None if data.ground is None else _heights_of(data.ground, units)
        data.mapped = read_map_units(data.map, data.dips, heights, units, data.names)
    order = _order(data)
    out = sort_out(data.holes, order) if data.holes is not None else Sorted([])
    lens_units = {lens.unit for lens in out.lenses}
    in_stack = {part.unit for log in out.logs for part in log.parts}
    order.order = [unit for unit in order.order if unit in in_stack or unit not in lens_units]
    rules = _rules(data, out, order)
    alternatives = [
        replace(other, order=[unit for unit in other.order if unit in order.order])
        for other in order.alternatives
        if other.younger in order.order and other.older in order.order
    ]
    proposal = Proposal(list(order.order), alternatives, out.conflicts, out.lenses, out.repeats, rules)
    project = _Maker(data, out, proposal, units).project(name, region)
    project.crs, proposal.reasons["crs"] = (crs, "as given") if crs else _system(data, units)
    check_project(project)
    project.rocks, proposal.reasons["method"] = with_methods(project, len(data.logs))
    _warn(proposal, data)
    return project


def _boreholes(given: Any, units: str) -> Boreholes | None:
    return None if given is None else boreholes_of(given, units)


def _map(given: Any, ground: Any) -> MapFile | None:
    if given is None:
        return None
    try:
        map_file = map_file_of(given)
        map_file.check()
    except (TypeError, OptionRefused) as error:
        raise UsageError(f"map: {error}") from error
    return map_file


def _ground_of(given: Any) -> PointFile | MeshFile | None:
    if given is None or isinstance(given, (PointFile, MeshFile)):
        return given
    file_format = format_of(given, RASTER, MESH)
    return MeshFile(given) if file_format is not None and file_format.holds == MESH else PointFile(given)


def _system(data: _Data, units: str) -> tuple[str | None, str]:
    """The coordinate system that the files name, and why; None where they name none, several, or one in
    another unit than the model's."""
    said: dict[str, Path] = {}
    if data.holes is not None and data.holes.system:
        said[data.holes.system] = data.holes.boreholes.files[0]
    if isinstance(data.ground, PointFile) and (number := geotiff_system(data.ground.file)) is not None:
        said.setdefault(f"EPSG:{number}", Path(data.ground.file))
    if data.map is not None and (system := system_of_map(data.map.polygons)):
        said.setdefault(projected_code(system) or system, Path(data.map.file))
    how = "name it by --crs EPSG:CODE, or the key 'crs'"
    if not said:
        return None, f"not known: no file names it; {how}"
    (system, file), names = next(iter(said.items())), " and ".join(f"'{name}'" for name in said)
    code = projected_code(system)
    if len(said) > 1 or code is None:
        return None, f"not known: files say {names}; {how}"
    is_in_its_unit = units == MODEL_UNIT if data.holes is None else data.holes.is_in_its_unit
    if not is_in_its_unit:
        return None, f"none: {file.name} says {system}, whose unit is not the model's"
    return code, f"as {file.name} says"


def _heights_of(ground: PointFile | MeshFile, units: str) -> Callable[[np.ndarray], np.ndarray]:
    """The heights of the ground at places (N, 2): of a raster, else of the nearest point."""

    def heights(plan: np.ndarray) -> np.ndarray:
        if isinstance(ground, PointFile) and (z := read_raster_heights(ground, plan, units)) is not None:
            return z
        points = _ground_points(ground, units)
        nearest = [int(np.argmin(np.hypot(*(points[:, :2] - place).T))) for place in plan]
        return points[nearest, 2]

    return heights


def _ground_points(ground: PointFile | MeshFile, units: str) -> np.ndarray:
    if isinstance(ground, PointFile):
        return read_point_file(ground, units)[0]
    return read_mesh(ground.file).in_model(ground, units)[0]


def _order(data: _Data) -> UnitOrder:
    """The order of the units of holes and map together."""
    columns = [[(part.unit, part.thickness) for part in log.parts] for log in data.logs]
    names = {unit for column in columns for unit, _ in column}
    if data.holes is not None and not data.logs:
        columns = [[(name, 1.0) for name, _ in picks] for picks in data.holes.pick_orders]
        names = set(data.holes.picks)
    mapped = data.mapped
    names |= set() if mapped is None else set(mapped.evidence.names)
    evidence = evidence_of(sorted(names), columns)
    if mapped is not None:
        at = [evidence.names.index(unit) for unit in mapped.evidence.names]
        evidence.over[np.ix_(at, at)] += mapped.evidence.over
        evidence.adjacent[np.ix_(at, at)] += mapped.evidence.adjacent
    near = None
    if mapped is not None and not data.logs and not mapped.has_ages:
        near = mapped.touches
    return find_order(evidence, data.logs, near)


def _rules(data: _Data, out: Sorted, order: UnitOrder) -> list[RuleChoice]:
    rules = choose_rules(out.logs, order)
    if data.mapped is None:
        return rules
    by_unit = {choice.unit: number for number, choice in enumerate(rules)}
    for unit, older in unconformities(data.mapped, order.order).items():
        below = order.order[order.rank(unit) - 1]
        names = ", ".join(f"'{name}'" for name in older)
        reason = f"it cuts older rock: on the map '{unit}' lies on {names}"
        rules[by_unit[below]] = RuleChoice(below, CUTS, reason)
    return rules


class _Maker:
    """Makes the project of a proposal, with the reasons."""

    def __init__(self, data: _Data, out: Sorted, proposal: Proposal, units: str):
        self._data, self._out, self._proposal, self._units = data, out, proposal, units
        self._why = proposal.reasons

    def project(self, name: str | None, region: Any) -> ProposedProject:
        data, proposal = self._data, self._proposal
        rings, given_region = self._region(region)
        plan = np.array([log.plan for log in data.logs]).reshape(-1, 2)
        if data.holes is not None and not data.logs:
            plan = np.unique(data.holes.places[:, :2], axis=0)
        length, self._why["edge_length"] = edge_length(rings, plan)
        width = float(np.ptp(np.vstack(rings), axis=0).max())
        base, self._why["base_elevation"] = base_below(self._heights(), width, data.holes is None)
        names = [*proposal.order, *(lens.unit for lens in proposal.lenses)]
        library = library_of(list(dict.fromkeys(names)))
        rock = Rock(
            "rock",
            self._surfaces(library),
            region=given_region,
            edge_length=length,
            base_elevation=base,
            boreholes=data.boreholes,
            map=data.map,
            dips=data.dips,
            names={code: unit for code, unit in data.names.items() if unit in ("", *names)},
        )
        return ProposedProject(
            name or self._name(),
            [rock],
            library=library,
            units=self._units,
            bodies=self._bodies(library, rock.surfaces, plan),
            proposal=proposal,
        )

    def _name(self) -> str:
        data = self._data
        files = [*(data.boreholes.files if data.boreholes else []), *([data.map.file] if data.map else [])]
        return Path(files[0]).stem or "site"

    def _heights(self) -> np.ndarray:
        data = self._data
        parts = [np.empty(0)]
        if data.holes is not None:
            parts.append(data.holes.places[:, 2])
        if data.mapped is not None:
            parts.append(data.mapped.ground)
        heights = np.concatenate(parts)
        if not len(heights):
            raise InputRefused("no elevation is known", advice="give the ground, or boreholes")
        return heights[np.isfinite(heights)]

    def _region(self, region: Any) -> tuple[list[np.ndarray], Any]:
        """The rings, and the region of the rock mass."""
        if region is not None:
            self._why["region"] = "as given"
            outline, holes, _ = read_rings(region, (), self._units)
            rings = outline if isinstance(outline, list) else [outline, *holes]
            rings = [np.asarray(ring, float) for ring in rings]
            return rings, region if isinstance(region, (str, Path, MapLayer)) else outline
        data = self._data
        box = self._raster_box()
        within = "" if box is None else ", as far as the ground is known"
        if data.mapped is not None:
            low, high = data.mapped.box
            if box is not None:
                low, high = np.maximum(low, box[0]), np.minimum(high, box[1])
            if not (low < high).all():
                file = data.map.file if data.map is not None else None
                raise InputRefused("the map and the ground have no place in common", file=file)
            ring = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
            self._why["region"] = f"the rectangle around the map{within}"
        else:
            assert data.holes is not None
            ring, margin = region_around(data.holes.places[:, :2], box)
            self._why["region"] = f"the convex hull of the holes and a margin of {margin:g}{within}"
        return [ring], ring

    def _raster_box(self) -> np.ndarray | None:
        """(2, 2) the corners of the raster of the ground; None where it is none."""
        ground = self._data.ground
        if not isinstance(ground, PointFile) or format_of(ground.file, RASTER) is None:
            return None
        points = _ground_points(ground, self._units)
        return np.array([points[:, :2].min(axis=0), points[:, :2].max(axis=0)])

    def _surfaces(self, library: Library) -> list[Surface]:
        proposal = self._proposal
        numbers = {entry.name: entry.id for entry in library}
        only_picks = self._data.holes is not None and not self._data.logs and self._data.mapped is None
        order = proposal.order
        taken = {unit.casefold() for unit in order}
        surfaces = []
        for choice in proposal.rules:
            unit = choice.unit
            surface = unit if only_picks else _free(f"{unit} top", taken)
            block = None if only_picks else unit
            surfaces.append(Surface(surface, rule=choice.rule, block=block, property=numbers[unit]))
        if only_picks:
            surfaces.append(Surface(order[-1], property=numbers[order[-1]]))
            if self._data.ground is None:
                return surfaces
        youngest = None if only_picks else order[-1]
        number = 0 if youngest is None else numbers[youngest]
        ground = Surface(_free("ground", taken), rule=CUTS, block=youngest, property=number)
        return [*surfaces, replace(ground, **self._ground_shape())]

    def _ground_shape(self) -> dict:
        """The shape of the youngest surface."""
        ground = self._data.ground
        if isinstance(ground, MeshFile):
            self._why["ground"] = "the mesh that is given"
            return {"mesh": ground}
        if ground is not None:
            self._why["ground"] = "the elevations that are given"
            is_raster = format_of(ground.file, RASTER) is not None
            return {"points": ground, "method": "grid" if is_raster else None}
        tops = np.array([self._top(log) for log in self._data.logs])
        self._why["ground"] = f"through the {counted(len(tops), 'collar')} of the holes"
        return {"points": tops}

    @staticmethod
    def _top(log: Log) -> np.ndarray:
        """The collar of a hole, or the top of its log where that is not known."""
        return log.parts[0].top if log.collar is None else log.collar

    def _bodies(self, library: Library, surfaces: Sequence[Surface], plan: np.ndarray) -> list[Body]:
        lenses = self._proposal.lenses
        if not lenses:
            return []
        numbers = {entry.name: entry.id for entry in library}
        extent = float(np.ptp(plan, axis=0).max()) or 1.0
        reach = (spacing(plan) or extent) / 2
        tops = {surface.block: surface.name for surface in surfaces[:-1]}
        bodies = []
        for lens in lenses:
            after = tops.get(lens.host)  # None: the youngest
            body = Body(lens.name, after=after, property=numbers[lens.unit], reach=reach)
            bodies.append(body if self._is_all(lens) else self._with_mesh(body, lens))
        return bodies

    def _is_all(self, lens: Lens) -> bool:
        """Whether the build makes the same of the intervals that bear its name."""
        units = [part.unit for log in self._data.logs for part in log.parts]
        return lens.name == lens.unit and units.count(lens.unit) == len(lens.parts)

    def _with_mesh(self, body: Body, lens: Lens) -> Body:
        """The body with the mesh of a lens that other intervals share their unit with."""
        holes = {hole for hole, _ in lens.parts}
        others = [part for log in self._data.logs if log.hole not in holes for part in log.parts]
        ends, without = (
            np.array([(part.top, part.bottom) for part in parts]).reshape(-1, 2, 3)
            for parts in ([part for _, part in lens.parts], others)
        )
        met = Pierced(ends, without)
        (vertices, triangles), texts = run(lambda work: body_between_walls(work, met, body.reach))
        self._proposal.warnings += [f"{body.item}: {text}" for text in texts]
        return replace(body, vertices=vertices, triangles=triangles, reach=None)


def _free(name: str, taken: set[str]) -> str:
    """A name that no unit has."""
    while name.casefold() in taken:
        name += " surface"
    taken.add(name.casefold())
    return name


def _warn(proposal: Proposal, data: _Data) -> None:
    """The warnings of what is not certain."""
    found = [*(data.holes.warnings if data.holes else []), *(data.mapped.warnings if data.mapped else [])]
    for other in proposal.alternatives:
        found.append(
            f"nothing decides whether '{other.younger}' is younger than '{other.older}': taken so; "
            f"{'; '.join(other.reasons)}. If it is not, exchange their surfaces"
        )
    for conflict in proposal.conflicts:
        found.append(
            f"hole '{conflict.hole}', depth {conflict.depth:.9g}: '{conflict.upper}' lies over "
            f"'{conflict.lower}', against the order of all holes; it is not used"
        )
    for lens in proposal.lenses:
        hole, part = lens.parts[0]
        one = f"hole '{hole}', depth {part.depth:.9g} to {part.end:.9g} (or a code is wrong there)"
        found.append(
            f"'{lens.unit}' is a lens in '{lens.host}' in "
            f"{one if len(lens.parts) == 1 else counted(len(lens.parts), 'hole')}: the body "
            f"'{lens.name}'; where it ends between holes is a guess"
        )
    for repeat in proposal.repeats:
        how = "in reverse, as in a fold: give their surfaces a series of kind 'field' with dips and polarity"
        if not repeat.in_reverse:
            how = "in the same order, as beneath a thrust: add the fault"
        found.append(
            f"hole '{repeat.hole}', depth {repeat.depth:.9g}: {', '.join(repeat.units)} come again, {how}. "
            "Not used"
        )
    proposal.warnings += found
