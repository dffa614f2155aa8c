# SPDX-License-Identifier: GPL-3.0-or-later
"""An ensemble from the panel: Esc while it is made; then its table, and its section in each coloring."""

import itertools

import bpy
import numpy as np
from realmodel.bl.display import ensembles
from realmodel.ui import ensemble
from realmodel.ui.panel import TabPanel
from steps_1_panel import idle, model, open_the_tab
from steps_3_import import invoked


class EnsembleOnTop(TabPanel, bpy.types.Panel):
    """The panel, open and where it is seen without scrolling."""

    bl_label = "Ensemble"
    bl_idname = "REALMODEL_PT_ensemble_on_top"
    bl_order = -1
    draw_in = ensemble.REALMODEL_PT_ensemble.draw_in


def cancel_an_ensemble(walk):
    """Esc stops it while progress is shown; the scene has no ensemble."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.open_sample, sample="uncertain_valley")
    yield lambda: len(model().results) > 0 and idle()
    bpy.utils.register_class(EnsembleOnTop)
    yield from open_the_tab(walk)
    invoked(walk, bpy.ops.realmodel.section_plane, axis="X")
    model().view.exaggeration = 5.0
    yield walk.redrawn(3)
    invoked(walk, bpy.ops.realmodel.ensemble, realizations=1000)
    yield lambda: "of 1000" in bpy.context.window_manager.realmodel.text or idle()
    yield walk.redrawn(2)
    assert not idle(), "it was over before it could be cancelled"
    walk.shot("ensemble_in_work")
    walk.key("ESC")
    yield idle
    assert ensembles.table(bpy.context.scene) is None


def ensemble_in_the_panel(walk):
    """The table has percentiles; the colors of the section follow the panel."""
    invoked(walk, bpy.ops.realmodel.ensemble, realizations=20, seed=1)
    yield lambda: ensembles.table(bpy.context.scene) is not None and idle()
    model().view.use_section = True
    for item in bpy.context.scene.objects:
        if item.get("realmodel") == "block":
            item.hide_set(True)
    invoked(walk, bpy.ops.realmodel.view, direction="RIGHT")
    pictures = []
    for color_by, *_ in ensembles.COLORS:
        model().ensemble.color_by = color_by
        yield walk.redrawn(3)
        pictures.append(walk.shot(f"ensemble_{color_by.lower()}"))
    model().ensemble.realization = 13
    yield walk.redrawn(3)
    pictures.append(walk.shot("ensemble_realization_13"))
    for one, other in itertools.pairwise(pictures):
        assert (np.abs(one - other).max(axis=2) > 0.1).sum() > 300
    bpy.utils.unregister_class(EnsembleOnTop)


STEPS = (cancel_an_ensemble, ensemble_in_the_panel)
