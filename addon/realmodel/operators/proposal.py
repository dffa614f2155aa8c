# SPDX-License-Identifier: GPL-3.0-or-later
"""A project from field data alone, with progress and Esc, and the list of its reasons."""

import bpy

from ..bl.field import hole_validation
from ..bl.jobs.proposal_job import ProposalJob
from ..bl.project import imported, observed_blocks, reading_text, settings
from ..bl.scene import live, proposed
from ..core import BuildFailed, InputRefused
from ..core.base.errors import counted
from .chosen_tables import ChosenTables
from .imports import arrived
from .reporting import InBackground, Reporting, not_building
from .start import show


class REALMODEL_OT_propose_project(InBackground, ChosenTables, bpy.types.Operator):
    """Make a project from boreholes, or from a geological map, and replace the model of this scene: the order
    of units, erosion, lenses, region, base and ground, with the reason of each choice. Esc cancels and leaves
    the scene unchanged"""

    bl_label = "Propose Project"
    needs = (not_building,)

    _scene = ""  # the name of the scene that is filled

    def begin(self, context):
        self._scene = context.scene.name
        names = reading_text.named_texts(self.names)
        job = ProposalJob(self.tables(context), context.scene.realmodel.units, names)
        live.postpone_work()
        return job

    def tell_done(self, done):
        scene = bpy.context.scene
        if scene.name != self._scene:
            raise BuildFailed("another scene is shown now; nothing was changed")
        show(scene, done.project, done.arrays)
        proposal = done.project.proposal
        proposed.keep(scene, proposal)
        rock = settings.active_rock(scene)
        known = observed_blocks.units_of(scene, rock, reading_text.named_texts(self.names))
        imported.record(rock, self.called() | {"add_surfaces": True}, done.counts, done.problems, known)
        with settings.filling():
            scene.realmodel.view.show_boreholes = bool(rock.hole_picks)
            scene.realmodel.view.show_map = bool(rock.map)
        observed = observed_blocks.of_rock(rock)
        arrived(bpy.context, None, [rows.places for rows in (observed,) if rows is not None])
        said = f"Proposed {counted(len(proposal.order), 'unit')}, oldest first: {', '.join(proposal.order)}"
        if proposal.uncertain:
            said += f"; not certain: {len(proposal.uncertain)}, see Proposal"
        self.report({"INFO"}, said)


def a_reason_with_hole(context):
    rows, active = context.scene.realmodel.proposal, context.scene.realmodel.active_reason
    has_hole = 0 <= active < len(rows) and rows[active].hole
    return None if has_hole else "the row has no hole"


class REALMODEL_OT_proposal_show(Reporting, bpy.types.Operator):
    """Turn the viewport to the hole of a row of the proposal, and show the boreholes with their names"""

    bl_label = "Show Hole"
    needs = (a_reason_with_hole,)

    def act(self, context):
        group = context.scene.realmodel
        hole = group.proposal[group.active_reason].hole
        if not any(hole_validation.show_hole(context, rock, hole) for rock in group.rocks):
            raise InputRefused(f"hole '{hole}' has no place", advice="it has no collar, or no data")
