# SPDX-License-Identifier: GPL-3.0-or-later
"""The ensemble of a model in the scene: a table of volumes, and a section whose colors show how certain the
blocks are, or one realization. The section keeps the block of each of its cells in each realization."""

import json

import bpy
import numpy as np

from ...core.display.polygon_mesh import PolygonMesh
from ...core.drawing import color_scale
from ...core.drawing.overlay import ColorKey
from ...core.ensembles import PERCENTILES, Probabilities
from ...core.project.looks import hex_color
from ..objects import meshes, model_tree, stored_arrays
from ..objects.origin import offsets_from
from ..objects.stored_arrays import StoredArrays
from ..project import library_rows, project_settings
from . import bodies, colors, sections

BLOCKS = "realmodel_ensemble"  # on the object: StoredArrays, the blocks (R, N) int16
ENTROPY, PROBABILITY, REALIZATION = "ENTROPY", "PROBABILITY", "REALIZATION"
COLORS = (  # items of an enum
    (ENTROPY, "Entropy", "Uncertainty of the block, in bits. 0: all realizations have the same block"),
    (PROBABILITY, "Probability", "Share of the realizations with this block"),
    (REALIZATION, "Realization", "The blocks of one realization"),
)
_STEPS = 15  # of the color scales: each is a material, which all ways of shading show
_OUTSIDE = ("Outside", "#ffffff")


def put(scene, found, samples, blocks, seed):
    """Shows an ensemble in place of an earlier one. found: core.Ensemble. samples: SectionSamples. blocks:
    (R, N) int16, the block of each cell in each realization, -1 for none."""
    remove(scene)
    rows = list(_rows(found))
    cells = np.flatnonzero((blocks >= 0).any(axis=0))
    places = offsets_from(project_settings.model_origin(scene), samples.corners[cells].reshape(-1, 3))
    ends = np.arange(0, 4 * len(cells) + 1, 4, dtype=np.int32)
    shape = PolygonMesh(places, ends, np.arange(4 * len(cells), dtype=np.int32))
    obj = bpy.data.objects.new("Ensemble", meshes.new_mesh("Ensemble", shape))
    stored_arrays.store(obj, BLOCKS, {"blocks": blocks[:, cells]})
    obj.show_in_front = True  # it runs through the blocks
    sections.stand(scene, obj, samples.section.plane)
    group = scene.realmodel.ensemble
    group.object = obj
    group.table = json.dumps(
        {
            "stamp": scene.realmodel.built_stamp,
            "count": len(blocks),
            "seed": seed,
            "most_entropy": float(_entropy(blocks, len(rows)).max(initial=0.0)),
            "blocks": rows,
        }
    )
    if group.block not in [row["name"] for row in rows]:
        group.block = max(rows, key=lambda row: (row["deviation"] or 0.0) / (row["mean"] or 1.0))["name"]
    group.realization = min(group.realization, len(blocks))
    recolor(scene)


def _rows(ensemble):
    percentiles, deviations = ensemble.percentiles(), ensemble.volume_deviations()
    for number, block in enumerate(ensemble.model.blocks):
        drawn = ensemble.volumes[:, number]
        yield {
            "name": block.name,
            "rock": ensemble.model.project.rocks[block.rock].name,
            "property": int(block.property),
            "interpolated": block.volume,
            "mean": float(drawn.mean()),
            "deviation": None if np.isnan(deviations[number]) else float(deviations[number]),
            "percentiles": percentiles[:, number].tolist(),
        }


def table(scene):
    """{"count", "seed", "stamp" of the model, "most_entropy" of a cell, "blocks": of each its name, rock,
    property, interpolated volume, mean, deviation and percentiles}; None where there is no ensemble."""
    text = scene.realmodel.ensemble.table
    return json.loads(text) if text else None


def is_outdated(scene):
    """Whether another model was built since."""
    summary = table(scene)
    return summary is not None and summary["stamp"] != scene.realmodel.built_stamp


def item_of(scene):
    """The object of the section, or None."""
    obj = scene.realmodel.ensemble.object
    is_usable = obj is not None and BLOCKS in obj and obj.type == "MESH" and scene in obj.users_scene
    return obj if is_usable else None


def remove(scene):
    """Removes the ensemble from a scene."""
    group, obj = scene.realmodel.ensemble, item_of(scene)
    group.object, group.table = None, ""
    if obj is not None:
        model_tree.remove_objects([obj])
        bodies.remove_collection_if_empty(scene)
        colors.remove_unused()


def recolor(scene):
    """Sets the colors of the section. Raises InputRefused where the .blend is damaged."""
    obj = item_of(scene)
    if obj is None or obj.mode != "OBJECT" or obj.data.library is not None:
        return
    blocks = StoredArrays(obj, BLOCKS)["blocks"]
    if blocks.shape[1] != len(obj.data.polygons):
        return  # its mesh was edited
    if scene.realmodel.ensemble.color_by == REALIZATION:
        materials, slots = _of_realization(scene, blocks)
    else:
        materials, slots = _of_scale(scene, blocks)
    mesh = obj.data
    mesh.materials.clear()
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(slots, np.int32))
    mesh.update()
    colors.remove_unused()


def _of_realization(scene, blocks):
    rows = table(scene)["blocks"]
    number = min(scene.realmodel.ensemble.realization, len(blocks)) - 1
    ids = sorted({row["property"] for row in rows})
    slots = np.append([ids.index(row["property"]) for row in rows], len(ids))[blocks[number]]
    materials = [library_rows.material_of(scene, property_id) for property_id in ids]
    return [*materials, colors.plain_material(*_OUTSIDE)], slots


def _of_scale(scene, blocks):
    values = _values(scene, blocks)
    codes = [hex_color(color) for color in _colors(_STEPS)[:, :3].tolist()]
    materials = [colors.plain_material(f"Scale {code}", code) for code in codes]
    return materials, np.rint(values / _most(scene) * (_STEPS - 1))


def _values(scene, blocks):
    """The value of each cell that its color shows."""
    names = [row["name"] for row in table(scene)["blocks"]]
    if scene.realmodel.ensemble.color_by == PROBABILITY:
        wanted = scene.realmodel.ensemble.block
        return (blocks == (names.index(wanted) if wanted in names else len(names))).mean(axis=0)
    return _entropy(blocks, len(names))


def _entropy(blocks, count):
    shares = np.stack([(blocks == number).mean(axis=0) for number in range(count)], axis=1)
    return Probabilities([], shares).entropy()


def _most(scene):
    """The value at the upper end of the scale; at the lower one it is 0."""
    is_entropy = scene.realmodel.ensemble.color_by == ENTROPY
    return max(1.0, table(scene)["most_entropy"]) if is_entropy else 1.0


def key(scene):
    """The core's ColorKey of the section, or None."""
    group, obj = scene.realmodel.ensemble, item_of(scene)
    if obj is None or group.color_by == REALIZATION or obj.hide_viewport:
        return None
    title = f"Probability of {group.block}" if group.color_by == PROBABILITY else "Entropy (bits)"
    return ColorKey(title, limits=(0.0, _most(scene)), colors=_colors(_STEPS))


def _colors(count):
    return color_scale.colors(np.linspace(0.0, 1.0, count), (0.0, 1.0))


def headings():
    return [f"P{percent}" for percent in PERCENTILES]
