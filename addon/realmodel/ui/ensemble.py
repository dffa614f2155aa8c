# SPDX-License-Identifier: GPL-3.0-or-later
"""The ensemble of a model: how certain its volumes are, and which block is where."""

import bpy

from ..bl import units
from ..bl.display import ensembles
from ..props_ensemble import slider_of
from .panel import OfABuiltModel, TabPanel, hint


class REALMODEL_PT_ensemble(OfABuiltModel, TabPanel, bpy.types.Panel):
    bl_label = "Ensemble"
    bl_idname = "REALMODEL_PT_ensemble"
    bl_parent_id = "REALMODEL_PT_results"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_in(self, layout, context, group):
        scene, ensemble = context.scene, group.ensemble
        layout.prop(ensemble, "realizations")
        layout.prop(ensemble, "seed")
        row = layout.split(factor=0.7, align=True)
        row.operator("realmodel.ensemble", icon="MOD_ARRAY").along = "PLANE"
        row.operator("realmodel.ensemble", text="Curve").along = "LINE"
        found = ensembles.table(scene)
        if found is None:
            hint(layout, "Builds the model many times: how certain are its volumes?")
            return
        row = layout.row()
        row.label(text=f"{found['count']} realizations, seed {found['seed']}")
        row.operator("realmodel.ensemble_remove", text="", icon="X", emboss=False)
        if ensembles.is_outdated(scene):
            hint(layout, "The model was built again since: make the ensemble again.")
        _draw_table(layout, scene, found)
        item = ensembles.item_of(scene)
        if item is None:
            return
        layout.prop(ensemble, "color_by", text="Section")
        if ensemble.color_by == ensembles.PROBABILITY:
            layout.prop_search(ensemble, "block", group, "results")
        elif ensemble.color_by == ensembles.REALIZATION:
            slider = slider_of(found["count"])
            if slider is None:
                layout.prop(ensemble, "realization")
            else:
                layout.prop(group.realization_slider, slider, slider=True)


def _draw_table(layout, scene, found):
    column = layout.box().column(align=True)
    _row(column, f"Block ({units.unit_text(scene, 3)})", ensembles.headings())
    for row in reversed(found["blocks"]):
        _row(column, row["name"], [_short(volume) for volume in row["percentiles"]])


def _row(column, name, texts):
    line = column.split(factor=0.34)
    line.label(text=name)
    cells = line.row()
    for text in texts:
        cell = cells.row()
        cell.alignment = "RIGHT"
        cell.label(text=text)


def _short(volume):
    """A volume in the width of a column."""
    return f"{volume:,.0f}" if 100 <= volume < 1e5 else f"{volume:.4g}"


CLASSES = (REALMODEL_PT_ensemble,)
