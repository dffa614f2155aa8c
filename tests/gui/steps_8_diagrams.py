# SPDX-License-Identifier: GPL-3.0-or-later
"""A stereonet beside the model: dips are brushed over in the viewport, a pole that is clicked leads to its
dip; and what lies on both sides of a fault in an image editor."""

from pathlib import Path

import bpy
import numpy as np
from realmodel.bl.field import handle, shown_net
from realmodel.bl.overlay import corner_of_net, viewport
from realmodel.bl.project import project_settings
from realmodel.core.results.orientations.axes import projected
from realmodel.core.results.orientations.stereonet import small_net
from steps_1_panel import idle, model
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _show_alone
from steps_8_wells import empty_file

_SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"


def _pixel_of_pole(walk, pole):
    """The window pixel of a pole in the stereonet."""
    region, scale = walk.region("WINDOW"), viewport._scale()
    width = region.width / scale
    middle, radius = small_net(corner_of_net(width, viewport._margins(walk.area, scale)))
    (place,) = projected(pole[None])
    x, y = (np.array(middle) + radius * place) * scale
    return int(x) + region.x, int(y) + region.y


def dips_are_brushed_over(walk):
    yield from empty_file(walk)
    walk.panels = _show_alone({"REALMODEL_PT_field"})
    with in_the_viewport(walk):
        bpy.ops.realmodel.open_project(filepath=str(_SAMPLES / "faulted_dome" / "project.toml"))
    view = model().view
    view.show_dips = view.show_stereonet = True
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="TOP")
        bpy.ops.view3d.view_all()
    yield walk.redrawn(3)
    walk.shot("stereonet")
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.dips_pick)
    group = next(group for group in shown_net.data.groups(bpy.context.scene, shown_net.data.DIPS))
    origin = project_settings.model_origin(bpy.context.scene)
    for number in (0, 7, 9):
        x, y = walk.pixel_of(group.places[number] - origin)
        walk.click(x, y)
        yield walk.redrawn()
    walk.key("RET")
    yield lambda: bool(view.picked_dips)
    yield walk.redrawn(3)
    walk.shot("picked_dips")
    places = {datum.place for datum in shown_net.picked(bpy.context.scene)}
    assert {tuple(group.places[n].tolist()) for n in (0, 7, 9)} <= places and len(places) < 30


def a_pole_leads_to_its_dip(walk):
    scene = bpy.context.scene
    datum = shown_net.picked(scene)[0]
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.datum_pick)
    walk.click(*_pixel_of_pole(walk, shown_net.normal_of(scene, datum)))
    yield lambda: handle.active(scene) == datum
    yield walk.redrawn(3)
    picture = walk.shot("pole_picked")
    x, y = _pixel_of_pole(walk, shown_net.normal_of(scene, datum))
    color = picture[y, x]
    assert color[0] > 0.8 and 0.4 < color[1] < 0.7 and color[2] < 0.2, "the pole is not marked"
    with in_the_viewport(walk):
        bpy.ops.realmodel.datum_leave()
    for cls in walk.panels:
        if not cls.is_registered:
            bpy.utils.register_class(cls)


def a_fault_in_an_image_editor(walk):
    yield from empty_file(walk)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.open_sample, sample="fault_blocks")
    yield lambda: idle() and len(model().results) > 0
    model().structure_kind = "FAULT"
    with in_the_viewport(walk):
        bpy.ops.realmodel.view_juxtaposition()
    yield walk.redrawn(3)
    windows = bpy.context.window_manager.windows
    areas = [area for window in windows for area in window.screen.areas if area.type == "IMAGE_EDITOR"]
    assert [area.spaces.active.image.name for area in areas] == ["Juxtaposition main fault"]
    walk.shot("juxtaposition")
    with in_the_viewport(walk):
        bpy.ops.realmodel.view_juxtaposition(exaggeration=2.0)
    assert len(bpy.context.window_manager.windows) == 2, "the open editor shows it"
    with bpy.context.temp_override(window=windows[1]):
        bpy.ops.wm.window_close()
    yield walk.redrawn(2)


STEPS = (dips_are_brushed_over, a_pole_leads_to_its_dip, a_fault_in_an_image_editor)
