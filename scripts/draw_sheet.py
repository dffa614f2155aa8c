#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of docs/guide/report_section.md: a sheet of a sample with sections through boreholes.

PYTHONPATH=addon python scripts/draw_sheet.py [FOLDER]      (default: docs/images)
"""

import sys
from pathlib import Path

from draw_guide import shrink
from realmodel.core import build, load_project
from realmodel.core.drawing.png import rasterize, write_pixels
from realmodel.core.results.sheets import draw_sheets

ROOT = Path(__file__).resolve().parents[1]
DOTS_PER_INCH = 100


def draw(folder: Path) -> None:
    model = build(load_project(ROOT / "blend_samples" / "gravel_plain" / "project.toml"))
    sections = [
        model.fence_through_holes(["GP02", "GP20", "GP09"]),
        model.fence_through_holes(["GP01", "GP07", "GP03"]),
    ]
    (sheet,) = draw_sheets(model, sections, "A4-portrait", exaggeration=3.0, hole_width=40.0)
    with (folder / "sheet.png").open("wb") as file:
        write_pixels(rasterize(sheet, DOTS_PER_INCH / 72), file, DOTS_PER_INCH)
    shrink(folder / "sheet.png", folder / "sheet.png")


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images")
