# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of planar meshes, ours and the peers', each in a process of its own (process.alone)."""

from __future__ import annotations

import time

import numpy as np

from .process import Skipped, peak_resident

AREA_BOUND = (
    1.5  # for Triangle, in equilateral triangles of the edge asked for: its mean edge then is that one
)
_GROWTH = 0.25  # of edges with distance, ours and so Gmsh's and Triangle's
_QUARTER = np.sqrt(3) / 4  # area of the equilateral triangle of side 1
_SQUARE = np.array([[0, 0], [1000, 0], [1000, 1000], [0, 1000]], float)
# Where the graded mesh is fine: place, length there in shares of the largest, distance within which it is so.
_FINE = (((700.0, 300.0), 1 / 24, 60.0), ((150.0, 800.0), 1 / 12, 40.0), ((480.0, 520.0), 1 / 16, 0.0))


def _circle(x: float, y: float, radius: float, corners: int) -> np.ndarray:
    turn = np.arange(corners) * 2 * np.pi / corners
    return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])


HOLES = (_circle(300, 300, 120, 64), _circle(650, 700, 150, 7))
IN_HOLES = ((300.0, 300.0), (650.0, 700.0))


def signed_area(ring: np.ndarray) -> float:
    x, y = (ring - ring[0]).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


_AREA = 1e6 - sum(abs(signed_area(hole)) for hole in HOLES)


def edge_for(triangles: float) -> float:
    """The edge length at which the square with two holes has so many equilateral triangles."""
    return float(np.sqrt(_AREA / triangles / _QUARTER))


def wanted_length(places: np.ndarray, largest: float) -> np.ndarray:
    """The length that the graded mesh is to have at places (P, 2)."""
    wanted = np.full(len(places), largest)
    for place, share, distance in _FINE:
        away = np.hypot(*(places - place).T)
        wanted = np.minimum(wanted, share * largest + _GROWTH * np.maximum(0, away - distance))
    return wanted


def graded_largest(triangles: float) -> float:
    """The largest length at which the graded mesh has about so many triangles."""
    nodes = (np.stack(np.meshgrid(*2 * (np.arange(400) + 0.5,)), axis=-1) * 2.5).reshape(-1, 2)
    low, high = 0.05, 200.0
    for _ in range(30):
        middle = np.sqrt(low * high)
        count = np.sum(1 / wanted_length(nodes, middle) ** 2) * _AREA / len(nodes) / _QUARTER
        low, high = (middle, high) if count > triangles else (low, middle)
    return float(middle)


def _segments(rings) -> list[tuple[int, int]]:
    segments, first = [], 0
    for ring in rings:
        segments += [(first + i, first + (i + 1) % len(ring)) for i in range(len(ring))]
        first += len(ring)
    return segments


def _ours(mesher: str, edge: float, graded: bool):
    from realmodel.core import mesh_region

    size = [{"at": at, "length": share * edge, "distance": away} for at, share, away in _FINE if graded]
    return lambda: mesh_region(_SQUARE, HOLES, edge, mesher, size=size)


def _triangle(edge: float, graded: bool):
    try:
        import triangle
    except ImportError as error:
        raise Skipped(f"Triangle is not there: {error}") from error
    rings = (_SQUARE, *HOLES)
    plan = {"vertices": np.concatenate(rings), "segments": _segments(rings), "holes": IN_HOLES}

    def run():
        if not graded:
            bound = AREA_BOUND * _QUARTER * edge**2
            made = triangle.triangulate(plan, f"pq30a{bound:.12f}")
            return made["vertices"], made["triangles"]
        # Its own way to graded meshes: refining what is too large, again and again.
        made = triangle.triangulate(plan, "pq30")
        while True:
            corners = made["vertices"][made["triangles"]]
            u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
            bounds = AREA_BOUND * _QUARTER * wanted_length(corners.mean(axis=1), edge) ** 2
            if (areas <= bounds).all():
                return made["vertices"], made["triangles"]
            made["triangle_max_area"] = bounds[:, None]
            made = triangle.triangulate(made, "rpq30a")

    return run


def gmsh_run(polygons, edge: float, graded: bool = False):
    """What meshes polygons, each its outline and its holes, with Gmsh: returns places and triangles."""
    try:
        import gmsh
    except (ImportError, OSError) as error:
        raise Skipped(f"Gmsh is not there: {error}") from error
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal-Delaunay
    for rings in polygons:
        loops = []
        for ring in rings:
            way = ring if loops or signed_area(ring) > 0 else ring[::-1]
            points = [gmsh.model.geo.addPoint(x, y, 0, edge) for x, y in way]
            ends = zip(points, points[1:] + points[:1], strict=True)
            lines = [gmsh.model.geo.addLine(p, q) for p, q in ends]
            loops.append(gmsh.model.geo.addCurveLoop(lines))
        gmsh.model.geo.addPlaneSurface(loops)
    gmsh.model.geo.synchronize()
    if graded:
        _gmsh_sizes(gmsh, edge)

    def run():
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        number = np.zeros(int(tags.max()) + 1, np.int64)
        number[tags.astype(np.int64)] = np.arange(len(tags))
        _, corners = gmsh.model.mesh.getElementsByType(2)
        return places.reshape(-1, 3)[:, :2], number[corners.astype(np.int64)].reshape(-1, 3)

    return run


def _gmsh_sizes(gmsh, edge: float) -> None:
    """The same lengths as ours, as formulas; nothing else is to decide about them."""
    for option in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    fields = []
    for (x, y), share, distance in _FINE:
        field = gmsh.model.mesh.field.add("MathEval")
        away = f"sqrt((x-{x})^2+(y-{y})^2)-{distance}"
        gmsh.model.mesh.field.setString(field, "F", f"{share * edge}+{_GROWTH}*0.5*({away}+fabs({away}))")
        fields.append(field)
    constant = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(constant, "F", f"{edge}")
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", [*fields, constant])
    gmsh.model.mesh.field.setAsBackgroundMesh(least)


def mesh(mesher: str, edge: float, graded: bool) -> dict:
    """Seconds of processor time (each of them works in one thread) for a mesh of the square with two holes,
    bytes resident at most by then, and its figures."""
    if mesher in ("Triangle", "Gmsh"):
        run = _triangle(edge, graded) if mesher == "Triangle" else gmsh_run([(_SQUARE, *HOLES)], edge, graded)
    else:
        run = _ours(mesher, edge, graded)
    began = time.process_time()
    vertices, triangles = run()
    seconds = time.process_time() - began
    resident = peak_resident()  # before the figures take theirs
    return {"seconds": seconds, "resident": resident, **figures(vertices, triangles, edge, graded)}


def figures(vertices: np.ndarray, triangles: np.ndarray, edge: float, graded: bool) -> dict:
    """triangles; least angle, degrees; mean ratio, 1 where equilateral; mean edge in lengths asked for where
    it lies; share of inside vertices with six neighbours."""
    corners = vertices[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.hypot(sides[..., 0], sides[..., 1])
    twice = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    ratios = 2 * np.sqrt(3) * twice / (lengths**2).sum(axis=1)
    sines = np.abs(twice)[:, None] / (lengths * np.roll(lengths, 1, axis=1))
    wanted = wanted_length(corners.mean(axis=1), edge)[:, None] if graded else edge
    around = np.bincount(triangles.ravel(), minlength=len(vertices))
    ends = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    _, first, uses = np.unique(
        ends[:, 0].astype(np.int64) * len(vertices) + ends[:, 1], return_index=True, return_counts=True
    )
    inside = around > 0
    inside[ends[first[uses == 1]].ravel()] = False
    return {
        "triangles": len(triangles),
        "least_angle": float(np.degrees(np.arcsin(sines.min()))),
        "mean_ratio": float(ratios.mean()),
        "mean_edge": float((lengths / wanted).mean()),
        "six": float((around[inside] == 6).mean()) if inside.any() else float("nan"),
    }


def polygon(kind: str) -> list[np.ndarray]:
    """About 100,000 corners: the outline and its holes."""
    count = 100_000
    own = np.random.default_rng(1)
    turn = np.arange(count) * 2 * np.pi / count
    if kind == "holes":
        circles = (_circle(20 + 31 * i, 20 + 31 * j, 12, 100) for i in range(32) for j in range(32))
        return [_SQUARE, *circles]
    if kind == "coast":
        waves = ((own.normal(0, 200 / k**1.2), k, own.random() * 2 * np.pi) for k in range(1, 400))
        radius = 2000 + sum(a * np.cos(k * turn + b) for a, k, b in waves)
    else:
        radius = {"star": 1000 - 10 * (np.arange(count) % 2), "bristles": 500 + 500 * own.random(count)}[kind]
    return [np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])]


def ears(who: str, kind: str) -> dict:
    """Seconds of processor time to divide a polygon into triangles of its corners, the best of five, and how
    many they are."""
    rings = polygon(kind)
    if who == "earcut":
        try:
            import mapbox_earcut
        except ImportError as error:
            raise Skipped(f"earcut is not there: {error}") from error
        corners = np.concatenate(rings)
        ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)

        def run():
            return mapbox_earcut.triangulate_float64(corners, ends).reshape(-1, 3)
    else:
        from realmodel.core import triangulate_polygon

        def run():
            return triangulate_polygon(rings[0], rings[1:])

    seconds = []
    for _ in range(5):
        began = time.process_time()
        made = run()
        seconds.append(time.process_time() - began)
    return {"seconds": min(seconds), "triangles": len(made), "corners": sum(len(ring) for ring in rings)}
