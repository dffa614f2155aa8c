# SPDX-License-Identifier: GPL-3.0-or-later
"""A new user's own data: a table with a column of horizons, looked at, split, shown, built in colors; and the
question before another model takes its place."""

import bpy
import numpy as np
from driver import hue_differs
from steps_1_panel import idle, model, open_the_tab

EAST, NORTH = 3_430_000.0, 5_390_000.0


def begin_again(walk):
    """A new file with the default cube; the panel offers how to begin."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn()
    yield from open_the_tab(walk)
    walk.shot("start")


def invoked(walk, operator, **arguments):
    with bpy.context.temp_override(window=walk.window, area=walk.area, region=walk.region("WINDOW")):
        return operator("INVOKE_DEFAULT", **arguments)


def import_objects(walk):
    """The surfaces of a DXF are listed with ticks, and all are imported, the oldest first."""
    path = walk.folder / "stack.dxf"
    codes = ["0", "SECTION", "2", "ENTITIES"]
    for k in range(3):
        codes += ["0", "3DFACE", "8", f"TOP_{k}"]
        for corner, (x, y) in enumerate([(0, 0), (100, 0), (100, 100), (0, 100)]):
            codes += [f"1{corner}", str(x), f"2{corner}", str(y), f"3{corner}", str(10 * k)]
    path.write_text("\n".join([*codes, "0", "ENDSEC", "0", "EOF"]) + "\n")
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.surface_add, filepath=str(path))
    yield walk.redrawn(3)
    walk.shot("objects_dialog")
    walk.key("RET")
    yield lambda: len(model().rocks) == 1 and len(model().rocks[0].surfaces) == 3
    yield walk.redrawn(2)
    assert [s.name for s in model().rocks[0].surfaces] == ["TOP_0", "TOP_1", "TOP_2"]
    path.unlink()


def import_horizons(walk):
    """A file of semicolons and decimal commas is dropped: its columns are shown, it is split by horizon."""
    path = walk.folder / "boundaries.csv"
    lines = ["Horizon;Easting;Northing;Elevation"]
    for name, height, bend in (("Topsoil", 220.0, 8.0), ("Sandstone", 200.0, 4.0), ("Marl", 150.0, 2.0)):
        for x, y in np.random.default_rng(4).random((150, 2)) * 600.0:
            z = height + bend * np.sin(x / 90.0) + 0.02 * y
            numbers = f"{EAST + x:.2f};{NORTH + y:.2f};{z:.2f}"
            lines.append(f"{name};{numbers}".replace(".", ","))
    path.write_text("\n".join(lines) + "\n")
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.surface_add, filepath=str(path))
    yield walk.redrawn(3)
    walk.shot("import_dialog")
    walk.key("RET")
    yield lambda: len(model().rocks) == 1 and len(model().rocks[0].surfaces) == 3
    yield walk.redrawn(2)
    assert [s.name for s in model().rocks[0].surfaces] == ["Marl", "Sandstone", "Topsoil"]
    assert abs(model().origin[0] - EAST) < 1000.0
    picture = walk.shot("points")
    item = bpy.data.objects["Topsoil points"]
    inside = [walk.pixel_of(item.matrix_world @ v.co) for v in item.data.vertices]
    region = walk.region("WINDOW")
    inside = [(x - region.x, y - region.y) for x, y in inside]
    assert all(0 < x < region.width and 0 < y < region.height for x, y in inside), "not framed"
    before = walk.color_at(picture, item.matrix_world @ item.data.vertices[0].co, 1)
    assert before.max() < 0.2, "the point is not drawn"


def region_and_build(walk):
    """Region Around Points, Build: every block has its own color."""
    yield from walk.command("region around points")
    yield lambda: model().rocks[0].region is not None
    yield from walk.command("build")
    yield lambda: len(model().results) == 2 and idle()
    yield walk.redrawn(2)
    picture = walk.shot("own_data")
    for row in model().results:
        wanted = next(e.color for e in model().library if e.id == row.property_id)
        seen = walk.color_at(picture, walk.visible_place(row.object.name))
        assert hue_differs(seen, wanted) < 0.1, (row.name, tuple(wanted), seen)
    (walk.folder / "boundaries.csv").unlink()


def replacing_asks(walk):
    """Open Example asks first; Esc leaves the model, Enter opens and builds the example."""
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.open_sample, sample="two_layers")
    yield walk.redrawn(3)
    walk.shot("question")
    walk.key("ESC")
    yield walk.redrawn(2)
    assert len(model().results) == 2 and model().name == "Model"
    invoked(walk, bpy.ops.realmodel.open_sample, sample="two_layers")
    yield walk.redrawn(3)
    walk.key("RET")
    yield lambda: model().name == "Two layers" and len(model().results) > 0 and idle()
    yield walk.redrawn(2)
    walk.visible_place(model().results[0].object.name)
    walk.shot("replaced")


STEPS = (begin_again, import_objects, begin_again, import_horizons, region_and_build, replacing_asks)
