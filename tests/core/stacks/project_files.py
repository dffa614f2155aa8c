# SPDX-License-Identifier: GPL-3.0-or-later
"""Project files with OFF meshes and CSV points in which every double is exact."""

import json
from pathlib import Path

import numpy as np


def write_off(path, vertices, triangles):
    """An OFF file."""
    lines = ["OFF", f"{len(vertices)} {len(triangles)} 0"]
    lines += [" ".join(repr(float(x)) for x in row) for row in vertices]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_points(path, points):
    """A CSV file x,y,z."""
    rows = [",".join(repr(float(x)) for x in row) for row in points]
    Path(path).write_text("x,y,z\n" + "\n".join(rows) + "\n", encoding="utf-8")


def _ring_text(ring):
    return "[" + ", ".join(f"[{float(x)!r}, {float(y)!r}]" for x, y in ring) + "]"


def rock_table(name, region=None, holes=(), edge_length=None, base_elevation=None):
    """The TOML rows of a [[rock]]."""
    rows = [f'\n[[rock]]\nname = "{name}"']
    if region is not None:
        rows.append(f"region = {_ring_text(region)}")
    if len(holes):
        rows.append(f"holes = [{', '.join(_ring_text(hole) for hole in holes)}]")
    if edge_length is not None:
        rows.append(f"edge_length = {edge_length!r}")
    if base_elevation is not None:
        rows.append(f"base_elevation = {float(base_elevation)!r}")
    return rows


def mesh_rows(folder, meshes, rules=None, prefix=""):
    """Writes one OFF file for each mesh of {name: (vertices, triangles)}; the TOML rows of the surfaces."""
    rows = []
    for number, (name, (vertices, triangles)) in enumerate(meshes.items()):
        write_off(folder / f"{prefix}{name}.off", vertices, triangles)
        rows.append(f'\n[[rock.surface]]\nname = "{name}"\nmesh = "{prefix}{name}.off"\nproperty = {number}')
        if rules:
            rows.append(f'rule = "{rules[number]}"')
    return rows


def point_rows(folder, points, neighbours):
    """Writes one CSV file for each of {name: (P, 3) points}; the TOML rows of the kriged surfaces."""
    rows = []
    for number, (name, rows_of_points) in enumerate(points.items()):
        write_points(folder / f"{name}.csv", rows_of_points)
        rows.append(
            f'\n[[rock.surface]]\nname = "{name}"\npoints = "{name}.csv"\nmethod = "kriging"\n'
            f"neighbours = {neighbours}\nproperty = {number}"
        )
    return rows


def write_project(folder, name, rows):
    """Writes project.toml; its path."""
    path = Path(folder) / "project.toml"
    path.write_text("\n".join([f'format = 1\nname = "{name}"', *rows]) + "\n", encoding="utf-8")
    return path


def mesh_project(folder, name, meshes, base_elevation=None):
    """A project of one rock mass of ready meshes, in a folder; its path."""
    rows = rock_table(name, base_elevation=base_elevation) + mesh_rows(Path(folder), meshes)
    return write_project(folder, name, rows)


def points_project(folder, name, points, region, edge_length, neighbours=16):
    """A project of one rock mass whose surfaces are kriged on its region's mesh; its path."""
    rows = rock_table(name, region, edge_length=edge_length) + point_rows(Path(folder), points, neighbours)
    return write_project(folder, name, rows)


def stack_project(folder, masses):
    """A project of stacks whose regions, if any, are triangulations that rings bound; its path.

    Returns None where a region's border touches itself in a corner: how its rings run is then open.
    """
    folder, rows = Path(folder), []
    for number, stack in enumerate(masses):
        rings = [] if stack.region is None else border_rings(*stack.region)
        if rings is None:
            return None
        outlines = [ring for ring in rings if _is_counter_clockwise(ring)]
        if len(outlines) > 1:  # which holes lie in which outline does not matter: rings count even-odd
            write_rings(folder / f"r{number}.geojson", rings)
            rows += rock_table(f"rock {number}", base_elevation=stack.base_elevation)
            rows[-1] += f'\nregion = "r{number}.geojson"'
        else:
            holes = [ring for ring in rings if not _is_counter_clockwise(ring)]
            region = outlines[0] if rings else None
            rows += rock_table(f"rock {number}", region, holes, base_elevation=stack.base_elevation)
        meshes = {f"S{k}": surface for k, surface in enumerate(stack.surfaces)}
        rows += mesh_rows(folder, meshes, stack.all_rules(), f"r{number}_")
    return write_project(folder, "stacks", rows)


def _is_counter_clockwise(ring):
    x, y = (ring - ring[0]).T
    return (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() > 0


def write_rings(path, rings):
    """GeoJSON in which each ring is a polygon."""
    polygons = [{"type": "Polygon", "coordinates": [[*ring.tolist(), ring[0].tolist()]]} for ring in rings]
    path.write_text(json.dumps({"type": "GeometryCollection", "geometries": polygons}), encoding="utf-8")


def border_rings(vertices, triangles):
    """The closed rings (N, 2) of a plan triangulation's border; None where one touches itself in a corner."""
    points = [tuple(row) for row in np.asarray(vertices).tolist()]
    edges = set()
    for t in np.asarray(triangles).tolist():
        a, b, c = (points[i] for i in t)
        if (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0]):
            b, c = c, b
        for edge in ((a, b), (b, c), (c, a)):
            if edge[::-1] in edges:
                edges.remove(edge[::-1])
            else:
                edges.add(edge)
    following = dict(edges)
    if len(following) != len(edges):
        return None
    rings = []
    while following:
        start, at = following.popitem()
        ring = [start]
        while at != start:
            ring.append(at)
            at = following.pop(at)
        rings.append(np.array(ring))
    return rings
