# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that an earlier version wrote, as this one has them: version 6 had arrays as text, either JSON or
an .npz in base64."""

import base64
import inspect
import io
import json
import zipfile
import zlib

import bpy
import numpy as np

from ...core import RealModelError
from ..display.ensembles import BLOCKS
from ..objects.stored_arrays import ArraysProperty, store
from ..project import borehole_picks, method_settings, settings

_BROKEN = (AttributeError, KeyError, TypeError, ValueError, OSError, EOFError, MemoryError)
_BROKEN += (zipfile.BadZipFile, zlib.error, RealModelError)
_FIRST = 6  # the first version that was released


def migrate_all():
    """Brings the settings of all scenes to this version, where an earlier one wrote them."""
    for scene in bpy.data.scenes:
        group = scene.realmodel
        if group.exists and group.version == _FIRST:
            for row in (group.view, *_rows(group)):
                _take_texts(row)
            obj = group.ensemble.object
            if obj is not None and isinstance(obj.get(BLOCKS), str):
                store(obj, BLOCKS, _arrays_of_npz(obj[BLOCKS]))
            group.version = settings.VERSION


def _rows(group):
    """All rows of settings, those within rows too."""
    for prop in group.bl_rna.properties:
        if prop.type == "COLLECTION":
            for row in getattr(group, prop.identifier):
                yield row
                yield from _rows(row)


def _take_texts(row):
    """Stores as arrays what a row has as text. What cannot be read stays, and is refused where it is used."""
    for key in list(row.keys()):
        text = row[key]
        if isinstance(inspect.getattr_static(row, key, None), ArraysProperty) and isinstance(text, str):
            del row[key]
            try:
                _take(row, key, text)
            except _BROKEN:
                row[key] = text


def _take(row, key, text):
    if not text:
        return
    if text[0] not in "[{":
        arrays = _arrays_of_npz(text)
        if key == "interval_values":
            names = [name for name in arrays if name.startswith("column:")]
            columns = {f"column{number}": arrays.pop(name) for number, name in enumerate(names)}
            arrays |= columns | {"columns": np.array([name.partition(":")[2] for name in names], str)}
        if key == "stored" and "contacts" in arrays:  # they follow from observations
            arrays = _without_contacts(row, **arrays)
        setattr(row, key, arrays)
    elif key == "hole_picks":
        borehole_picks.store(row, json.loads(text))
    elif key == "hole_ends":
        borehole_picks.keep_ends(row, json.loads(text))
    elif key == "other_options":
        method_settings.set_options(row, None, json.loads(text))
    else:
        values = json.loads(text)
        setattr(row, key, values if key == "exact" else {"values": np.array(values)})


def _without_contacts(row, points, contacts):
    """What a surface stores of points of which the last are contacts."""
    own = points[: len(points) - len(contacts)]
    if not len(own):
        row.source = "NONE"
    return {"points": own} if len(own) else {}


def _arrays_of_npz(text):
    with np.load(io.BytesIO(base64.b64decode(text, validate=True)), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}
