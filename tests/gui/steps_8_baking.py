# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Looks: Esc between two pictures leaves the scene as it was; OK gives the beds a plain material, and
one step of undo takes it away."""

import shutil

import bpy
from steps_1_panel import idle
from steps_3_import import invoked
from steps_8_filling import boulder


def _state():
    kinds = ("objects", "meshes", "materials", "images", "collections")
    names = {kind: sorted(entry.name for entry in getattr(bpy.data, kind)) for kind in kinds}
    selected = sorted(obj.name for obj in bpy.context.selected_objects)
    hidden = sorted(obj.name for obj in bpy.data.objects if obj.hide_render)
    return names, selected, hidden, bpy.context.scene.render.engine


def _start(walk, **settings):
    """Opens the dialog, and presses Enter over none of its fields."""
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.bake_looks, directory=str(walk.folder / "baked"), **settings)
    yield walk.redrawn(4)
    region = walk.region("WINDOW")
    walk.move(region.x + region.width - 60, region.y + 30)
    yield walk.redrawn(2)
    walk.key("RET")
    yield lambda: not idle()


def escape_while_baking(walk):
    """The status bar names the map; the scene is as it was between pictures and after Esc."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    shutil.rmtree(walk.folder / "baked", ignore_errors=True)  # of a walk before
    boulder()
    bpy.ops.realmodel.fill_with_strata(beds=4)
    bpy.ops.ed.undo_push(message="filled")
    before = _state()
    yield from _start(walk, picture_size=2048)
    yield lambda: bpy.context.window_manager.realmodel.progress > 0.0
    assert "baking" in bpy.context.window_manager.realmodel.text
    assert _state() == before
    walk.key("ESC")
    yield idle
    assert _state() == before
    assert not (walk.folder / "baked").exists()


def bake_and_undo(walk):
    """Each bed gets one material with its pictures; Ctrl-Z once gives it the look again."""
    yield from _start(walk, picture_size=256, plain_materials=True)
    yield idle
    yield walk.redrawn(2)
    beds = [obj for obj in bpy.context.scene.objects if "realmodel_bed" in obj]
    assert [bed.material_slots[0].material.name for bed in beds] == [f"{bed.name} Baked" for bed in beds]
    assert len(list((walk.folder / "baked").glob("*.png"))) == 12
    walk.shot("baked")
    walk.key("Z", ctrl=True)
    yield lambda: not any(material.name.endswith("Baked") for material in bpy.data.materials)
    assert all("realmodel_look" in bed.material_slots[0].material for bed in bpy.context.selected_objects)
    yield walk.redrawn(2)


STEPS = (escape_while_baking, bake_and_undo)
