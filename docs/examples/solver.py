# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh and a solver: the temperature around a salt dome, computed by OpenGeoSys on a mesh of the model.

It prints

    volumes of the mesh: within 2.9% of the exact ones
    500 m below the ground at x = 200: 25 degrees
    500 m below the ground at x = 2000: 33 degrees
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyvista as pv
from picture import Picture
from realmodel.core import Body, Library, Project, Property, Rock, Surface, build, save_mesh

PROGRAMS = Path(sys.executable).parent  # of OpenGeoSys: pip install ogs
COLORS = {"Limestone": "#8fb7d6", "Shale": "#9a9da3", "Sandstone": "#e8c888", "Salt": "#e6b8d8"}
library = Library([Property(n, name, color=color) for n, (name, color) in enumerate(COLORS.items(), 1)])

dome = pv.Sphere(theta_resolution=40, phi_resolution=40).translate((0, 0, 0.1))
dome.points = dome.points * [1500, 1500, 2600] + [2000, 1500, -2100]
tops = (("Limestone", -1900), ("Shale", -1100), ("Sandstone", 0))
surfaces = [
    Surface(f"top of {name}", method="constant", options={"value": z}, block=name, property=n)
    for n, (name, z) in enumerate(tops, 1)
]
region = [[0, 0], [4000, 0], [4000, 3000], [0, 3000]]
rock = Rock("basin", surfaces, region=region, edge_length=250, base_elevation=-3000)
salt = Body("Salt", dome.points, dome.regular_faces, property=4)
model = build(Project("Salt dome", [rock], library, bodies=[salt]))
mesh = model.simulation_mesh(edge_length=220, minimum_thickness=30, elements="tetrahedra")
print(f"volumes of the mesh: within {max(abs(mesh.volumes / mesh.exact_volumes - 1)):.1%} of the exact ones")

# solver.prj has the heat flow from below, the temperature of the ground, and the conductivity of each block.
with tempfile.TemporaryDirectory() as folder:
    save_mesh(mesh, Path(folder, "salt.vtu"))
    for name, z in ("top", -1), ("base", 1):  # boundaries: the faces that look against this direction
        extract = f"-i salt.vtu -o {name}.vtu -x 0 -y 0 -z {z} -a 20".split()
        subprocess.run([PROGRAMS / "ExtractSurface", *extract], cwd=folder, check=True, capture_output=True)
    shutil.copy(Path(__file__).with_suffix(".prj"), folder)
    subprocess.run([PROGRAMS / "ogs", "solver.prj"], cwd=folder, check=True, capture_output=True)
    result = pv.read(Path(folder, "heat_ts_1_t_1.000000.vtu"))

for x in (200, 2000):
    (temperature,) = pv.PolyData([x, 1500.0, -500.0]).sample(result)["temperature"]
    print(f"500 m below the ground at x = {x}: {temperature:.0f} degrees")

view = Picture()
view.blocks(model.clip("y", invert=False))
isotherms = result.slice("y", origin=(0, 1499, 0)).contour(np.arange(20, 120, 10), scalars="temperature")
view.lines(isotherms, "#c22f2f", 4, "isotherms, every 10 degrees")
view.save()
