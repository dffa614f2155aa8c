# SPDX-License-Identifier: GPL-3.0-or-later
"""Models with names, properties and boreholes for the files of objects, and what is asked of their shapes."""

import numpy as np
from conftest import grid_surface
from realmodel.core import Boreholes, Library, Project, Property, Rock, Surface, build
from realmodel.core.exporters.shapes.shape_parts import FaceTriangles

SHIFT = np.array([400_000.25, 5_300_000.5, 0.0])
COLLARS = "hole,x,y,z,azimuth,dip\nB1,400000.75,5300001,9,,\nB2,400000.5,5300000.75,9,90,-80\n"
PICKS = "hole,surface,depth\nB1,S3,7.5\nB1,S2,8\nB1,S0,9\nB2,S2,8.25\nB2,S1,8.5\n"


def crossing_surfaces(shift):
    """Four that cross, with two blocks of one name."""

    def height(k):
        return lambda x, y: 0.3 * k + 0.4 * np.sin(5 * x + k) * np.cos(4 * y - k)

    names = [None, "Grès à Voltzia", "Clay", "Clay"]
    surfaces = []
    for k in range(4):
        vertices, triangles = grid_surface(7 + k, height(k))
        surfaces.append(Surface(f"S{k}", vertices + shift, triangles, property=k % 3, block=names[k]))
    return surfaces


def crossing_model(write, crs="EPSG:25832"):
    """Three layers that cross and a base, some of them in several parts, and two boreholes, one inclined."""
    surfaces = crossing_surfaces(SHIFT)
    region = [[400_000.25, 5_300_000.5], [400_001.25, 5_300_000.5], [400_001.25, 5_300_001.5]]
    region.append([400_000.25, 5_300_001.5])
    surfaces.append(Surface("cover", method="constant", options={"value": 3.0}, block="Cover"))
    boreholes = Boreholes(picks=write("picks.csv", PICKS), collars=write("collars.csv", COLLARS))
    rock = Rock("rock", surfaces, region=region, edge_length=0.25, base_elevation=-2.0, boreholes=boreholes)
    library = Library(
        [
            Property(1, "Sandstone", rock="sandstone", age="Buntsandstein", color="#c86432", density=2.5),
            Property(2, "Clay", color="#204060"),
        ]
    )
    return build(Project("crossing", [rock], library, crs=crs))


LOGS = """hole,from,to,block
L1,2,10,soil
L1,10,14,lost core
L1,14,25,clay
L1,25,40,rock
L2,0,12,soil
L2,12,16,clay
L2,16,18,core loss
L2,18,22,clay
L2,22,30,rock
L3,0,8,soil
L3,8,28,clay
L3,28,45,rock
"""
LOG_COLLARS = "hole,x,y,z,azimuth,dip\nL1,20,20,30,,\nL2,80,30,30,,\nL3,50,60,30,0,-60\n"


def logged_model(write):
    """Three layers from boreholes with intervals: one without its top, two with lost core, one inclined; and
    picks of one of them."""
    plan = [[0, 0], [100, 0], [100, 100], [0, 100]]
    boreholes = Boreholes(
        intervals=write("logs.csv", LOGS),
        collars=write("log_collars.csv", LOG_COLLARS),
        picks=write("log_picks.csv", "hole,surface,depth\nL1,C,12\n"),
    )
    names = (("R", "rock"), ("C", "clay"), ("S", "soil"))
    surfaces = [Surface(name, method="plane", block=block) for name, block in names]
    rock = Rock("r", surfaces, plan, edge_length=25.0, base_elevation=-20.0, boreholes=boreholes)
    return build(Project("logged", [rock]))


def volume(vertices, triangles):
    """Of what triangles close."""
    origin = vertices.mean(axis=0)
    a, b, c = (vertices[triangles] - origin).transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def assert_closed(triangles):
    """Each edge is used as often one way as the other."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    ways, counts = np.unique(edges, axis=0, return_counts=True)
    back, back_counts = np.unique(edges[:, ::-1], axis=0, return_counts=True)
    assert np.array_equal(ways, back)
    assert np.array_equal(counts, back_counts)


def corner_triples(vertices, triangles):
    """Each triangle as the places of its corners, the least one first; turned round it is another one."""
    found = []
    for corners in vertices[triangles].tolist():
        first = corners.index(min(corners))
        found.append(tuple(map(tuple, corners[first:] + corners[:first])))
    return found


def assert_shared(shapes, model):
    """Every triangle of closed shapes (vertices, triangles) that is not on the outside of the model is one of
    exactly one other shape, the other way round; but those whose corners are in one line."""
    turns = {}
    for vertices, triangles in shapes:
        for a, b, c in corner_triples(vertices, triangles[_has_area(vertices[triangles])]):
            least, most = sorted((b, c))
            turns.setdefault((a, least, most), []).append(1 if b == least else -1)
    sides = [sorted(found) for found in turns.values()]
    assert all(found in ([1], [-1], [-1, 1]) for found in sides)
    triangles = FaceTriangles.of(model)
    outside = (triangles.blocks == -1).any(axis=1) & _has_area(model.vertices[triangles.corners])
    assert len([found for found in sides if len(found) == 1]) == outside.sum()


def _has_area(corners):
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(normals, axis=1) > 1e-9
