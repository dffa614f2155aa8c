# SPDX-License-Identifier: GPL-3.0-or-later
"""An intrusion: a closed mesh of any shape replaces the rock inside, and a younger surface erodes both.

It prints

    Slate     173.44 million m3, 1 part(s)
    Limestone  73.41 million m3, 2 part(s)
    Marl       81.52 million m3, 1 part(s)
    Soil        7.44 million m3, 1 part(s)
    Granite    62.44 million m3, 1 part(s)
"""

import numpy as np
import pyvista as pv
from picture import Picture
from realmodel.core import Body, Library, Project, Property, Rock, Surface, build

random = np.random.default_rng(6)
COLORS = {
    "Slate": "#7c8088",
    "Limestone": "#8fb7d6",
    "Marl": "#b9cda3",
    "Granite": "#d77a8c",
    "Soil": "#8a6a4a",
}
library = Library([Property(n, name, color=color) for n, (name, color) in enumerate(COLORS.items(), 1)])


def contacts(height, count=50):
    x, y = random.uniform(0, [1000, 700], (count, 2)).T
    return np.column_stack([x, y, height(x, y)])


def ground(x, y):
    return -65 + 0.02 * x - 50 * np.cos(np.hypot(x - 560, y - 330) / 130)


surfaces = [
    Surface("top of slate", points=contacts(lambda x, y: -330 + 0.1 * x), block="Slate", property=1),
    Surface("top of limestone", points=contacts(lambda x, y: -210 + 0.1 * x), block="Limestone", property=2),
    Surface("top of marl", points=contacts(lambda x, y: 0 * x - 30), block="Marl", property=3),
    Surface("ground", points=contacts(ground, 150), block="Soil", property=5),
]

# A stock with a bulging roof. Sculpt it in Blender, or take any closed mesh: an .obj, an .stl.
stock = pv.Sphere(radius=1.0, theta_resolution=60, phi_resolution=60)
bulge = 1 + 0.18 * np.sin(3 * stock.points[:, 0] * np.pi) * np.cos(2 * stock.points[:, 1] * np.pi)
vertices = stock.points * bulge[:, None] * [260, 210, 310] + [520, 350, -430]

# "after" is the youngest surface that the granite has intruded. The ground is younger, and erodes both.
granite = Body("Granite", vertices, stock.regular_faces, after="top of marl", property=4)
region = [[0, 0], [1000, 0], [1000, 700], [0, 700]]
rock = Rock("site", surfaces, region=region, edge_length=30, base_elevation=-600)
model = build(Project("Intrusion", [rock], library, bodies=[granite]))

for block in model.blocks:
    print(f"{block.name:9} {block.volume / 1e6:6.2f} million m3, {block.components} part(s)")

view = Picture()
view.blocks(model.clip("y", invert=False))  # the northern half; points up to 100 m in front of it
for surface in surfaces:
    y = surface.points[:, 1]
    near = (y > 250) & ((y < 350) | (surface.name == "ground"))
    view.points(surface.points[near], "points, in the color of the block below", surface.block)
view.save()
