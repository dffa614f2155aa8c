# SPDX-License-Identifier: GPL-3.0-or-later
"""A project proposed from field data alone, in a thread; the main thread puts it into the scene."""

from dataclasses import dataclass, replace

from ...core import InputRefused, propose_project
from ...core.proposal import ProposedProject
from ...core.readers.borehole_input import read_repaired
from ...core.readers.code_counts import count_codes
from ...core.readers.hole_files import read_once
from ...core.surfaces.prepare import with_arrays
from ..host.thread_job import ThreadJob

_SHARE = 0.8  # of the progress that the proposal takes


@dataclass
class Proposed:
    """project: as it is proposed. arrays: the same with its data read. counts: CodeCounts. problems: of the
    tables of boreholes."""

    project: ProposedProject
    arrays: ProposedProject
    counts: list
    problems: list


class ProposalJob(ThreadJob):
    """Proposes a project from FieldTables, and returns what was Proposed. units: of the model. names: what
    codes mean."""

    def __init__(self, tables, units, names):
        """Raises InputRefused."""
        self._tables, self._units = tables, units
        dips = [*tables.rock_dips, *tables.dips]
        for files, what in ((tables.maps, "map"), (dips, "table of dips")):
            if len(files) > 1:
                raise InputRefused(
                    f"a project is proposed from one {what}", advice="import the others afterward"
                )
        if tables.boreholes is None and not tables.maps:
            advice = "choose them too, or switch off Propose Project"
            raise InputRefused("a project is proposed from boreholes or a map", advice=advice)
        if tables.boreholes is None and not tables.maps[0].ground:
            raise InputRefused("a map alone has no elevations", advice="choose a Ground beside it")
        ground = tables.maps[0].ground if tables.maps else None
        self._given = {
            "boreholes": tables.boreholes,
            "map": replace(tables.maps[0], ground=None) if tables.maps else None,
            "ground": ground or None,
            "dips": next(iter(dips), None),
            "names": names,
        }

    def _work(self, job):
        with read_once():
            with job.part(0.0, _SHARE):
                project = propose_project(**self._given, units=self._units)
            with job.part(_SHARE, 1.0):
                arrays = with_arrays(project)
                counts = count_codes(*self._tables.coded, units=self._units)
                holes = self._tables.boreholes
                problems = [] if holes is None else read_repaired(holes, self._units).problems
        return Proposed(project, arrays, counts, problems)
