# SPDX-License-Identifier: GPL-3.0-or-later
"""The ensemble of a model: how certain its volumes are, and which block is where."""

import math

import bpy

from ..bl.display import ensembles
from ..bl.project import units
from ..core.base.errors import counted
from ..props_planned import slider_of
from .panel import FoldedPanel, OfABuiltModel, hint, right_label

_RAISED = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")


class REALMODEL_PT_ensemble(OfABuiltModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Ensemble"
    bl_parent_id = "REALMODEL_PT_results"

    def draw_in(self, layout, context, group):
        scene, ensemble = context.scene, group.ensemble
        layout.prop(ensemble, "realizations")
        layout.prop(ensemble, "seed")
        row = layout.split(factor=0.7, align=True)
        row.operator("realmodel.ensemble", icon="MOD_ARRAY").along = "PLANE"
        row.operator("realmodel.ensemble", text="Curve").along = "LINE"
        table = ensembles.table(scene)
        if table is None:
            hint(layout, "Builds the model many times to show how certain its volumes are.")
            return
        row = layout.row()
        row.label(text=f"{counted(table['count'], 'realization')}, seed {table['seed']}")
        row.operator("realmodel.ensemble_remove", text="", icon="X", emboss=False)
        if ensembles.is_outdated(scene):
            hint(layout, "The model was rebuilt: make the ensemble again.")
        _draw_table(layout, scene, table)
        obj = ensembles.item_of(scene)
        if obj is None:
            return
        layout.prop(ensemble, "color_by", text="Section")
        if ensemble.color_by == ensembles.PROBABILITY:
            layout.prop_search(ensemble, "block", group, "results")
        elif ensemble.color_by == ensembles.REALIZATION:
            slider = slider_of(table["count"])
            if slider is None:
                layout.prop(ensemble, "realization")
            else:
                layout.prop(group.realization_slider, slider, slider=True)


def _draw_table(layout, scene, table):
    """Draws the table: volumes in thousands, millions and so on, with few digits, as the sidebar is
    narrow."""
    unit, factor = units.shown_unit(scene, 3)
    largest = factor * max(row["percentiles"][-1] for row in table["blocks"])
    power = 3 * math.floor(math.log10(largest) / 3) if largest > 0.0 else 0
    unit = f"10{str(power).translate(_RAISED)} {unit}" if power else unit
    column = layout.box().column(align=True)
    _row(column, unit, ensembles.headings())
    for row in reversed(table["blocks"]):
        _row(column, row["name"], [_short(factor * volume / 10.0**power) for volume in row["percentiles"]])


def _row(column, name, texts):
    line = column.split(factor=0.36)
    line.label(text=name)
    cells = line.row()
    for text in texts:
        right_label(cells, text)


def _short(value):
    """Three digits of a number below 1000."""
    return f"{value:.{0 if value >= 99.95 else 1 if value >= 9.995 else 2}f}"
