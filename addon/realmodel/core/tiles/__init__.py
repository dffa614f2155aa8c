# SPDX-License-Identifier: GPL-3.0-or-later
"""A model in tiles of the plan (docs/dev/tiles.md).

Input: `RockInput`s of the whole, or a folder with tiles. Output: the cells of one tile, with the same
bytes on both sides of a border, or the whole of which only the tiles asked for are read.

grid          the lines that divide the plan
windows       which triangles each tile needs
tile_model    one tile that is cut at its border; any tile in a file
faulted_tile  one tile of a model with faults, bodies or fields, of its window
owned_cells   which cells of a window belong to its tile
settling      where the vertices on the border of a tile are, in all tiles alike
borders       what two tiles have on the line between them: vertices exchanged, blocks matched
catalog       tiles.toml, the table of the whole
tiled_model   the whole, opened from its folder
"""

from .tiled_model import Tile, TiledModel, open_tiles

__all__ = ["Tile", "TiledModel", "open_tiles"]
