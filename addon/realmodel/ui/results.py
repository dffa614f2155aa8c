# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of blocks, and the model out to files."""

import bpy

from ..bl.project import compartments, results, units
from ..bl.scene import quality
from .lists import result_columns
from .panel import FoldedPanel, OfABuiltModel, TabPanel, message, right_label


class REALMODEL_PT_results(OfABuiltModel, TabPanel, bpy.types.Panel):
    bl_label = "Results"
    bl_order = 3

    def draw_in(self, layout, context, group):
        headings = ("Block", units.unit_text(context.scene, 3), "%")
        for column, heading in zip(result_columns(layout), headings, strict=True):
            column.label(text=heading)
        layout.template_list("REALMODEL_UL_results", "", group, "results", group, "active_result", rows=4)
        if 0 <= group.active_result < len(group.results):
            column = layout.box().column(align=True)
            for line in _block_lines(context.scene, group.results[group.active_result]):
                column.label(text=line)
        layout.label(text=f"Total {units.total_volume_text(context.scene)}")
        line = layout.row(align=True)
        line.operator("realmodel.copy_table", text="Copy Table", icon="COPYDOWN")
        line.operator("realmodel.report", text="Save Table...").format = "CSV"
        line = layout.row(align=True)
        line.operator("realmodel.export", text="Export...", icon="EXPORT")
        line.operator("realmodel.report", text="Report...", icon="TEXT").format = "JSON"
        column = layout.column(align=True)
        column.operator("realmodel.share", text="Share...", icon="URL")
        column.operator("realmodel.export_mesh", text="Simulation Mesh...", icon="MOD_LATTICE")
        column.operator("realmodel.export_scene", text="3D Scene...", icon="SCENE_DATA")


def _block_lines(scene, row):
    """The statistics of a block, as lines."""
    yield row.name
    if not row.volume:
        yield "Eroded: nothing of it is left"
        return
    if results.is_missing(row):
        yield "Its object was deleted; Build makes it again"
    yield f"{units.full_volume_text(scene, row)}  ({row.share:.2f} %)"
    deviation = quality.volume_deviation(scene, row)
    if deviation is not None:
        yield f"± {units.volume_amount_text(scene, deviation)} at most (std. dev.)"
    if row.components:
        cells = f"{row.cells:,} cell" + ("s" if row.cells != 1 else "")
        parts = row.components - row.slivers
        small = f" + {row.slivers:,} sliver{'s' * (row.slivers > 1)}" if row.slivers else ""
        yield f"{parts:,} part{'s' * (parts != 1)}{small}, {cells}"


class REALMODEL_PT_results_compartments(FoldedPanel, bpy.types.Panel):
    bl_label = "Compartments"
    bl_parent_id = "REALMODEL_PT_results"

    @classmethod
    def poll(cls, context):
        table = compartments.read(context.scene)
        return table is not None and bool(table["faults"] or len(table["names"]) > 1)

    def draw_in(self, layout, context, group):
        scene, table = context.scene, compartments.read(context.scene)
        if len(table["names"]) > 1:
            chosen = group.results[min(group.active_result, len(group.results) - 1)]
            chosen_row = table["volumes"].get(chosen.name, [0.0] * len(table["names"]))
            total = [sum(volumes) for volumes in zip(*table["volumes"].values(), strict=True)]
            column = layout.column(align=True)
            _row(column, chosen.name, "All")
            for number, name in enumerate(table["names"]):
                message(column, name)
                _row(column, *(units.volume_amount_text(scene, row[number]) for row in (chosen_row, total)))
        unit, factor = units.shown_unit(scene, 1)
        for fault in dict.fromkeys(entry[0] for entry in table["faults"]):
            column = layout.column(align=True)
            column.label(text=fault)
            _row(column, "Throw", "Heave", name=f"Mean ({unit})")
            for name, surface, *values in table["faults"]:
                if name == fault:
                    texts = [
                        "None found" if mean is None else units.number_text(factor * mean) for mean in values
                    ]
                    _row(column, *texts, name=surface)


def _row(column, *values, name=""):
    """A row of a table: two values, beside a name where it is short."""
    row = column.row()
    if name:
        row = column.split(factor=0.45)
        row.label(text=name)
    for value in values:
        right_label(row, value)
