# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of a surface as a chart in the sidebar, and sections beside the model."""

import bpy
import numpy as np
from realmodel.bl.scene import quality
from realmodel.ui import judge
from realmodel.ui.panel import TabPanel
from steps_2_view import in_the_viewport

_BLUE = (0.12, 0.42, 0.70)


class OnTop(TabPanel, bpy.types.Panel):
    """The panel, open and where it is seen without scrolling."""

    bl_label = "Quality"
    bl_idname = "REALMODEL_PT_quality_on_top"
    bl_order = -1
    draw_in = judge.REALMODEL_PT_quality.draw_in


def charts(walk):
    """Checked in a thread; then each chart is a white page with something on it, as wide as the sidebar."""
    with in_the_viewport(walk):
        bpy.ops.realmodel.open_sample(sample="gravel_plain")
        if not len(bpy.context.scene.realmodel.results):
            bpy.ops.realmodel.build()
    walk.area.spaces.active.show_region_ui = True
    rock = bpy.context.scene.realmodel.rocks[0]
    rock.active_surface = next(k for k, row in enumerate(rock.surfaces) if "POINTS" in row.source)
    bpy.utils.register_class(OnTop)
    yield walk.redrawn(3)
    bpy.ops.realmodel.check_quality("INVOKE_DEFAULT")
    yield lambda: quality.found(bpy.context.scene) is not None
    for chart, *_ in quality.CHARTS:
        bpy.context.window_manager.realmodel.chart = chart
        yield walk.redrawn(3)
        shown = walk.shot(f"quality_{chart.lower()}")
        region = walk.region("UI")
        sidebar = shown[region.y : region.y + region.height, region.x : region.x + region.width]
        page = (sidebar > 0.97).all(axis=2)
        assert page.sum() > 5000, (chart, page.sum())
        across = np.flatnonzero(page.sum(axis=0) > 40)
        assert np.ptp(across) > 0.6 * region.width, (chart, np.ptp(across), region.width)
        assert (np.abs(sidebar - _BLUE).max(axis=2) < 0.08).sum() > 50, chart
    bpy.utils.unregister_class(OnTop)


def sections(walk):
    """A section in its place and a fence beside the model, stretched with it."""
    scene = bpy.context.scene
    curve = bpy.data.curves.new("Line", "CURVE")
    spline = curve.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(spline.points, ((-300, -200), (0, 250), (350, -100)), strict=True):
        point.co = (*place, 0, 1)
    line = bpy.data.objects.new("Line", curve)
    scene.collection.objects.link(line)
    scene.realmodel.view.exaggeration = 5.0
    with in_the_viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    yield lambda: bool(scene.realmodel.view.cut)
    with in_the_viewport(walk):
        bpy.ops.realmodel.section()
        bpy.context.view_layer.objects.active = line
        bpy.ops.realmodel.fence(flat=True)
        fence = bpy.context.view_layer.objects.active
        bpy.ops.realmodel.view_all()
    yield walk.redrawn(3)
    walk.shot("sections")
    assert abs(fence.dimensions.x - curve_length(line)) < 1.0, (fence.dimensions, curve_length(line))
    bpy.ops.realmodel.section_remove()
    scene.realmodel.view.exaggeration = 1.0


def curve_length(line):
    places = np.array([point.co[:2] for point in line.data.splines[0].points])
    return float(np.hypot(*np.diff(places, axis=0).T).sum())


STEPS = (charts, sections)
