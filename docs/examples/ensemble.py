# SPDX-License-Identifier: GPL-3.0-or-later
"""An ensemble: many models that all honor the boreholes say how certain a volume and a place are.

It prints

    gravel: 26 to 40 million m3 in four models of five, half of the models above 30
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from realmodel.core import load_project
from realmodel.core.ensembles import ensemble

SAMPLE = Path(__file__).resolve().parents[2] / "blend_samples" / "uncertain_valley"
X = 950  # of the section

# Every place of the section is asked in every model.
y, z = np.linspace(700, 1700, 81), np.linspace(320, 420, 61)
places = np.column_stack([np.full(y.size * z.size, X), np.repeat(y, z.size), np.tile(z, y.size)])
project = load_project(SAMPLE / "project.toml")
project.rocks[0].edge_length = 90  # coarser than the example, for speed
result = ensemble(project, 40, seed=1, places=places)

gravel = result.block_names.index("Gravel")
p10, p50, p90 = result.percentiles()[:, gravel] / 1e6
print(f"gravel: {p10:.0f} to {p90:.0f} million m3 in four models of five, half of the models above {p50:.0f}")

figure, (section, volumes) = plt.subplots(1, 2, figsize=(10, 3.6), width_ratios=(3, 1), layout="constrained")
shares = result.probability[:, gravel].reshape(y.size, z.size).T
colors = section.pcolormesh(y, z, 100 * shares, cmap="YlOrBr", shading="gouraud", vmin=0, vmax=100)
figure.colorbar(colors, ax=section, label="probability of gravel (%)")
blocks = result.model.block_at(places).reshape(y.size, z.size).T
# black lines: the blocks of the interpolated model
section.contour(y, z, blocks, levels=[0.5, 1.5, 2.5], colors="black", linewidths=0.8)
for name, at, color in (
    ("till", 395, "k"),
    ("lake clay", 372, "k"),
    ("gravel", 352, "w"),
    ("bedrock", 325, "k"),
):
    section.annotate(name, (1320, at), color=color)
holes = pd.read_csv(SAMPLE / "picks.csv").merge(pd.read_csv(SAMPLE / "collars.csv"), on="hole")
for hole in holes[(abs(holes.x - X) < 100) & (holes.surface == "bedrock")].itertuples():
    section.plot([hole.y, hole.y], [hole.z, hole.z - hole.depth], "k-v", linewidth=2, markevery=[1])
    section.annotate(hole.hole, (hole.y, hole.z + 1), ha="center")
section.set(
    xlabel="y (m), boreholes down to the bedrock", ylim=(320, 420), xlim=(700, 1700), ylabel="elevation (m)"
)
volumes.hist(result.volumes[:, gravel] / 1e6, bins=10, color="#d9a441", edgecolor="black")
for name, value, side in (("P10", p10, "right"), ("P50", p50, "center"), ("P90", p90, "left")):
    volumes.axvline(value, color="black", linestyle="--")
    volumes.annotate(name, (value, 1.01), xycoords=("data", "axes fraction"), ha=side)
volumes.set(xlabel="gravel (million m3)", ylabel="models")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=120)
