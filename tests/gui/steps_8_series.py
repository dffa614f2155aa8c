# SPDX-License-Identifier: GPL-3.0-or-later
"""A recumbent fold made in the panel by somebody who never saw a project file: surfaces from tables, a series
with dips, its region and base, and the build; its field, and a dip that is dragged."""

from pathlib import Path

import bpy
from realmodel.bl.display import fields
from realmodel.bl.field import data, handle
from realmodel.bl.scene import live
from steps_1_panel import idle, model, volumes
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _show_alone
from steps_8_wells import empty_file

_FOLD = Path(__file__).resolve().parents[2] / "blend_samples" / "recumbent_fold"
_PANELS = {"REALMODEL_PT_surfaces", "REALMODEL_PT_series"}
_OF_VIEW = {"REALMODEL_PT_view", "REALMODEL_PT_view_fields"}


def series_grouped(walk):
    """What a field needs yet is asked for beside the series."""
    yield from empty_file(walk)
    walk.panels = _show_alone(_PANELS)
    with in_the_viewport(walk):
        for name in ("lower_bed", "middle_bed", "upper_bed", "unconformity", "ground"):
            bpy.ops.realmodel.surface_add(filepath=str(_FOLD / f"{name}.csv"))
    rock = model().rocks[0]
    rock.active_surface = 1
    yield walk.redrawn(2)
    walk.shot("series_none")
    with in_the_viewport(walk):
        bpy.ops.realmodel.series_add(kind="field")
        row = rock.series[0]
        row.youngest, row.oldest = "upper_bed", "lower_bed"
        bpy.ops.realmodel.boreholes_read(filepath=str(_FOLD / "dips.csv"), series=row.name)
    yield walk.redrawn(3)
    walk.shot("series_needs")


def fold_from_scratch(walk):
    rock = model().rocks[0]
    with in_the_viewport(walk):
        bpy.ops.realmodel.region_around()
    rock.base_elevation, rock.edge_length, rock.series[0].resolution = -600.0, 60.0, 40.0
    walk.over_viewport()
    invoked(walk, bpy.ops.realmodel.build)
    yield lambda: idle() and len(model().results) == 5
    yield walk.redrawn(3)
    walk.shot("series_built")
    assert all(volume > 0 for volume in volumes().values())


def field_on_the_cut(walk):
    """The cut shows the field in bands with a color bar; level sets stand in the half that was taken off."""
    for cls in walk.panels:
        if not cls.is_registered and cls.__name__ in _OF_VIEW:
            cls.bl_options = set(getattr(cls, "bl_options", ())) - {"DEFAULT_CLOSED"}
            bpy.utils.register_class(cls)
    view = model().view
    with in_the_viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    view.show_field_section = True
    yield lambda: bool(view.cut) and not fields.is_working(bpy.context.scene)
    yield lambda: len(_bodies("field section")) == 1
    yield walk.redrawn(3)
    walk.shot("field_on_the_cut")
    view.show_field_section, view.show_field_levels = False, True
    yield lambda: len(_bodies("field levels")) == 1
    yield walk.redrawn(3)
    walk.shot("field_levels")


def _bodies(kind):
    return [item for item in bpy.context.scene.objects if item.get("realmodel_view") == kind]


def a_dip_is_dragged(walk):
    """The blocks follow a dip that is moved: coarsely first, then at the resolution of the series."""
    view = model().view
    view.show_field_levels, view.use_section, view.show_dips, model().live = False, False, True, True
    for row in model().results:
        row.object.hide_set(True)
    (group,) = data.groups(bpy.context.scene, (data.SERIES_DIP,))
    with in_the_viewport(walk):
        handle.activate(bpy.context, group.datum(0))
    yield walk.redrawn(3)
    before = volumes()
    walk.shot("dips_of_series")
    item = handle.item_of(bpy.context.scene)
    x, y = walk.pixel_of(item.matrix_world.translation)
    walk.move(x, y)
    walk.key("G")
    yield walk.redrawn()
    walk.key("Z")
    yield walk.redrawn()
    walk.move(x, y - 25)
    yield walk.redrawn()
    walk.click(x, y - 25)
    yield lambda: volumes() != before
    yield lambda: not live.is_working() and not model().is_coarse
    yield walk.redrawn(2)
    walk.shot("dip_dragged")
    model().live = False


def series_are_left(walk):
    for cls in walk.panels:
        if not cls.is_registered:
            bpy.utils.register_class(cls)
    yield walk.redrawn()


STEPS = (series_grouped, fold_from_scratch, field_on_the_cut, a_dip_is_dragged, series_are_left)
