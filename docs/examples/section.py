# SPDX-License-Identifier: GPL-3.0-or-later
"""A section: a cut through boreholes, drawn to scale with the holes and a legend.

It prints

    Bedrock   190,482 m2
    Gravel     45,000 m2
    Lake clay  59,788 m2
    Till       71,129 m2
"""

import sys
from pathlib import Path

from realmodel.core import build, load_project

SAMPLE = Path(__file__).resolve().parents[2] / "blend_samples" / "uncertain_valley"

model = build(load_project(SAMPLE / "project.toml"))
fence = model.fence_through_holes(["V22", "V19", "V09", "V02", "V28", "V11"])  # model.fence: any line in plan
for row in fence.block_table().itertuples():
    print(f"{row.name:9} {row.area:7,.0f} m2")

# The ending is the format: .svg, .pdf, .dxf and .png are drawings, .csv, .vtu, .gpkg the polygons themselves.
if len(sys.argv) > 1:
    fence.save(sys.argv[1], exaggeration=8, hole_width=60)
