# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of a model (realmodel.core.TiledModel) as objects of a scene, to look at: they are no part of the
scene's own model.

    <model> tiles                 collection, realmodel = "tiles"
      <block>                     mesh object, realmodel = "tile": a block over all tiles, coarse
    <model> tiles
      <tile>                      collection, such as 0002-0001
        <block> <tile>            mesh object, realmodel = "tile": the part of a block in this tile
"""

import bpy
import numpy as np

from ...core import InputRefused
from ...core.base.units import length_text
from ...core.display import polygon_mesh
from . import materials, meshes, model_tree
from .origin import KEY as ORIGIN_KEY
from .origin import choose_origin, far_from

TILES, TILE = "tiles", "tile"


def add_whole(scene, tiled, size, step):
    """Adds one coarse object for each block of a model in tiles; one tile is in memory at a time. size: of
    the squares that have one vertex each, model units. step: called with the share that is done. Returns the
    objects."""
    parts = [[] for _ in tiled.blocks]
    origin = _origin(scene, tiled)
    for number, tile in enumerate(tiled.tiles):
        step(number / len(tiled.tiles))
        for coarse_parts, shape in zip(parts, polygon_mesh.of_blocks(tile.model(), origin), strict=True):
            coarse = None if shape is None else polygon_mesh.coarsened(shape, size)
            if coarse is not None:
                coarse_parts.append(coarse)
    shapes = [polygon_mesh.joined(coarse_parts) if coarse_parts else None for coarse_parts in parts]
    return _put(scene, tiled, origin, [("", shapes)])


def add_tiles(scene, tiled, tiles, step):
    """The blocks of some tiles as they are, a collection for each tile. Otherwise as add_whole."""
    origin = _origin(scene, tiled)
    shapes_of_tiles = []
    for number, tile in enumerate(tiles):
        step(number / len(tiles))
        shapes_of_tiles.append((tile.name, polygon_mesh.of_blocks(tile.model(), origin)))
    return _put(scene, tiled, origin, shapes_of_tiles)


def _origin(scene, tiled):
    """The origin of the scene, or one for the model where the scene has none. Raises InputRefused."""
    corners = np.concatenate([tile.extent for tile in tiled.tiles if tile.vertices] or [np.zeros((2, 3))])
    if ORIGIN_KEY not in scene:
        return choose_origin(corners)
    origin = np.array(scene[ORIGIN_KEY], np.float64)
    away = far_from(origin, corners)
    if away is not None:
        raise InputRefused(
            f"the tiles lie {length_text(away, tiled.project.units)} from the zero of the scene, where "
            "Blender's numbers are coarse",
            advice="open them in a new scene",
        )
    return origin


def _put(scene, tiled, origin, shapes_of_tiles):
    """Adds the objects. shapes_of_tiles: (name of a tile or "", a PolygonMesh or None for each block)."""
    created, palette = [], {}
    try:
        top = bpy.data.collections.new(f"{tiled.name} tiles")
        created.append(top)
        top[model_tree.TAG] = TILES
        objects = []
        for tile, shapes in shapes_of_tiles:
            collection = top
            if tile:
                collection = bpy.data.collections.new(tile)
                created.append(collection)
                top.children.link(collection)
            for block, shape in zip(tiled.blocks, shapes, strict=True):
                if shape is None:
                    continue
                name = f"{block.name} {tile}".strip()
                mesh = meshes.new_mesh(name, shape)
                created.append(mesh)
                mesh.materials.append(_material(palette, tiled.project.library, block.property, created))
                obj = bpy.data.objects.new(name, mesh)
                created.append(obj)
                obj[model_tree.TAG] = TILE
                obj[model_tree.ROCK] = tiled.project.rocks[block.rock].name
                obj[model_tree.BLOCK] = block.name
                obj[model_tree.PROPERTY] = block.property
                collection.objects.link(obj)
                objects.append(obj)
    except BaseException:
        bpy.data.batch_remove(created)
        raise
    scene.collection.children.link(top)
    if ORIGIN_KEY not in scene:
        scene[ORIGIN_KEY] = [float(value) for value in origin]
    return objects


def _material(palette, library, property_id, created):
    if property_id not in palette:
        name, color = materials.name_and_color(library, property_id)
        palette[property_id] = materials.new_material(name, property_id, color)
        created.append(palette[property_id])
    return palette[property_id]
