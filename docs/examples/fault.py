# SPDX-License-Identifier: GPL-3.0-or-later
"""A fault: its trace on the map and a dip are enough; the throw follows from the points on both sides.

It prints

    base of sandstone  throw 61.1 m on average (true: 60)
    top of sandstone   throw 61.1 m on average (true: 60)
    top of shale       throw 61.1 m on average (true: 60)
"""

import numpy as np
from picture import Picture
from realmodel.core import Fault, Library, Project, Property, Rock, Surface, build

random = np.random.default_rng(2)
DIP, THROW = 65, 60


def horizon(depth, count=60):
    """Points of a horizon that the fault displaces by 60 m, none of them near the fault."""
    x, y = random.uniform(0, [1000, 600], (count, 2)).T
    z = -depth - 0.05 * x + 12 * np.sin(x / 180) * np.cos(y / 150)
    distance = x - 450 + z / np.tan(np.radians(DIP))  # how far east of the fault
    z = np.where(distance > 0, z - THROW, z)
    return np.column_stack([x, y, z])[abs(distance) > 40]


COLORS = {"Basement": "#d77a8c", "Sandstone": "#e2b24c", "Shale": "#7c8088", "Gravel": "#c9a06c"}
library = Library([Property(n, name, color=color) for n, (name, color) in enumerate(COLORS.items(), 1)])
surfaces = [
    Surface("base of sandstone", points=horizon(260), block="Basement", property=1),
    Surface("top of sandstone", points=horizon(180), block="Sandstone", property=2),
    Surface("top of shale", points=horizon(90), block="Shale", property=3),
    Surface("ground", method="constant", options={"value": -20}, block="Gravel", property=4),
]
# The gravel is younger than the fault: "youngest" is the last surface that it displaces.
fault = Fault(
    "Main", trace=[[450, -100], [450, 700]], elevation=0, dip=DIP, dip_direction="E", youngest="top of shale"
)
region = [[0, 0], [1000, 0], [1000, 600], [0, 600]]
rock = Rock("basin", surfaces, region=region, edge_length=30, base_elevation=-450)
model = build(Project("Fault", [rock], library, faults=[fault]))

throws = model.report().table("faults")[["surfaces.surface", "surfaces.throw.mean"]]
for name, throw in throws.itertuples(index=False):
    print(f"{name:18} throw {throw:4.1f} m on average (true: {THROW})")

view = Picture(toward=(0.35, -1.0, 0.45))
view.blocks(model.clip("y", invert=False))  # the northern half; points up to 100 m in front of it
sheet = model.surfaces_to_pyvista()["Main"].clip_box((0, 1000, 200, 300, -450, -20), invert=False)
view.surface(sheet, "fault", opacity=0.5)
for surface in surfaces[:3]:
    near = (surface.points[:, 1] > 200) & (surface.points[:, 1] < 300)
    view.points(surface.points[near], "points, in the color of the block below", surface.block)
view.save()
