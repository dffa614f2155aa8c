# SPDX-License-Identifier: GPL-3.0-or-later
"""From an empty file to a built model, an edit, undo, save and open again."""

import bpy
import numpy as np
from driver import hue_differs
from realmodel.bl.display import viewpoints
from realmodel.bl.objects import viewports
from realmodel.bl.scene import live
from realmodel.ui import start
from realmodel.ui.panel import TabPanel


def model():
    return bpy.context.scene.realmodel


def idle():
    return not bpy.context.window_manager.realmodel.running


def volumes():
    return {row.name: float(row.volume_exact) for row in model().results}


def nothing_left_to_do():
    return not live.is_working()


def tab_panels():
    """The panels of the tab RealModel, each after the one that it is within."""
    of_tab = [cls for cls in bpy.types.Panel.__subclasses__() if issubclass(cls, TabPanel)]
    of_tab = [cls for cls in of_tab if cls.bl_category == TabPanel.bl_category]
    return sorted((cls for cls in of_tab if cls.is_registered), key=lambda cls: hasattr(cls, "bl_parent_id"))


def found_tab(walk, panel, method):
    """N opens the sidebar, a click the tab of a panel, which is known by a method that draws it."""
    drawn, before = [], getattr(panel, method)

    def draw(self, *arguments):
        drawn.append(True)
        before(self, *arguments)

    setattr(panel, method, draw)
    walk.over_viewport()
    walk.key("ESC")
    yield walk.redrawn()
    if not walk.area.spaces.active.show_region_ui:
        walk.key("N")
    yield lambda: walk.region("UI").width > 50
    region = walk.region("UI")
    for down in range(20, region.height - 20, 20):
        walk.click(region.x + region.width - 8, region.y + region.height - down)
        yield walk.redrawn()
        if drawn:
            break
    setattr(panel, method, before)
    assert drawn, f"the tab {panel.bl_category} was not found"
    walk.over_viewport()
    yield walk.redrawn()


def open_the_tab(walk):
    """N opens the sidebar, a click its tab."""
    yield from found_tab(walk, start.REALMODEL_PT_start, "draw_in")
    walk.shot("empty")


def open_the_example(walk):
    """F3, its name, Enter: it is built at once, with progress."""
    yield from walk.command({"two_layers": "two layers", "castle_hill": "castle hill"}[walk.sample])
    yield lambda: len(model().rocks) == 1
    walk.shot("opened")
    yield lambda: len(model().results) > 0 and idle()
    assert viewpoints.camera_sees(bpy.context.scene), "F12 would not show the model"


def look_at_it(walk):
    """The blocks stand where the viewport looks, in the library's colors; there is no wall of warnings."""
    yield walk.redrawn(2)
    assert len(model().warnings.split("\n")) < 2, model().warnings
    picture = walk.shot("built")
    shown = 0
    for row in model().results:
        if row.object is None:
            continue
        try:
            place = walk.visible_place(row.object.name)
        except AssertionError:
            continue  # it lies inside
        wanted = next(e.color for e in model().library if e.id == row.property_id)
        seen = walk.color_at(picture, place)
        assert hue_differs(seen, wanted) < 0.1, (row.name, tuple(wanted), seen)
        shown += 1
    assert shown >= 2, "fewer than two blocks show their color"
    corners = viewports.corners([row.object for row in model().results if row.object is not None])
    across = viewports.pixels(walk.area, corners)[:, 0] + walk.region("WINDOW").x
    tools, sidebar = walk.region("TOOLS"), walk.region("UI")
    assert tools.x + tools.width <= across.min(), "the toolbar covers the model"
    assert across.max() <= sidebar.x, "the sidebar covers the model"


def choose_a_block(walk):
    """A row of the results selects its block."""
    model().active_result = len(model().results) - 1
    yield walk.redrawn()
    chosen = [item.name for item in bpy.context.selected_objects]
    assert chosen == [model().results[-1].object.name], chosen
    walk.shot("chosen")


def cancel_a_build(walk):
    """Esc stops a long build: progress was shown meanwhile, and nothing has changed. With Auto on the panel
    says why."""
    before, rock = volumes(), model().rocks[0]
    model().live = True
    edge_length = rock.edge_length
    rock.edge_length = edge_length / 40.0
    yield from walk.command("build")
    yield lambda: bpy.context.window_manager.realmodel.progress > 0.5 or idle()
    yield walk.redrawn()
    assert not idle(), "the build was over before it could be cancelled"
    walk.shot("building")
    walk.key("ESC")
    yield idle
    assert volumes() == before
    assert "cancelled" in bpy.context.window_manager.realmodel.problem
    model().live = False
    rock.edge_length = edge_length
    yield walk.redrawn()


def change_a_rule(walk):
    """The blocks follow a rule that is changed."""
    before, picture = volumes(), walk.shot("before_the_rule")
    youngest = model().rocks[0].surfaces[-1]
    youngest.rule = "conformable"
    yield from walk.command("build")
    yield lambda: idle() and volumes() != before
    yield walk.redrawn(2)
    after = walk.shot("after_the_rule")
    assert sum(volumes().values()) > sum(before.values()), "nothing is cut away any more"
    assert np.abs(after - picture).max() > 0.2, "nothing has changed on the screen"
    youngest.rule = "erosional"
    yield from walk.command("build")
    yield lambda: idle() and volumes() == before


def edit_live(walk):
    """A vertex is pulled up in edit mode; the block follows after a short pause."""
    model().live = True
    yield nothing_left_to_do
    before = volumes()
    item = model().rocks[0].surfaces[-1].interface
    item.hide_set(False)
    for other in bpy.context.view_layer.objects:
        other.select_set(other == item)
    bpy.context.view_layer.objects.active = item
    for elements in (item.data.vertices, item.data.edges, item.data.polygons):
        elements.foreach_set("select", np.zeros(len(elements), bool))
    middle = np.mean([v.co[:2] for v in item.data.vertices], axis=0)
    nearest = min(item.data.vertices, key=lambda v: np.hypot(*(np.array(v.co[:2]) - middle)))
    nearest.select = True
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    walk.over_viewport()
    yield walk.redrawn()
    walk.key("TAB")
    yield lambda: bpy.context.mode == "EDIT_MESH"
    for letter in ("g", "z", "5"):
        walk.write(letter)
    yield walk.redrawn()
    walk.key("RET")
    yield lambda: volumes() != before and nothing_left_to_do()
    assert bpy.context.mode == "EDIT_MESH", "the edit was left for the build"
    assert sum(volumes().values()) > sum(before.values())
    yield walk.redrawn(2)
    walk.shot("live_edit")
    print(
        f"walk: live: {live.measured[bpy.context.scene.name]:.2f} s from the edit to the new block",
        flush=True,
    )
    walk.key("TAB")
    yield lambda: bpy.context.mode == "OBJECT"
    yield nothing_left_to_do


def undo_the_edit(walk):
    """Ctrl-Z until the model is as it was, and the blocks follow."""
    edited = volumes()
    walk.over_viewport()
    for _ in range(3):
        walk.key("Z", ctrl=True)
        yield walk.redrawn()
        yield nothing_left_to_do
        if sum(volumes().values()) < sum(edited.values()) - 1e-3:
            break
    assert sum(volumes().values()) < sum(edited.values()), "undo did not bring the blocks back"
    if bpy.context.mode != "OBJECT":
        walk.key("TAB")
        yield lambda: bpy.context.mode == "OBJECT"
    model().live = False
    yield nothing_left_to_do
    yield walk.redrawn()
    walk.shot("undone")


def show_a_bad_place(walk):
    """A surface that is folded over is refused, and the mode stays; the place is selected in edit mode by a
    command."""
    item = model().rocks[0].surfaces[-1].interface
    before = volumes()
    middle = np.mean([v.co[:2] for v in item.data.vertices], axis=0)
    nearest = min(item.data.vertices, key=lambda v: np.hypot(*(np.array(v.co[:2]) - middle)))
    kept = nearest.index, nearest.co.x
    nearest.co.x += 6.0 * model().rocks[0].edge_length
    item.data.update()
    yield from walk.command("build")
    yield lambda: "overlap in plan" in bpy.context.window_manager.realmodel.problem
    yield walk.redrawn(2)
    assert bpy.context.mode == "OBJECT"
    assert volumes() == before
    walk.over_viewport()
    walk.key("ESC")  # the report stands open in front of everything until it is read
    yield walk.redrawn(2)
    yield from walk.command("zoom to error")
    yield lambda: bpy.context.mode == "EDIT_MESH"
    yield walk.redrawn(2)
    walk.shot("bad_place")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert 0 < sum(p.select for p in item.data.polygons) < len(item.data.polygons) / 2
    item.data.vertices[kept[0]].co.x = kept[1]
    item.data.update()


def save_and_open(walk):
    """Ctrl-S, and the file opened again has the model."""
    before = volumes()
    path = walk.folder / "walk.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    model().name, written = "saved by hand", path.stat().st_mtime_ns
    walk.over_viewport()
    walk.key("S", ctrl=True)
    yield lambda: path.stat().st_mtime_ns != written
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    yield walk.redrawn(2)
    assert model().name == "saved by hand"
    assert volumes() == before
    walk.shot("opened_again")
    path.unlink()


STEPS = (
    open_the_tab,
    open_the_example,
    look_at_it,
    choose_a_block,
    cancel_a_build,
    change_a_rule,
    edit_live,
    undo_the_edit,
    show_a_bad_place,
    save_and_open,
)
