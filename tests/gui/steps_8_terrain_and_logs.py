# SPDX-License-Identifier: GPL-3.0-or-later
"""The row of the terrain in the panel, its buttons, and the model beneath it; and curves of logs beside the
tubes of holes, with their color bar."""

import shutil
import sys
from pathlib import Path

import bpy
import numpy as np
from realmodel.bl.field import boreholes
from steps_1_panel import idle, model, volumes
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _object, _select, _show_alone
from steps_8_wells import _sheet, empty_file

sys.path.append(str(Path(__file__).parents[1] / "core"))
from las_files import las_text

# In the row: pixels from the left border of the panel and its top.
_ACTIVE_MESH, _REMOVE = (
    (149, 110),
    (172, 110),
)
_DEPTHS = [0.0, 10.0, 20.0, 30.0, 40.0]
_GAMMA = [10.0, 20.0, 40.0, 30.0, 50.0]


def the_terrain_has_its_row(walk):
    """Its buttons in the panel make the active mesh the boundary above, and take it away."""
    walk.panels = _show_alone({"REALMODEL_PT_start", "REALMODEL_PT_surfaces"})
    yield from empty_file(walk)
    with in_the_viewport(walk):
        _select([_object(f"S{n}", *_sheet(20.0 * n)) for n in range(2)])
        bpy.ops.realmodel.from_selected()
        ground = _object(
            "ground", [(-10, -10, 30), (110, -10, 30), (110, 110, 60), (-10, 110, 60)], [[0, 1, 2], [0, 2, 3]]
        )
        _select([ground])
    yield walk.redrawn(3)
    walk.shot("no_terrain")
    region = walk.region("UI")
    walk.click(region.x + _ACTIVE_MESH[0], region.y + region.height - _ACTIVE_MESH[1])
    yield lambda: [row.is_terrain for row in model().rocks[0].surfaces] == [False, False, True]
    yield walk.redrawn(3)
    walk.shot("terrain_row")
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 2
    yield walk.redrawn(3)
    walk.shot("below_the_terrain")
    assert abs(volumes()["terrain block"] / volumes()["S1 block"] - 1.25) < 1e-3, volumes()
    walk.click(region.x + _REMOVE[0], region.y + region.height - _REMOVE[1])
    yield lambda: [row.is_terrain for row in model().rocks[0].surfaces] == [False, False]
    for cls in walk.panels:
        if not cls.is_registered:
            bpy.utils.register_class(cls)


def logs_beside_the_tubes(walk):
    """The curve of a log stands beside the tube of its hole, in the colors of its bar, and is taken away."""
    yield from empty_file(walk)
    folder = walk.folder / "logs"
    folder.mkdir(exist_ok=True)
    texts = {
        "collars.csv": "hole,x,y,z,eoh\nB-0,20,50,60,40\nB-1,80,51,60,40\n",
        "logs.csv": "hole,from,to,lith\nB-0,0,10,Sand\nB-0,10,40,Clay\nB-1,0,12,Sand\nB-1,12,40,Clay\n",
        **{f"{n}.las": las_text(f"b_{n}", _DEPTHS, {"GR.GAPI": _GAMMA}) for n in range(2)},
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    with in_the_viewport(walk):
        files = [{"name": name} for name in texts]
        bpy.ops.realmodel.boreholes_read(
            filepath=str(folder / "logs.csv"), directory=str(folder), files=files
        )
        bpy.ops.realmodel.view(direction="FRONT")
        bpy.context.space_data.overlay.show_floor = False
    walk.over_viewport()
    yield walk.redrawn(4)
    shown = walk.shot("log_curves")
    assert boreholes.key(bpy.context.scene).title == "GR (GAPI)"
    (item,) = (item for item in bpy.data.objects if item.get("realmodel_view") == "hole_curves")
    bars = sorted(item.data.polygons, key=lambda bar: bar.area)[-4:]  # two of each hole
    middles = [walk.pixel_of(item.matrix_world @ bar.center) for bar in bars]
    model().view.show_hole_curves = False
    yield walk.redrawn(3)
    hidden = walk.shot("no_log_curves")
    for x, y in middles:
        (red, green, blue), before = shown[y, x], hidden[y, x]
        assert min(red, green) > blue + 0.02 and np.abs(shown[y, x] - before).max() > 0.1, (x, y)
    region = walk.region("WINDOW")
    corner = shown[region.y : region.y + region.height // 3, region.x : region.x + 200]
    assert (corner.min(axis=2) > 0.9).sum() > 2000, "there is no color bar"
    assert ((corner[..., 0] > 0.9) & (corner[..., 2] < 0.4)).sum() > 20, "its end has another color"
    shutil.rmtree(folder)


STEPS = (the_terrain_has_its_row, logs_beside_the_tubes)
