# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata in a mesh: any closed mesh, such as a sculpted rock, is filled with folded and faulted beds.

It prints

    Bed 1:  1,162 m3 in 1 part(s)
    Bed 2:  8,144 m3 in 1 part(s)
    Bed 3: 28,856 m3 in 1 part(s)
    Bed 4: 30,788 m3 in 1 part(s)
    Bed 5: 12,040 m3 in 2 part(s)
    Bed 6:  8,761 m3 in 1 part(s)
    Bed 7:  3,413 m3 in 1 part(s)
    Bed 8:    432 m3 in 1 part(s)
    together 93,595 m3, as the mesh: 93,595 m3
"""

import numpy as np
import pyvista as pv
from picture import Picture
from realmodel.core import Strata, fill_with_strata

# A sculpted rock: a ball with a flat foot, pulled and pushed by waves. Yours comes from Blender or a scan.
rock = pv.Icosphere(radius=1, nsub=5)
x, y, z = rock.points.T
swell = (
    1
    + 0.2 * np.sin(3 * x + 1) * np.cos(4 * y)
    + 0.1 * np.sin(6 * z + 2 * x)
    + 0.04 * np.sin(14 * x) * np.sin(12 * y)
)
rock.points = rock.points * swell[:, None] * [40, 25, 30]
rock.points[:, 2] = np.maximum(rock.points[:, 2], -14)

strata = Strata(
    beds=8, dip=18, dip_direction=70, fold_amplitude=3, fold_wavelength=35, faults=2, throw=4, seed=3
)
model = fill_with_strata(rock.points, rock.regular_faces, strata)
for block in model.blocks:
    print(f"{block.name}: {block.volume:6,.0f} m3 in {block.components} part(s)")
print(f"together {model.volume:,.0f} m3, as the mesh: {rock.volume:,.0f} m3")

view = Picture()
view.blocks(model, spacing=4)
view.save()
