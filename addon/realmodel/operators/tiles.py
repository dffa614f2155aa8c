# SPDX-License-Identifier: GPL-3.0-or-later
"""A model in tiles in Blender: all of it coarsened, or chosen tiles as they are."""

import bpy
from bpy.props import EnumProperty, IntProperty
from bpy_extras.io_utils import ImportHelper

from ..bl.objects import tile_objects
from ..core import InputRefused, open_tiles
from .reporting import Reporting, chosen_path, file_filter


class REALMODEL_OT_tiles_read(Reporting, bpy.types.Operator, ImportHelper):
    """Read a model that was built in tiles: the whole model with coarse blocks, or some tiles unchanged. The
    model of this scene stays"""

    bl_label = "Import Tiles"

    filename_ext = ".toml"
    filter_glob: file_filter(".toml")
    what: EnumProperty(
        name="Read",
        description="Part of the model to import",
        items=[
            ("WHOLE", "All, Coarse", "One object for each block of the whole model, with few triangles"),
            ("TILES", "Tiles", "Some tiles as they are, with an object for each block of each"),
        ],
    )
    squares: IntProperty(
        name="Squares",
        description="Number of squares along the longer side of the model, with one vertex each",
        default=200,
        min=2,
        soft_max=2000,
    )
    column: IntProperty(name="Column", description="The westernmost of the tiles, from 0", min=0)
    row: IntProperty(name="Row", description="The southernmost of the tiles, from 0", min=0)
    columns: IntProperty(name="Columns", description="How many tiles side by side", default=1, min=1)
    rows: IntProperty(name="Rows", description="How many tiles behind each other", default=1, min=1)

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "what")
        if self.what == "WHOLE":
            layout.prop(self, "squares")
            return
        for first, count in (("column", "columns"), ("row", "rows")):
            column = layout.column(align=True)
            column.prop(self, first)
            column.prop(self, count)

    def act(self, context):
        tiled = open_tiles(chosen_path(self, "the tiles").parent)
        manager = context.window_manager
        manager.progress_begin(0.0, 1.0)
        try:
            if self.what == "WHOLE":
                side = max(tiled.x[-1] - tiled.x[0], tiled.y[-1] - tiled.y[0])
                size = float(side) / self.squares
                made = tile_objects.add_whole(context.scene, tiled, size, manager.progress_update)
            else:
                tiles = self._chosen(tiled)
                made = tile_objects.add_tiles(context.scene, tiled, tiles, manager.progress_update)
        finally:
            manager.progress_end()
        count = len(made)
        self.report({"INFO"}, f"Read {count} block{'' if count == 1 else 's'} of {tiled.name}")

    def _chosen(self, tiled):
        columns = range(self.column, self.column + self.columns)
        rows = range(self.row, self.row + self.rows)
        chosen = [tile for tile in tiled.tiles if tile.column in columns and tile.row in rows]
        if not chosen:
            raise InputRefused(
                f"no tile is there; {tiled.name} has {len(tiled.x) - 1} columns and {len(tiled.y) - 1} rows",
                advice="they are counted from 0",
            )
        return chosen
