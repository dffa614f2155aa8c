# SPDX-License-Identifier: GPL-3.0-or-later
"""Every panel of the tab, unfolded, drawn by Blender itself; the menus, and the status bar."""

import bpy
from realmodel.bl.objects import viewports
from realmodel.ui.panel import TabPanel
from steps_1_panel import idle, model, nothing_left_to_do, open_the_tab, tab_panels


def _wanted():
    """Names of the panels that are to be drawn now: none without its parent."""
    found = set()
    for cls in tab_panels():
        if getattr(cls, "bl_parent_id", None) in (None, *found) and (
            not hasattr(cls, "poll") or cls.poll(bpy.context)
        ):
            found.add(cls.__name__)
    return found


def _unfold():
    """No panel is folded when it is drawn for the first time."""
    panels = tab_panels()
    for cls in reversed(panels):
        bpy.utils.unregister_class(cls)
    for cls in panels:
        cls.bl_options = set(getattr(cls, "bl_options", ())) - {"DEFAULT_CLOSED"}
        bpy.utils.register_class(cls)


def every_panel_unfolded(walk):
    """Before a model, with its surfaces, and with its blocks: each panel that belongs there is drawn."""
    drawn, errors, draw = set(), [], TabPanel.draw

    def watched(self, context):
        drawn.add(type(self).__name__)
        try:
            draw(self, context)
        except BaseException as error:
            errors.append(f"{type(self).__name__}: {error}")
            raise

    _unfold()
    TabPanel.draw = watched
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    yield from open_the_tab(walk)
    for state, operator, arguments in (
        ("nothing", None, {}),
        ("surfaces", bpy.ops.realmodel.open_sample, {"sample": walk.sample}),
        ("blocks", bpy.ops.realmodel.build, {}),
        ("cut", bpy.ops.realmodel.section_plane, {}),
    ):
        if operator is not None:
            operator(**arguments)
        yield lambda: idle() and nothing_left_to_do()
        drawn.clear()
        yield walk.redrawn(2)
        walk.shot(f"panels_{state}")
        assert not errors, errors
        shown = _wanted()
        assert drawn == shown, (state, drawn ^ shown)
    TabPanel.draw = draw


def menus_open(walk):
    """F3 finds what stands in a menu of each kind."""
    yield from walk.command("model from top")
    yield walk.redrawn()
    view = walk.area.spaces.active.region_3d
    assert view.view_perspective == "ORTHO" and abs(view.view_rotation[0]) > 0.999, view.view_rotation
    before = len(model().rocks)
    yield from walk.command("rock mass")
    yield lambda: len(model().rocks) == before + 1
    bpy.ops.realmodel.rock_remove()
    yield walk.redrawn()


def a_live_refusal_in_the_status_bar(walk):
    """The status bar has what is wrong with live building, until it is mended."""
    surface = model().rocks[0].surfaces[-1]
    kept = surface.source
    model().live = True
    yield nothing_left_to_do
    surface.source = "MESH_OBJECT" if surface.object is None else "NONE"
    yield nothing_left_to_do
    yield walk.redrawn(2)
    assert bpy.context.window_manager.realmodel.problem
    assert list(viewports._status.values()) == [bpy.context.window_manager.realmodel.problem]
    walk.shot("status_bar")
    surface.source = kept
    yield nothing_left_to_do
    assert not any(viewports._status.values())
    model().live = False


STEPS = (every_panel_unfolded, menus_open, a_live_refusal_in_the_status_bar)
