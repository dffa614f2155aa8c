# SPDX-License-Identifier: GPL-3.0-or-later
"""A project with faults and bodies as one test case, and the small files that the corpus is made of."""

import json
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from stacks import places

CORPUS = places.ROOT / "tests" / "data" / "structures"


@dataclass
class SurfaceCase:
    """points (P, 3), or vertices (V, 3) with triangles (T, 3)."""

    name: str
    rule: str = "erosional"
    points: np.ndarray | None = None
    vertices: np.ndarray | None = None
    triangles: np.ndarray | None = None
    method: str | None = None


@dataclass
class RockCase:
    """rings: outlines and holes (N, 2) each, even-odd; none for no region."""

    name: str
    surfaces: list
    rings: list = field(default_factory=list)
    edge_length: float | None = None
    base_elevation: float | None = None


@dataclass
class FaultCase:
    """beyond: further triangles that make the fault a surface which divides all of the space around the rock.
    The program does not get them: they give the judge the side of each point."""

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    beyond: np.ndarray
    youngest: str | None = None
    ends_at: list = field(default_factory=list)
    dies_out: bool = False
    rocks: list = field(default_factory=list)


@dataclass
class BodyCase:
    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    after: str | None = None
    void: bool = False
    rock: str | None = None


@dataclass
class Case:
    """refused: what the refusal must say, as a regular expression; None where it must build. is_full: each
    rock mass has a base, its oldest surface covers its region, its youngest is level, above all others."""

    rocks: list
    faults: list = field(default_factory=list)
    bodies: list = field(default_factory=list)
    cells: str = "columns"
    refused: str | None = None
    label: str = ""
    is_full: bool = False

    def project(self):
        """The same for the program."""
        from realmodel.core import Body, Fault, Project, Rock, Surface

        rocks = [
            Rock(
                rock.name,
                [
                    Surface(
                        surface.name,
                        vertices=surface.vertices,
                        triangles=surface.triangles,
                        points=surface.points,
                        method=surface.method,
                        rule=surface.rule,
                    )
                    for surface in rock.surfaces
                ],
                region=list(rock.rings) or None,
                edge_length=rock.edge_length,
                base_elevation=rock.base_elevation,
            )
            for rock in self.rocks
        ]
        faults = [
            Fault(f.name, f.vertices, f.triangles, f.youngest, tuple(f.ends_at), f.dies_out, tuple(f.rocks))
            for f in self.faults
        ]
        bodies = [
            Body(b.name, b.vertices, b.triangles, b.after, void=b.void, rock=b.rock) for b in self.bodies
        ]
        return Project("p", rocks, faults=faults, bodies=bodies)

    def size(self):
        """Of how many things it consists."""
        meshes = [s for rock in self.rocks for s in rock.surfaces if s.triangles is not None]
        counts = [len(each.triangles) for each in (*meshes, *self.faults, *self.bodies)]
        counts += [len(s.points) for rock in self.rocks for s in rock.surfaces if s.points is not None]
        return sum(counts) + sum(len(rock.surfaces) for rock in self.rocks)

    def summary(self):
        return f"{len(self.faults)} faults, {len(self.bodies)} bodies"


def plain(value):
    """Arrays as lists; doubles that are no small integers as exact hexadecimal text."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items() if each is not None}
    if isinstance(value, (list, tuple)):
        return [plain(each) for each in value]
    if isinstance(value, float):
        return int(value) if value.is_integer() and abs(value) < 2**53 else value.hex()
    return value


def save_case(case, path, why=""):
    text = json.dumps({"why": why, **plain(asdict(case))}, indent=1)
    # one row of numbers a line reads better than one number a line
    text = re.sub(r"\[\s*([^\[\]{}]*?)\s*\]", lambda row: "[" + " ".join(row.group(1).split()) + "]", text)
    Path(path).write_text(text + "\n", encoding="utf-8")


def _number(value):
    return None if value is None else float.fromhex(value) if isinstance(value, str) else float(value)


def _places(rows, columns):
    if rows is None:
        return None
    return np.array([[_number(x) for x in row] for row in rows], np.float64).reshape(-1, columns)


def _corners(rows):
    return None if rows is None else np.array(rows, np.int32).reshape(-1, 3)


def load_case(path):
    """Reads what save_case wrote."""
    data = json.loads(Path(path).read_text(encoding="utf-8"))

    def shape(row, *more):
        own = {key: row[key] for key in row if key not in ("vertices", *more)}
        arrays = {key: _corners(row.get(key)) for key in more}
        return {**own, **arrays, "vertices": _places(row.get("vertices"), 3)}

    def surface(row):
        return SurfaceCase(**{**shape(row, "triangles"), "points": _places(row.get("points"), 3)})

    rocks = [
        RockCase(
            row["name"],
            [surface(each) for each in row["surfaces"]],
            [_places(ring, 2) for ring in row["rings"]],
            _number(row.get("edge_length")),
            _number(row.get("base_elevation")),
        )
        for row in data["rocks"]
    ]
    faults = [FaultCase(**shape(row, "triangles", "beyond")) for row in data["faults"]]
    bodies = [BodyCase(**shape(row, "triangles")) for row in data["bodies"]]
    return Case(
        rocks,
        faults,
        bodies,
        data["cells"],
        data.get("refused"),
        data.get("label", ""),
        data.get("is_full", False),
    )
