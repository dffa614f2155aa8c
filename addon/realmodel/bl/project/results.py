# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of blocks that a build fills in."""

import csv
import io

from . import settings

_SLIVER = 1e-3  # of a block's volume
CSV_HEADINGS = ("block", "rock", "property", "volume", "share", "components", "cells")


def volume(row):
    """The volume of a row in full, model units cubed."""
    return float(row.volume_exact) if row.volume_exact else float(row.volume)


def is_missing(row):
    """Whether the object of a block was deleted: while a row points to it, it lives on outside of scenes."""
    return row.cells > 0 and (row.object is None or not row.object.users_scene)


def slivers(model):
    """For each block of a model the number of its connected parts that have less than 0.1 % of its volume."""
    if all(block.components < 2 for block in model.blocks):
        return [0] * len(model.blocks)
    blocks = zip(model.blocks, model.component_volumes, strict=True)
    return [int((volumes < _SLIVER * block.volume).sum()) for block, volumes in blocks]


def row_chosen(group, context):
    """Selects only the block of the chosen row."""
    if settings.is_filling() or not 0 <= group.active_result < len(group.results):
        return
    chosen = group.results[group.active_result].object
    layer = context.view_layer
    if chosen is None or chosen.name not in layer.objects:
        return
    if context.mode != "OBJECT":
        return  # an edit under way is not to be left for it
    for obj in layer.objects:
        obj.select_set(obj == chosen)
    layer.objects.active = chosen


def as_text(scene, delimiter=","):
    """The table as text, numbers in full."""
    file = io.StringIO()
    writer = csv.writer(file, delimiter=delimiter, lineterminator="\n")
    writer.writerow(CSV_HEADINGS)
    names = {row.id: row.name for row in scene.realmodel.library}
    rows = scene.realmodel.results
    total = sum(volume(row) for row in rows)
    for row in rows:
        share = volume(row) / total if total else 0.0
        name = names.get(row.property_id, row.property_id or "")
        writer.writerow([row.name, row.rock, name, repr(volume(row)), repr(share), row.components, row.cells])
    return file.getvalue()
