# SPDX-License-Identifier: GPL-3.0-or-later
"""Wells: two tables of boreholes become a model, whose order of units follows from the logs.

It prints

    oldest first: Sandstone, Clay, Gravel
    Sandstone 31.83 million m3
    Clay       2.58 million m3
    Gravel     4.12 million m3
    100% of the logged intervals are in their block
"""

import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from picture import Picture
from realmodel.core import build, propose_project

# The tables as a database has them: where each hole begins, and what it meets from a depth to a depth.
random = np.random.default_rng(4)
columns, rows = np.meshgrid([0, 1, 2, 3], [0, 1, 2])
x, y = 100 + 260 * columns.ravel(), 60 + 230 * rows.ravel()
x, y = x + random.uniform(-50, 50, 12), y + random.uniform(-40, 40, 12)
ground = 110 - 0.01 * x + 3 * np.sin(y / 90)
gravel = 6 + 2 * np.sin(x / 130)
clay = gravel + np.clip(24 - np.hypot(x - 450, y - 250) / 12, 0, None)  # a lens
names = np.array([f"B{number}" for number in range(1, 13)])
collars = pd.DataFrame({"hole": names, "x": x, "y": y, "z": ground})
logs = []
for name, base_of_gravel, base_of_clay in zip(names, gravel, clay, strict=True):
    logs.append((name, 0, base_of_gravel, "Gravel"))
    if base_of_clay > base_of_gravel:
        logs.append((name, base_of_gravel, base_of_clay, "Clay"))
    logs.append((name, base_of_clay, 45, "Sandstone"))

with tempfile.TemporaryDirectory() as folder:
    files = {"collars": Path(folder, "collars.csv"), "intervals": Path(folder, "intervals.csv")}
    collars.to_csv(files["collars"])
    pd.DataFrame(logs, columns=["hole", "from", "to", "block"]).to_csv(files["intervals"])
    project = propose_project(boreholes=files)
    model = build(project)

print("oldest first:", ", ".join(project.proposal.order))
for block in model.blocks:
    print(f"{block.name:9} {block.volume / 1e6:5.2f} million m3")
print(f"{model.observed().share:.0%} of the logged intervals are in their block")

view = Picture(exaggeration=6, toward=(0.6, -1.0, 0.75))
for line in [*names.reshape(3, 4), *names.reshape(3, 4).T]:
    view.section(model.fence_through_holes(line, extend=0))
for hole, top, bottom, block in logs:
    at = collars.set_index("hole").loc[hole]
    view.hole([at.x, at.y, at.z - top], [at.x, at.y, at.z - bottom], block)
for hole in collars.itertuples():
    view.label([hole.x, hole.y, hole.z + 4], hole.hole)
view.save()
