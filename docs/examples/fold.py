# SPDX-License-Identifier: GPL-3.0-or-later
"""A fold: contacts and dips define one scalar field in space, whose level sets are the beds.

Beds in a field may be overturned: a borehole meets the same bed several times.

It prints

    95 contacts, 40 dips
    100% of the rock is in the right bed
"""

import numpy as np
from picture import Picture
from realmodel.core import Library, Project, Property, Rock, Series, SpaceDips, Surface, build

random = np.random.default_rng(3)


def bedding(x, y, z):
    """The age of the beds: a recumbent fold with a nearly level axial plane."""
    return 0.5 * x + 150 * np.sin((z + 0.12 * y) / 85) + 0.08 * z


def normals(xyz, step=1e-3):
    """Toward younger rock: the gradient of the bedding."""
    return np.transpose([bedding(*(xyz + d).T) - bedding(*(xyz - d).T) for d in step * np.eye(3)])


places = random.uniform([0, 0, -600], [1000, 400, 0], (30000, 3))
contacts = {level: places[abs(bedding(*places.T) - level) < 0.3] for level in (120, 230, 340)}
measured = places[:40]

COLORS = {"Marl": "#9ab39a", "Limestone": "#6f9fc4", "Sandstone": "#e2b24c", "Shale": "#7c8088"}
library = Library([Property(n, name, color=color) for n, (name, color) in enumerate(COLORS.items(), 1)])
surfaces = [
    Surface(f"top of {name}", points=contacts[level], block=name, property=n, series="folded beds")
    for n, name, level in ((1, "Marl", 120), (2, "Limestone", 230), (3, "Sandstone", 340))
]
surfaces.append(Surface("ground", method="constant", options={"value": 0}, block="Shale", property=4))
folded = Series("folded beds", dips=SpaceDips(measured, normals(measured)), resolution=25)
region = [[0, 0], [1000, 0], [1000, 400], [0, 400]]
rock = Rock("fold", surfaces, region=region, edge_length=40, base_elevation=-600, series=[folded])
model = build(Project("Fold", [rock], library))

sample = random.uniform([0, 0, -600], [1000, 400, 0], (5000, 3))
true = np.searchsorted([120, 230, 340], bedding(*sample.T))
print(sum(map(len, contacts.values())), "contacts,", len(measured), "dips")
print(f"{np.mean(model.block_at(sample) == true):.0%} of the rock is in the right bed")

view = Picture(toward=(0.4, -1.0, 0.45))
view.blocks(model.clip("y", invert=False))  # the northern half; data up to 100 m in front of it
near = (measured[:, 1] > 100) & (measured[:, 1] < 200)
view.dips(measured[near], normals(measured)[near], 25, "dips, the stroke toward younger rock")
for surface in surfaces[:3]:
    near = (surface.points[:, 1] > 100) & (surface.points[:, 1] < 200)
    view.points(surface.points[near], "contacts, in the color of the block below", surface.block)
view.save()
