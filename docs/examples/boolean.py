# SPDX-License-Identifier: GPL-3.0-or-later
"""A Boolean: how much of an ore body does a pit reach? Two closed meshes divide each other exactly.

It prints

    ore in the pit    10.78 million m3
    waste in the pit  22.85 million m3
    ore left          33.72 million m3
"""

import numpy as np
import pyvista as pv
from picture import Picture
from realmodel.core import intersect

# An ore body with bumps, and a pit with benches: a profile turned around its axis. read_mesh reads yours.
ore = pv.Sphere(theta_resolution=80, phi_resolution=80)
bumps = 1 + 0.2 * np.sin(5 * ore.points[:, 0] * np.pi) * np.cos(4 * ore.points[:, 1] * np.pi)
ore.points = ore.points * bumps[:, None] * [720, 480, 240] + [40, 30, -130]
radii = np.repeat([0, 100, 140, 180, 220, 260, 300, 0], 2)[1:-1]
levels = np.repeat([-170, -130, -90, -50, -10, 30, 70], 2)
profile = pv.lines_from_points(np.column_stack([radii, 0 * radii, levels]))
pit = profile.extrude_rotate(resolution=72, capping=False).triangulate().clean(tolerance=1e-6)

NAMES = {(True, True): "ore in the pit", (True, False): "ore left", (False, True): "waste in the pit"}
result = intersect((ore.points, ore.regular_faces), (pit.points, pit.regular_faces))
for part in result.sub_blocks:
    print(f"{NAMES[part.in_a, part.in_b]:16} {part.volume / 1e6:6.2f} million m3")

view = Picture(toward=(0.35, -1.0, 0.8))
for part in result.sub_blocks:
    mesh = pv.PolyData.from_regular_faces(result.vertices, part.triangles)
    if part.in_a and part.in_b:
        view.surface(mesh.translate((0, 0, 260)), "ore in the pit, lifted", "#e0a030", spacing=30)
    elif part.in_a:
        view.surface(mesh, "ore left", "#8fa3b8", spacing=30)
view.save()
