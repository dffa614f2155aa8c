# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles: a model of any size is built in tiles on all processors, and its tiles join exactly.

It prints

    4 tiles; 434 faces on borders, 0 of them without a twin
    Bedrock  16.04 million m3 in 1 part(s)
    Clay      2.18 million m3 in 1 part(s)
    Gravel    4.00 million m3 in 1 part(s)
"""

import tempfile
from pathlib import Path

import pandas as pd
from picture import Picture
from realmodel.core import load_project, open_tiles
from realmodel.distributed import build

SAMPLE = Path(__file__).resolve().parents[2] / "blend_samples" / "gravel_plain"


def main(folder):
    build(load_project(SAMPLE / "project.toml"), folder, tile_size=(600, 400), workers=2)
    tiles = open_tiles(folder)
    print(
        len(tiles.tiles),
        "tiles;",
        tiles.patches,
        "faces on borders,",
        tiles.unequal,
        "of them without a twin",
    )
    for block in tiles.blocks:
        print(f"{block.name:8} {block.volume / 1e6:5.2f} million m3 in {block.components} part(s)")
    view = Picture(exaggeration=4)
    holes = pd.read_csv(SAMPLE / "collars.csv")
    for tile in tiles.tiles:  # drawn apart
        apart = (60 * tile.column, 60 * tile.row, 0)
        view.blocks(tile.model(), offset=apart)
        x0, y0, x1, y1 = tile.box
        inside = holes[holes.Easting.between(x0, x1) & holes.Northing.between(y0, y1)]
        view.points(inside[["Easting", "Northing", "RL"]] + apart, "boreholes")
    view.save()


if __name__ == "__main__":  # the workers import this file
    with tempfile.TemporaryDirectory() as folder:
        main(folder)
