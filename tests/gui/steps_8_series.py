# SPDX-License-Identifier: GPL-3.0-or-later
"""A recumbent fold made in the panel by somebody who never saw a project file: surfaces from tables, a series
with dips, its region and base, and the build."""

from pathlib import Path

import bpy
from steps_1_panel import idle, model, volumes
from steps_2_view import in_the_viewport
from steps_3_import import invoked
from steps_5_structures import _show_alone
from steps_8_wells import empty_file

_FOLD = Path(__file__).resolve().parents[2] / "blend_samples" / "recumbent_fold"
_PANELS = {"REALMODEL_PT_surfaces", "REALMODEL_PT_series"}


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


def series_are_left(walk):
    for cls in walk.panels:
        if not cls.is_registered:
            bpy.utils.register_class(cls)
    yield walk.redrawn()


STEPS = (series_grouped, fold_from_scratch, series_are_left)
