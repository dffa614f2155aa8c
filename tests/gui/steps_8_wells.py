# SPDX-License-Identifier: GPL-3.0-or-later
"""Wells and fault sticks of a new user: seen when they are imported, in the right order, built more than
once; a pit that is added is seen, and so is the place of a refusal."""

import bpy
import numpy as np
from realmodel.bl.scene import problems
from steps_1_panel import idle, model, open_the_tab, volumes
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _object, _select, _show_alone

_HOLES = [(n, 60.0 * (n % 4), 80.0 * (n // 4)) for n in range(12)]
_TOPS = [("silt", 10.0), ("sand", 30.0), ("clay", 60.0)]  # depths, dipping to the east


def _write_picks(path):
    lines = ["hole,x,y,z,surface,depth"]
    for n, x, y in _HOLES:
        lines += [
            f"B{n},{x},{y},100,{name},{depth + 0.2 * x}" for name, depth in _TOPS if name != "clay" or x < 100
        ]
    path.write_text("\n".join(lines) + "\n")


def empty_file(walk):
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn()
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    yield from open_the_tab(walk)


def boreholes_are_tubes(walk):
    """The holes are seen as tubes at once. The clay is known up dip alone, where it lies higher than the mean
    of the others; still it is the oldest."""
    _write_picks(walk.folder / "picks.csv")
    with in_the_viewport(walk):
        bpy.ops.realmodel.boreholes_read(filepath=str(walk.folder / "picks.csv"))
        bpy.context.space_data.overlay.show_floor = False
    walk.over_viewport()
    yield walk.redrawn(3)
    picture = walk.shot("boreholes")
    item = bpy.data.objects["rock mass boreholes"]
    places = [item.matrix_world @ v.co for v in item.data.vertices]
    seen = 0
    for edge in item.data.edges:
        first, last = (np.array(walk.pixel_of(places[v])) for v in edge.vertices)
        x, y = ((first + last) / 2).astype(int)
        tube, beside = (picture[y - 1 : y + 2, x + a : x + a + 3].mean(axis=(0, 1)) for a in (-1, 20))
        seen += np.abs(tube - beside).max() > 0.08
    assert seen > 0.8 * len(item.data.edges), f"{seen} of {len(item.data.edges)} tubes are seen"
    assert [s.name for s in model().rocks[0].surfaces] == ["clay", "sand", "silt"]
    (walk.folder / "picks.csv").unlink()


def a_pit_is_seen(walk):
    """A younger surface is added to a built model; after the build the stage is its own, and the pit is
    there."""
    with in_the_viewport(walk):
        bpy.ops.realmodel.region_around()
    for row in model().rocks[0].surfaces:
        row.method = "plane"
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 2
    yield walk.redrawn(2)
    before = walk.shot("before_the_pit")
    assert model().stage == 2
    x, y, z = bpy.data.objects["silt"].bound_box[6]
    corners = [(0, 0, z + 5), (x, 0, z + 5), (x, y, z + 5), (0, y, z + 5), (x / 2, y / 2, z - 70)]
    _select([_object("pit", corners, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])])
    with in_the_viewport(walk):
        bpy.ops.realmodel.surface_add(use_object=True)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 3
    yield walk.redrawn(2)
    after = walk.shot("with_the_pit")
    assert model().stage == 3
    assert volumes()["silt block"] > 0
    assert np.abs(after - before).max() > 0.2, "nothing has changed on the screen"


def sticks_are_lines(walk):
    """Fault sticks that end within the rock are seen when they are imported."""
    yield from empty_file(walk)
    with in_the_viewport(walk):
        _select([_object(f"S{n}", *_sheet(20.0 * n)) for n in range(2)])
        bpy.ops.realmodel.from_selected()
    sticks = [[(60.0 + h / 4, y, h) for h in (40, 10, -20)] for y in (30, 50, 70)]
    path = walk.folder / "sticks.pol"
    path.write_text("".join("".join(f"{x} {y} {z}\n" for x, y, z in s) + "999 999 999\n" for s in sticks))
    with in_the_viewport(walk):
        bpy.ops.realmodel.fault_body_add(filepath=str(path))
        bpy.context.space_data.overlay.show_floor = False
    yield walk.redrawn(3)
    walk.shot("sticks")
    assert len(bpy.data.objects["sticks sticks"].data.edges) == 6


def _sheet(height):
    corners = [(x, y, height) for x, y in ((0, 0), (100, 0), (100, 100), (0, 100))]
    return corners, [[0, 1, 2], [0, 2, 3]]


def the_place_of_a_refusal(walk):
    """The fault is refused in the words of the panel; Zoom to Error goes to the place, though there is no
    surface yet."""
    panels = _show_alone({"REALMODEL_PT_start", "REALMODEL_PT_build", "REALMODEL_PT_structures"})
    try:
        walk.over_viewport()
        invoked(walk, bpy.ops.realmodel.build)
        yield lambda: idle() and bpy.context.window_manager.realmodel.problem
        yield walk.redrawn(2)
        walk.shot("refused")
        walk.key("ESC")  # the report stands open until it is read
        yield walk.redrawn(2)
        problem = bpy.context.window_manager.realmodel.problem
        assert "Dies Out" in problem and "_" not in problem, problem
        assert problems.has_place(bpy.context)
        walk.shot("refused_in_the_panel")
        view = walk.area.spaces.active.region_3d
        before = view.view_distance
        with in_the_viewport(walk):
            bpy.ops.realmodel.show_problem()
        yield walk.redrawn(3)
        walk.shot("zoomed")
        assert view.view_distance < before / 2
        x, y, z = bpy.context.scene.cursor.location
        assert 0 <= x <= 100 and 0 <= y <= 100 and 0 <= z <= 20, (x, y, z)
    finally:
        for cls in panels:
            if not cls.is_registered:
                bpy.utils.register_class(cls)


def extended_and_built_again(walk):
    """With Extend it is built, and built again."""
    fault = model().faults[0]
    fault.extend = 60.0
    for _ in range(2):
        walk.over_viewport()
        invoked(walk, bpy.ops.realmodel.build)
        yield idle
        yield walk.redrawn(2)
        assert bpy.context.window_manager.realmodel.problem == "", (
            bpy.context.window_manager.realmodel.problem
        )
        assert len(model().results) == 1
        yield walk.redrawn()
    walk.shot("extended")
    (walk.folder / "sticks.pol").unlink()


STEPS = (
    empty_file,
    boreholes_are_tubes,
    a_pit_is_seen,
    sticks_are_lines,
    the_place_of_a_refusal,
    extended_and_built_again,
)
