# SPDX-License-Identifier: GPL-3.0-or-later
"""Points to a solid: each surface is interpolated from its points, and each block is a closed solid.

It prints

    Clay      27.41 million m3
    Sand       9.02 million m3
    Gravel     8.82 million m3
    closed, without gaps or overlaps: True
"""

import numpy as np
from picture import Picture
from realmodel.core import Library, Project, Property, Rock, Surface, build

random = np.random.default_rng(1)


def measured(height, count):
    """Some points of a surface: in your project they come from a survey, or from wells."""
    x, y = random.uniform(0, [1000, 600], (count, 2)).T
    return np.column_stack([x, y, height(x, y)])


clay = measured(lambda x, y: 40 + 12 * np.sin(x / 150) + 0.02 * y, 60)
sand = measured(lambda x, y: 65 + 6 * np.cos(y / 120), 60)
ground = measured(lambda x, y: 85 - 45 * np.exp(-(((x - 600 + 0.3 * y) / 120) ** 2)), 150)

# Surfaces are listed from the oldest to the youngest. Each names the block below it.
# The ground is younger than the sand: where it lies lower, it cuts the sand and the clay.
surfaces = [
    Surface("top of clay", points=clay, block="Clay", property=1),
    Surface("top of sand", points=sand, block="Sand", property=2),
    Surface("ground", points=ground, block="Gravel", property=3),
]
colors = {"Clay": "#8fa08a", "Sand": "#efd36a", "Gravel": "#c07a4a"}
library = Library(
    [Property(number, name, color=color) for number, (name, color) in enumerate(colors.items(), 1)]
)
outline = [[0, 0], [1000, 0], [1000, 600], [0, 600]]
rock = Rock("valley", surfaces, region=outline, edge_length=15, base_elevation=0)
model = build(Project("Points", [rock], library))

for block in model.blocks:
    print(f"{block.name:8} {block.volume / 1e6:6.2f} million m3")
print("closed, without gaps or overlaps:", model.validate().passed)

view = Picture(exaggeration=4)
view.blocks(model.clip("y", invert=False))  # the northern half; points up to 100 m in front of it
for surface in surfaces:
    y = surface.points[:, 1]
    near = (y > 200) & ((y < 300) | (surface.name == "ground"))
    view.points(surface.points[near], "points, in the color of the block below", surface.block)
view.save()
