# SPDX-License-Identifier: GPL-3.0-or-later
"""A geologist draws: contacts by clicks and strokes on the section plane, then on a scanned section; a hole
is planned and its table is read."""

import bpy
import numpy as np
from driver import hue_differs
from realmodel.bl.display import cuts
from realmodel.bl.field import drawn_data
from realmodel.bl.objects import viewports
from realmodel.bl.project import project_settings
from realmodel.bl.scene import data_objects, planned_holes, section_holes
from steps_1_panel import idle, model, volumes
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _object, _select, _show_alone
from steps_8_wells import _sheet, _write_picks, empty_file


def a_surface_to_draw(walk):
    """A base, and a level surface through four points."""
    yield from empty_file(walk)
    path = walk.folder / "top.csv"
    path.write_text("x,y,z\n" + "".join(f"{x},{y},40\n" for x in (2, 98) for y in (2, 98)))
    with in_the_viewport(walk):
        _select([_object("base", *_sheet(0.0))])
        bpy.ops.realmodel.from_selected()
        bpy.ops.realmodel.surface_add(filepath=str(path))
        bpy.ops.realmodel.region_around()
        model().rocks[0].edge_length = 8.0
        model().rocks[0].surfaces[1].method = "natural_neighbour"
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 1
    model().rocks[0].active_surface = 1
    path.unlink()


def contacts_are_drawn(walk):
    """Clicks on the plane become points where they were made, in one step of undo; Backspace takes one back,
    Esc all."""
    with in_the_viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
        bpy.ops.realmodel.view(direction="FRONT")
        bpy.context.space_data.region_3d.view_distance *= 1.6
    yield walk.redrawn(3)
    plane = drawn_data.plane(bpy.context)
    wanted = [(30.0, 55.0), (50.0, 60.0), (70.0, 55.0)]
    places = [(x, plane[0][1], z) for x, z in wanted]
    pixels = [walk.pixel_of(place) for place in project_settings.in_world(bpy.context.scene, places)]
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.draw_contacts)
    for x, y in [*pixels, (pixels[-1][0] + 40, pixels[-1][1] - 60)]:
        walk.click(x, y)
        yield walk.redrawn()
    walk.key("BACK_SPACE")
    yield walk.redrawn(2)
    picture = walk.shot("drawing_contacts")
    for x, y in pixels:
        red, green, blue = picture[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3).mean(axis=0)
        assert red > 0.6 and red > green + 0.2 > blue, "what was clicked is not seen"
    walk.key("RET")
    yield lambda: len(data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])) == 7
    found = data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])[4:]
    assert np.abs(found - places).max() < 0.5, found
    bpy.ops.ed.undo()
    yield walk.redrawn(2)
    assert len(data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])) == 4
    bpy.ops.ed.redo()
    yield walk.redrawn(2)
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.draw_contacts)
    walk.click(*pixels[0])
    yield walk.redrawn()
    walk.key("ESC")
    yield walk.redrawn(2)
    assert len(data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])) == 7


def the_model_follows_a_stroke(walk):
    """A line drawn with the button held, and the live model with it."""
    before = volumes()["top block"]
    model().live = True
    yield idle
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.draw_contacts)
    y = drawn_data.plane(bpy.context)[0][1]
    ends = [walk.pixel_of(place) for place in ((20.0, y, 47.0), (80.0, y, 53.0))]
    (x0, y0), (x1, y1) = ends
    walk.move(x0, y0)
    walk.window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x0, y=y0)
    for share in np.linspace(0.0, 1.0, 12):
        walk.move(x0 + share * (x1 - x0), y0 + share * (y1 - y0))
        yield walk.redrawn()
    walk.window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=x1, y=y1)
    yield walk.redrawn(2)
    walk.shot("drawing_a_stroke")
    walk.key("RET")
    yield lambda: len(data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])) > 12
    yield lambda: volumes()["top block"] > before + 1000
    yield walk.redrawn(3)
    walk.shot("drawn_and_built")
    model().live = False
    with in_the_viewport(walk):
        bpy.ops.realmodel.section_remove()


def a_scan_is_drawn_on(walk):
    """A scanned section stands where its coordinates say, and is drawn on."""
    image = bpy.data.images.new("scan", 60, 40)
    pixels = np.ones((40, 60, 4), np.float32)
    pixels[:20], pixels[20:] = (0.8, 0.7, 0.2, 1.0), (0.2, 0.4, 0.8, 1.0)
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(walk.folder / "scan_.png"), "PNG"
    image.save()
    with in_the_viewport(walk):
        bpy.ops.realmodel.image_place(
            filepath=str(walk.folder / "scan_.png"),
            first="0, -10",
            second="100, -10",
            heights="0, 66",
        )
    (walk.folder / "scan_.png").unlink()
    yield walk.redrawn(3)
    picture = walk.shot("placed_image")
    low, high = (walk.color_at(picture, (50.0, -10.0, z)) for z in (15.0, 55.0))
    assert low[0] > low[2] + 0.2 and high[2] > high[0] + 0.2, (low, high)
    before = len(data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1]))
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.draw_contacts)
    walk.click(*walk.pixel_of((50.0, -10.0, 33.0)))
    yield walk.redrawn()
    walk.key("RET")
    yield lambda: len(data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])) == before + 1
    point = data_objects.read_points(bpy.context.scene, model().rocks[0].surfaces[1])[-1]
    assert np.abs(point - (50.0, -10.0, 33.0)).max() < 0.5, point


def a_hole_is_planned(walk):
    """The tube is seen beside the model, and the table in the sidebar."""
    panels = _show_alone({"REALMODEL_PT_start", "REALMODEL_PT_results", "REALMODEL_PT_planned_holes"})
    try:
        yield from empty_file(walk)
        with in_the_viewport(walk):
            _select([_object(f"S{n}", *_sheet(20.0 * n)) for n in range(4)])
            bpy.ops.realmodel.from_selected()
        walk.over_viewport()
        invoked(walk, bpy.ops.realmodel.build)
        yield lambda: idle() and len(model().results) == 3
        with in_the_viewport(walk):
            bpy.ops.realmodel.planned_hole_add()
            row = model().planned_holes[0]
            row.east, row.north, row.height = "-40", "50", "90"
            row.azimuth, row.dip, row.length = 90.0, 40.0, 130.0
            bpy.ops.realmodel.section_plane(axis="Y")
            bpy.ops.realmodel.view(direction="FRONT")
        sidebar = walk.region("UI")
        x, y = sidebar.x + sidebar.width // 3, sidebar.y + sidebar.height // 3
        walk.move(x, y)
        for _ in range(9):
            walk.window.event_simulate(type="WHEELDOWNMOUSE", value="PRESS", x=x, y=y)
            yield walk.redrawn()
        walk.over_viewport()
        yield lambda: cuts.is_shown(bpy.context.scene)
        yield walk.redrawn(4)
        picture = walk.shot("planned_hole")
        hole = planned_holes.kept(row)
        assert [hole.block_names[each.block] for each in hole.intervals] == [f"S{n} block" for n in (3, 2, 1)]
        for each in hole.intervals:  # the tube stands out from the cut, in the color of its block
            (place,) = hole.axis.places([max(0.5 * (each.begin + each.end), 70.0)])
            x, y = walk.pixel_of(place)
            tube, beside = (picture[y - 12 : y + 13, x + a : x + a + 25] for a in (-12, 60))
            assert tube.std(axis=(0, 1)).max() > 3 * beside.std(axis=(0, 1)).max() + 0.01
            assert hue_differs(picture[y, x], beside.mean(axis=(0, 1))) < 0.05
        item = next(o for o in bpy.data.objects if o.get("realmodel_view") == "planned")
        assert len({p.material_index for p in item.data.polygons}) == 4
    finally:
        for cls in panels:
            if not cls.is_registered:
                bpy.utils.register_class(cls)


def holes_are_picked(walk):
    """Boreholes are clicked one after another; the section goes through them."""
    yield from empty_file(walk)
    _write_picks(walk.folder / "picks.csv")
    with in_the_viewport(walk):
        bpy.ops.realmodel.boreholes_read(filepath=str(walk.folder / "picks.csv"))
        bpy.ops.realmodel.region_around()
    (walk.folder / "picks.csv").unlink()
    for row in model().rocks[0].surfaces:
        row.method = "plane"
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 2
    model().display = "LINES"
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="TOP")
        bpy.context.space_data.region_3d.view_distance *= 1.6
    yield walk.redrawn(3)
    lines = section_holes.paths(bpy.context.scene)
    names = ["B1", "B6", "B10"]
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.pick_holes)
    for name in [*names, "B3"]:
        walk.click(*walk.pixel_of(project_settings.in_world(bpy.context.scene, lines[name][0])[0]))
        yield walk.redrawn(2)
    walk.key("BACK_SPACE")
    yield walk.redrawn(2)
    walk.shot("picking_holes")
    walk.key("RET")
    yield lambda: section_holes.chosen(bpy.context.scene) == names
    model().display = "BLOCKS"
    with in_the_viewport(walk):
        bpy.ops.realmodel.fence_holes()
        bpy.ops.realmodel.hide_property(action="HIDE", property_id=model().results[0].property_id)
        bpy.ops.realmodel.hide_property(action="HIDE", property_id=model().results[1].property_id)
        walk.area.spaces.active.region_3d.view_rotation = viewports.view_rotation().to_quaternion()
    yield walk.redrawn(4)
    walk.shot("section_through_holes")
    made = bpy.context.active_object
    assert made.name.startswith("Holes") and len(made.data.polygons) > 3


STEPS = (
    a_surface_to_draw,
    contacts_are_drawn,
    the_model_follows_a_stroke,
    a_scan_is_drawn_on,
    a_hole_is_planned,
    holes_are_picked,
)
