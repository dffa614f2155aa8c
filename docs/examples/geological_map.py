# SPDX-License-Identifier: GPL-3.0-or-later
"""A geological map: polygons on the ground and some dips become a model in depth.

It prints

    Sandstone  1.27 km2 on the map
    Shale      0.36 km2 on the map
    Limestone  0.32 km2 on the map
    Marl       0.87 km2 on the map
    Basalt     3.19 km2 on the map
    100% of the mapped places are in their block
"""

from pathlib import Path

import numpy as np
import pandas as pd
from picture import Picture
from realmodel.core import MapFile, Project, Rock, Surface, build, load_library

SAMPLE = Path(__file__).resolve().parents[2] / "blend_samples" / "mapped_valley"
CODES = {"Ss": "Sandstone", "Sh": "Shale", "Ls": "Limestone", "Ml": "Marl", "Bas": "Basalt"}  # of the map
BEDS = ("Sandstone", "Shale", "Limestone")

# The contacts on the map give points on each surface, at the heights of the ground. Dips lead it down.
dips = {name: SAMPLE / f"dips_{name.lower()}.csv" for name in BEDS}
trend = {"method": "universal_kriging"}
surfaces = [
    Surface(f"top of {name.lower()}", block=name, property=n, dips=dips[name], rule="conformable", **trend)
    for n, name in enumerate(BEDS, 1)
]
surfaces.append(Surface("base of basalt", block="Marl", property=4, **trend))  # it cuts the beds
surfaces.append(Surface("ground", block="Basalt", property=5, method="grid"))
rock = Rock(
    "valley",
    surfaces,
    region=[[0, 0], [3000, 0], [3000, 2000], [0, 2000]],
    edge_length=60,
    base_elevation=-100,
    map=MapFile(SAMPLE / "map.geojson", block="FORMATION", ground=SAMPLE / "ground.asc"),
    names=CODES,
)
model = build(Project("Mapped valley", [rock], load_library(SAMPLE / "library.toml")))
for area in model.geological_map():
    print(f"{model.blocks[area.block].name:9} {area.area / 1e6:5.2f} km2 on the map")
print(f"{model.observed().share:.0%} of the mapped places are in their block")

view = Picture(exaggeration=2)
view.blocks(model)
view.points([contact.place for contact in model.observed().contacts], "contacts of the map", size=9)
measured = pd.concat(pd.read_csv(file) for file in dips.values())
dip, toward = np.radians(measured.dip), np.radians(measured.dip_direction)
normals = np.column_stack([np.sin(dip) * np.sin(toward), np.sin(dip) * np.cos(toward), np.cos(dip)])
places = [(x, y, model.borehole(x, y)[0].top) for x, y in measured[["x", "y"]].to_numpy()]  # on the ground
view.dips(places, normals, 45, "dips", "#ffd23f")
view.save()
