# SPDX-License-Identifier: GPL-3.0-or-later
"""The Build panel: the operator, its progress, missing input, warnings."""

import bpy

from ..bl.host import notices
from ..bl.jobs import estimate_job
from ..bl.project import method_settings, settings
from ..bl.scene import live, problems
from .panel import ICON, FoldedPanel, OfAModel, TabPanel, hint, message, right_label

_FOLDED = 3  # warnings that are shown until they are unfolded


class REALMODEL_PT_build(OfAModel, TabPanel, bpy.types.Panel):
    bl_label = "Build"
    bl_order = 1

    def draw_in(self, layout, context, group):
        activity = context.window_manager.realmodel
        if activity.running:
            _draw_progress(layout, activity)
        elif settings.has_rows(context.scene):
            row = layout.row(align=True)
            row.use_property_split = False
            row.scale_y = 1.4
            row.operator("realmodel.build", icon="MOD_BUILD")
            row.prop(group, "live", toggle=True, icon="RECOVER_LAST")
            if group.is_outdated and not live.is_working():
                layout.label(text="Out of date: changed since it was built", icon="ERROR")
            _draw_missing(layout, group)
        else:
            hint(layout, "Add surfaces first. Then build the blocks between them here.")
        if activity.problem:
            _draw_problem(layout.box(), activity)
        elif group.warnings:
            _draw_warnings(layout.box(), group, activity)


class REALMODEL_PT_build_options(OfAModel, FoldedPanel, bpy.types.Panel):
    bl_label = "Options"
    bl_parent_id = "REALMODEL_PT_build"

    def draw_in(self, layout, context, group):
        layout.prop(group, "cells")
        layout.operator("realmodel.estimate", icon="TIME")
        _draw_estimate(layout, context.scene)
        layout.operator("realmodel.clear", icon="TRASH")


def _draw_progress(layout, activity):
    column = layout.column()
    column.prop(activity, "progress", slider=True)
    column.label(text=activity.text)
    column.operator("realmodel.cancel", text="Cancel (Esc)", icon="CANCEL")


def _draw_estimate(layout, scene):
    expected = estimate_job.found(scene)
    if expected is None:
        return
    rows, fits = expected
    column = layout.column(align=True)
    for name, value in rows:
        row = column.row()
        row.label(text=name)
        right_label(row, value)
    if not fits:
        hint(layout, "Not enough memory: this build would be refused.")


def _draw_missing(layout, group):
    """Draws the input that a build still needs, with the button that adds it."""
    for number, rock in enumerate(group.rocks):
        has_region = rock.region is not None or rock.region_file or rock.region_stored
        if method_settings.interpolates(rock) and not has_region:
            hint(layout, f"{rock.name} has no region yet: draw one, choose a file in Rock Masses, or")
            layout.operator("realmodel.region_around", icon="SHADING_BBOX").rock = number


def _draw_problem(box, activity):
    box.alert = True
    row = box.row()
    message(row.column(align=True), activity.problem, taken=ICON)
    row.operator("realmodel.dismiss", text="", icon="X", emboss=False)
    if problems.has_place(bpy.context):
        box.operator("realmodel.show_problem", icon="VIEWZOOM")


def _draw_warnings(box, group, activity):
    """Draws warnings in full: folded the first ones, unfolded all."""
    messages = notices.read(group.warnings)
    row = box.row(align=True)
    count = "1 Message" if len(messages) == 1 else f"{len(messages)} Messages"
    icon = "DISCLOSURE_TRI_DOWN" if activity.unfolded else "DISCLOSURE_TRI_RIGHT"
    row.use_property_split = False
    row.alignment = "LEFT"
    if len(messages) > _FOLDED:
        row.prop(activity, "unfolded", text=count, icon=icon, emboss=False)
    else:
        row.label(text=count)
    cross = row.row()
    cross.alignment = "RIGHT"
    cross.operator("realmodel.dismiss", text="", icon="X", emboss=False)
    for text in messages if activity.unfolded else messages[:_FOLDED]:
        message(box.column(align=True), text, icon="INFO")
