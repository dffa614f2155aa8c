# SPDX-License-Identifier: GPL-3.0-or-later
"""A geologist's field data: grades along the holes with their color bar and names, dips as discs, a contact
that is picked and dragged while the model follows, undo, the list of what does not fit, holes on the cut."""

import bpy
import numpy as np
from realmodel.bl.field import data, handle
from realmodel.bl.project import project_settings
from realmodel.bl.scene import live
from steps_1_panel import idle, model, volumes
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _show_alone
from steps_8_wells import empty_file

_HOLES = [(n, 100.0 + 200.0 * (n % 4), 100.0 + 200.0 * (n // 4)) for n in range(12)]
_PANELS = {
    *("REALMODEL_PT_field", "REALMODEL_PT_field_misfits"),
    *("REALMODEL_PT_results", "REALMODEL_PT_hole_validation"),
}


def _write(folder):
    """Gravel on clay on rock; the clay dips to the east. Of one hole the clay is 60 m too low."""
    logs, assays = ["hole,from,to,lith"], ["hole,from,to,Au"]
    for n, x, _ in _HOLES:
        top = 40.0 + 0.05 * x
        base = top + 60.0 + (60.0 if n == 5 else 0.0)
        logs += [f"B{n},0,{top},Gravel", f"B{n},{top},{base},Clay", f"B{n},{base},220,Rock"]
        assays += [f"B{n},{20 * k},{20 * k + 20},{0.1 * n + 0.3 * k}" for k in range(11)]
    tables = {
        "collars": ["hole,x,y,z", *(f"B{n},{x},{y},300" for n, x, y in _HOLES)],
        "logs": logs,
        "assays": assays,
        "dips": ["x,y,z,dip,dip_direction", "200,200,250,3,90", "600,400,230,3,90", "400,600,240,60,200"],
    }
    for name, lines in tables.items():
        (folder / f"field_{name}.csv").write_text("\n".join(lines) + "\n")
    return [folder / f"field_{name}.csv" for name in tables]


def _offset(place):
    return np.array(place) - project_settings.model_origin(bpy.context.scene)


def _datum(kind, hole, name):
    groups = (group for group in data.groups(bpy.context.scene) if group.kind == kind)
    found = ((group, n) for group in groups for n in range(len(group.places)))
    return next(g.datum(n) for g, n in found if (g.holes[n], g.names[n]) == (hole, name))


def grades_along_holes(walk):
    yield from empty_file(walk)
    walk.field = _write(walk.folder)
    *tables, dips = walk.field
    with in_the_viewport(walk):
        files = [{"name": path.name} for path in tables]
        folder = str(walk.folder)
        bpy.ops.realmodel.boreholes_read(filepath=str(tables[0]), directory=folder, files=files)
        rock = model().rocks[0]
        rock.active_surface = rock.surfaces.find("Clay")
        bpy.ops.realmodel.boreholes_read(filepath=str(dips))
        bpy.context.space_data.overlay.show_floor = False
        bpy.context.space_data.shading.color_type = "MATERIAL"
    view = model().view
    view.show_boreholes, view.boreholes_by, view.show_hole_names = True, "Au", True
    view.show_dips = True
    walk.panels = _show_alone(_PANELS)
    walk.over_viewport()
    yield walk.redrawn(3)
    picture = walk.shot("grades")
    region = walk.region("WINDOW")
    corner = picture[region.y + 5 : region.y + 160, region.x + 40 : region.x + 200]
    assert (corner.min(axis=2) > 0.85).mean() > 0.08, "there is no color bar"
    low, high = (walk.pixel_of(_offset((100, 100, z))) for z in (290, 90))
    colors = [picture[y - 1 : y + 2, x - 1 : x + 2].mean(axis=(0, 1)) for x, y in (low, high)]
    assert np.abs(colors[0] - colors[1]).max() > 0.15, "a hole has one color from top to bottom"


def built_with_misfits(walk):
    with in_the_viewport(walk):
        bpy.ops.realmodel.region_around()
    rock = model().rocks[0]
    rock.base_elevation, rock.edge_length = 0.0, 100.0
    for row in rock.surfaces:
        row.method = "universal_kriging" if row.name == "Clay" else "plane"
        row.tie = False
    model().view.show_misfits = True
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 3
    for row in model().results:
        row.object.hide_set(True)
    model().view.show_boreholes = model().view.show_hole_names = False
    yield walk.redrawn(3)
    picture = walk.shot("misfits")
    assert [row.source for row in model().misfits].count("B5") >= 1
    red = picture.reshape(-1, 3)
    assert ((red[:, 0] > 0.5) & (red[:, 1] < 0.3) & (red[:, 2] < 0.3)).any(), "nothing is red"


def a_row_leads_to_its_datum(walk):
    region = walk.area.spaces.active.region_3d
    before = region.view_distance
    number = next(n for n, row in enumerate(model().misfits) if row.source == "B5")
    with in_the_viewport(walk):
        model().active_misfit = number
    yield walk.redrawn(3)
    walk.shot("misfit_shown")
    assert region.view_distance < before
    assert handle.active(bpy.context.scene).hole == "B5"
    assert bpy.context.view_layer.objects.active == handle.item_of(bpy.context.scene)


def holes_left_out(walk):
    """The table of what the other holes say of each; its first row is the wrong one, and leads there."""
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.cross_validate_holes)
    yield lambda: idle() and len(model().left_out_holes) == len(_HOLES)
    assert model().left_out_holes[0].name == "B5"
    with in_the_viewport(walk):
        model().active_left_out_hole = 0
    yield walk.redrawn(3)
    walk.shot("holes_left_out")
    view = model().view
    assert view.show_boreholes and view.show_hole_names
    view.show_boreholes = view.show_hole_names = False


def a_datum_is_picked_and_dragged(walk):
    """A click picks the top of the clay in a hole; G, Z and the mouse drag it; the live model follows; Ctrl Z
    takes it back."""
    model().view.show_contacts = True
    model().live = True
    with in_the_viewport(walk):
        bpy.ops.realmodel.view(direction="FRONT")
    yield walk.redrawn(2)
    datum = _datum(data.INTERVAL, "B0", "Clay")
    walk.over_viewport()
    yield walk.redrawn()
    invoked(walk, bpy.ops.realmodel.datum_pick)
    x, y = walk.pixel_of(_offset(datum.place))
    walk.click(x + 3, y + 2)
    yield lambda: handle.active(bpy.context.scene).place[2] == datum.place[2]
    yield walk.redrawn(2)
    walk.shot("picked")
    before = volumes()
    item = handle.item_of(bpy.context.scene)
    x, y = walk.pixel_of(item.matrix_world.translation)
    walk.move(x, y)
    walk.key("G")
    yield walk.redrawn()
    walk.key("Z")
    yield walk.redrawn()
    for step in range(1, 6):
        walk.move(x, y - 6 * step)
        yield walk.redrawn()
    walk.click(x, y - 30)
    yield lambda: handle.active(bpy.context.scene).place[2] < datum.place[2] - 1.0
    yield lambda: not live.is_working() and volumes() != before
    yield walk.redrawn(2)
    walk.shot("dragged")
    moved = volumes()
    walk.over_viewport()
    walk.key("Z", ctrl=True)
    yield lambda: handle.active(bpy.context.scene).place == datum.place
    yield lambda: not live.is_working() and volumes() != moved
    yield walk.redrawn(2)
    walk.shot("undone")
    assert all(abs(volumes()[name] - value) < 1e-6 * value for name, value in before.items())


def switched_off(walk):
    """Without the datum the model is another one; it is gray."""
    before = volumes()
    with in_the_viewport(walk):
        bpy.ops.realmodel.datum_switch()
    yield lambda: not live.is_working() and volumes() != before
    yield walk.redrawn(2)
    walk.shot("switched_off")
    with in_the_viewport(walk):
        bpy.ops.realmodel.data_switch_on()
    yield lambda: not live.is_working()
    model().live = False


def holes_on_the_cut(walk):
    for row in model().results:
        row.object.hide_set(False)
    view = model().view
    view.show_contacts = view.show_dips = view.show_misfits = False
    view.show_boreholes, view.boreholes_by, view.show_hole_names, view.hole_width = True, "", True, 150.0
    with in_the_viewport(walk):
        bpy.ops.realmodel.datum_leave()
        bpy.ops.realmodel.section_plane(axis="Y")
    yield walk.redrawn(2)
    yield lambda: idle() and bool(view.cut)
    yield walk.redrawn(3)
    walk.shot("holes_on_the_cut")
    (item,) = [item for item in bpy.context.scene.objects if item.get("realmodel_view") == "boreholes"]
    north = {round(float((item.matrix_world @ v.co).y)) for v in item.data.vertices}
    assert max(north) - min(north) < 20, "they lie on the plane"
    for cls in walk.panels:
        if not cls.is_registered:
            bpy.utils.register_class(cls)
    for path in walk.field:
        path.unlink()


STEPS = (
    grades_along_holes,
    built_with_misfits,
    a_row_leads_to_its_datum,
    holes_left_out,
    a_datum_is_picked_and_dragged,
    switched_off,
    holes_on_the_cut,
)
