# SPDX-License-Identifier: GPL-3.0-or-later
"""A project with folds of closed form as one test case: what its data are drawn from, and how many."""

import json
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from faulted.case import plain
from faulted.contract import CUTS, PROTECTS, FaultSides, is_inside
from stacks import places

CORPUS = places.ROOT / "tests" / "data" / "folds"
SIZE, BASE = 10.0, 0.0
AIR, NEVER, BODY = -1, -2, 100  # nothing; below the oldest surface; bodies have this and their number


@dataclass
class Fold:
    """f = w - amplitude sin(u / wavelength + phase), u and w turned by an azimuth, a tilt, which makes a fold
    overturned or recumbent, and a plunge, after all was moved along z by another fold."""

    amplitude: float
    wavelength: float
    azimuth: float
    tilt: float
    plunge: float
    phase: float
    again: float = 0.0
    again_wavelength: float = 1.0

    def __call__(self, points):
        x, y, z = np.moveaxis(np.asarray(points, float) - 5.0, -1, 0)
        z = z - self.again * np.sin((0.6 * x - 0.8 * y) / self.again_wavelength)
        along = np.cos(self.azimuth) * x + np.sin(self.azimuth) * y
        across = np.cos(self.azimuth) * y - np.sin(self.azimuth) * x
        z = np.cos(self.plunge) * z + np.sin(self.plunge) * along
        u = np.cos(self.tilt) * across - np.sin(self.tilt) * z
        w = np.sin(self.tilt) * across + np.cos(self.tilt) * z
        return w - self.amplitude * np.sin(u / self.wavelength + self.phase)

    def normals(self, points):
        rows = [self(points + move) - self(points - move) for move in 1e-5 * np.eye(3)]
        return np.column_stack(rows) / np.linalg.norm(rows, axis=0)[:, None]


@dataclass
class SheetCase:
    """z = height + slope . (x, y) + bend sin x cos 0.7 y at the nodes of a mesh of count x count squares."""

    name: str
    rule: str
    height: float
    slope: list = field(default_factory=lambda: [0.0, 0.0])
    bend: float = 0.0
    count: int = 4

    def _at_nodes(self):
        axis = np.linspace(-0.5, SIZE + 0.5, self.count + 1)
        x, y = np.meshgrid(axis, axis)
        bent = self.bend * np.sin(x) * np.cos(0.7 * y)
        return x, y, self.height + self.slope[0] * (x - 5) + self.slope[1] * (y - 5) + bent

    def heights(self, x, y):
        """(N,) in its triangles."""
        places = [(each + 0.5) * self.count / (SIZE + 1.0) for each in (x, y)]
        i, j = (np.clip(np.floor(each), 0, self.count - 1).astype(int) for each in places)
        u, v = places[0] - i, places[1] - j
        z = self._at_nodes()[2]
        own, last = z[j, i], z[j + 1, i + 1]
        between = np.where(u > v, z[j, i + 1], z[j + 1, i])
        most, least = np.maximum(u, v), np.minimum(u, v)
        return own + most * (between - own) + least * (last - between)

    def mesh(self):
        x, y, z = (each.ravel() for each in self._at_nodes())
        at = np.arange(len(x)).reshape(self.count + 1, -1)
        a, b, c, d = (each.ravel() for each in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
        triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
        return np.column_stack([x, y, z]), triangles.astype(np.int32)


@dataclass
class SeriesCase:
    """A fold with its levels, oldest first, and the rules of the surfaces."""

    name: str
    fold: Fold
    levels: list
    rules: list

    def surfaces(self):
        return [f"{self.name}{k}" for k in range(len(self.levels))]


@dataclass
class ThrowCase:
    """A fault that displaces all up to `youngest`: rock above it was moved by -throw."""

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    youngest: str
    throw: list

    @property
    def beyond(self):
        return np.zeros((0, 3), np.int32)


@dataclass
class BodyCase:
    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    after: str | None = None
    void: bool = False


@dataclass
class Case:
    """events: SheetCase and SeriesCase, oldest first; the last is a sheet, the ground. contacts: of each
    surface of a series; dips of each series; places: seen blocks; holes: vertical, with intervals. noise: by
    which contacts are moved. is_level: the ground is level, above all else."""

    events: list
    seed: int
    contacts: int = 20
    dips: int = 20
    places: int = 0
    holes: int = 0
    noise: float = 0.0
    rounded: bool = False
    resolution: float = 1.0
    faults: list = field(default_factory=list)
    bodies: list = field(default_factory=list)
    cells: str = "columns"
    scale: float = 1.0
    shift: list = field(default_factory=lambda: [0.0, 0.0, 0.0])
    is_level: bool = False
    label: str = ""

    def series(self):
        return [event for event in self.events if isinstance(event, SeriesCase)]

    def surfaces(self):
        """(name, rule, function of points that is positive beneath) of each surface."""
        found = []
        for event in self.events:
            if isinstance(event, SheetCase):
                found.append(
                    (event.name, event.rule, lambda p, e=event: e.heights(p[:, 0], p[:, 1]) - p[:, 2])
                )
                continue
            for name, rule, level in zip(event.surfaces(), event.rules, event.levels, strict=True):
                found.append((name, rule, lambda p, e=event, v=level: v - e.fold(self.before(p, e))))
        return found

    def names(self):
        return [name for name, _, _ in self.surfaces()]

    def before(self, points, series):
        """Where points (N, 3) of a series were before the faults that displace it."""
        points = np.array(points, float)
        for fault in self.faults:
            if self.names().index(fault.youngest) < self.names().index(series.surfaces()[-1]):
                continue
            a, b, c = fault.vertices[fault.triangles[0]]
            side = FaultSides(fault, np.cross(b - a, c - a))
            above = side(points.reshape(-1, 3)).reshape(points.shape[:-1]) > 0
            points[above] += np.array(fault.throw)
        return points

    def blocks_at(self, points):
        """(N,) the numbers of the surfaces over points (N, 3), BODY and its number, or AIR."""
        state = np.full(len(points), AIR)
        protected, covered = np.zeros(len(points), bool), np.zeros(len(points), bool)
        insides = [is_inside(points, body.vertices[body.triangles])[0] for body in self.bodies]
        for k, (name, rule, height) in enumerate(self.surfaces()):
            beneath = height(points) > 0
            if rule in CUTS:
                state[~beneath & ~protected] = AIR
            state[beneath & (state == AIR)] = k
            covered[:] = True
            if rule in PROTECTS:
                protected |= beneath | (state != AIR)
            for b, body in enumerate(self.bodies):
                if (body.after or self.names()[-1]) == name:
                    state[insides[b]] = AIR if body.void else BODY + b
        state[points[:, 2] < BASE] = AIR
        return state

    def placed(self, points):
        return np.asarray(points, float) * self.scale + np.array(self.shift)

    def size(self):
        return sum(len(each.levels) for each in self.series()) * self.contacts + self.dips + self.places

    def summary(self):
        return f"{len(self.events)} events, {len(self.faults)} faults, {len(self.bodies)} bodies"


def save_case(case, path, why=""):
    text = json.dumps({"why": why, **plain(asdict(case))}, indent=1)
    text = re.sub(r"\[\s*([^\[\]{}]*?)\s*\]", lambda row: "[" + " ".join(row.group(1).split()) + "]", text)
    Path(path).write_text(text + "\n", encoding="utf-8")


def _number(value):
    """What `plain` wrote: doubles as hexadecimal text."""
    if isinstance(value, str) and re.fullmatch(r"-?0x[0-9a-f.]+p[+-]\d+", value):
        return float.fromhex(value)
    if isinstance(value, list):
        return [_number(each) for each in value]
    if isinstance(value, dict):
        return {key: _number(each) for key, each in value.items()}
    return value


def load_case(path):
    """Reads what save_case wrote."""
    data = _number(json.loads(Path(path).read_text(encoding="utf-8")))
    data.pop("why")

    def event(row):
        return SeriesCase(**{**row, "fold": Fold(**row["fold"])}) if "fold" in row else SheetCase(**row)

    def shape(row):
        arrays = {
            "vertices": np.array(row["vertices"], float),
            "triangles": np.array(row["triangles"], np.int32),
        }
        return {**row, **arrays}

    return Case(
        **{
            **data,
            "events": [event(row) for row in data["events"]],
            "faults": [ThrowCase(**shape(row)) for row in data["faults"]],
            "bodies": [BodyCase(**shape(row)) for row in data["bodies"]],
        }
    )
