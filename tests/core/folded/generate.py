# SPDX-License-Identifier: GPL-3.0-or-later
"""Random folds from a number, and the data that are seen of them."""

import math
import random

import numpy as np
from faulted import shapes

from .case import AIR, BODY, SIZE, BodyCase, Case, Fold, SeriesCase, SheetCase, ThrowCase

RULES = ("erosional", "erosional", "conformable", "base", "discontinuous")
PLACES = [(1.0, [0.0, 0, 0])] * 4 + [  # scale, shift
    (100.0, [452000.0, 6201000.0, -1800.0]),
    (40.115, [4500000.37, 5300000.11, 311.7]),
]
LOW, HIGH = (0.3, 0.3, 0.3), (9.7, 9.7, 7.8)  # where data are
TOP = 9.3  # of a ground above everything
FAULTS = ("lattice", "plane", "plane", "flat", "listric", "rough", "few")


def random_case(seed):
    rng = random.Random(f"folds {seed}")
    events = [_sheet(rng, f"old{k}", rng.uniform(1.8, 4.0)) for k in range(rng.choice([0, 0, 0, 1, 2]))]
    for n in range(1 if rng.random() < 0.85 else 2):
        events.append(_series(rng, "FG"[n]))
        count = rng.choice([0, 0, 1, 2])
        events += [_sheet(rng, f"young{n}{k}", rng.uniform(4.5 + n, 7.7)) for k in range(count)]
    is_level = rng.random() < 0.4
    if is_level:
        events.append(SheetCase("ground", "erosional", TOP, count=rng.choice([1, 3])))
    else:
        bend = rng.choice([0.0, 0.6])
        slope = [rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)]
        events.append(SheetCase("ground", "erosional", 8.0, slope, bend, rng.randint(1, 7)))
    case = Case(events, seed, is_level=is_level, label=str(seed))
    case.contacts, case.dips = rng.choice([(6, 10), (15, 20), (40, 40), (40, 0), (70, 70), (0, 15)])
    if case.contacts == 0 or rng.random() < 0.3:
        case.places = rng.choice([0, 40, 120])
        case.holes = rng.choice([4, 8, 15]) if case.contacts == 0 or rng.random() < 0.6 else 0
    case.noise = rng.choice([0.0] * 6 + [0.02, 0.2])
    case.rounded = rng.random() < 0.2
    case.resolution = rng.choice([0.6, 0.8, 1.0, 1.0, 1.7])
    case.cells = rng.choice(["columns", "columns", "blocks"])
    case.scale, case.shift = rng.choice(PLACES)
    case.faults = [_fault(rng, case, n) for n in range(rng.choice([0, 0, 0, 1, 1, 2]))]
    case.bodies = [_body(rng, case, n) for n in range(rng.choice([0, 0, 0, 0, 1, 2]))]
    return case


def _sheet(rng, name, height):
    slope = [rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15)]
    return SheetCase(name, rng.choice(RULES), height, slope, rng.choice([0.0, 0.2]), rng.randint(1, 6))


def _series(rng, name):
    """Upright, overturned, recumbent, refolded; open and tight."""
    fold = Fold(
        amplitude=rng.choice([0.3, 1.0, 1.6, 2.2]),
        wavelength=rng.uniform(0.9, 2.5),
        azimuth=rng.uniform(0, 2 * math.pi),
        tilt=rng.choice(
            [0.0, rng.uniform(-0.4, 0.4), rng.uniform(0.6, 1.2), math.pi / 2, rng.uniform(1.7, 2.9)]
        ),
        plunge=rng.choice([0.0, rng.uniform(-0.6, 0.6)]),
        phase=rng.uniform(0, 2 * math.pi),
        again=rng.choice([0.0, 0.0, rng.uniform(0.2, 0.9)]),
        again_wavelength=rng.uniform(1.2, 3.0),
    )
    count = rng.choice([1, 2, 3, 3, 4, 6])
    seen = np.sort(fold(np.random.default_rng(1).uniform(LOW, HIGH, (500, 3))))
    shares = sorted(rng.uniform(0.15, 0.85) for _ in range(count))
    for k in range(1, count):  # beds at least a little thick
        shares[k] = max(shares[k], shares[k - 1] + 0.04)
    levels = [float(seen[min(int(share * 500), 499)]) for share in shares]
    rules = [rng.choice(RULES) if rng.random() < 0.25 else "erosional" for _ in range(count)]
    return SeriesCase(name, fold, levels, rules)


def _fault(rng, case, number):
    vertices, triangles, _ = shapes.fault_surface(rng, rng.choice(FAULTS))
    series = rng.choice(case.series())
    throw = [rng.uniform(-1.2, 1.2) for _ in range(3)] if rng.random() < 0.8 else [0.0, 0.0, 0.0]
    return ThrowCase(f"T{number}", vertices, triangles, series.surfaces()[-1], throw)


def _body(rng, case, number):
    mesh = shapes.body_mesh(rng, SIZE, 8.0)
    after = rng.choice([None, *case.names()])
    return BodyCase(f"B{number}", *mesh, after, rng.random() < 0.25)


class Drawn:
    """The data of a case: contacts, by surfaces; dips, by series; observations (places, blocks, holes,
    depths), None where there are none."""

    def __init__(self, case):
        self.case, self.random = case, np.random.default_rng(case.seed)
        self.contacts, self.dips = {}, {}
        for series in case.series():
            for name, level in zip(series.surfaces(), series.levels, strict=True):
                self.contacts[name] = self._contacts(series, level)
            self.dips[series.name] = self._dips(series)
        self.observations = self._observations()

    def _value(self, series, points):
        return series.fold(self.case.before(points, series))

    def _contacts(self, series, level):
        """(C, 3) points on a level, by bisection between random points."""
        case, found = self.case, [np.empty((0, 3))]
        for _ in range(40):
            if sum(map(len, found)) >= case.contacts:
                break
            a, b = self.random.uniform(LOW, HIGH, (2, 4 * case.contacts, 3))
            if case.rounded:  # vertical holes at round places
                a[:, :2] = b[:, :2] = np.round(a[:, :2])
            low, high = (self._value(series, each) - level for each in (a, b))
            a, b, low = a[low * high < 0], b[low * high < 0], low[low * high < 0]
            for _ in range(50):
                middle = (a + b) / 2
                same = ((self._value(series, middle) - level) * low > 0)[:, None]
                a, b = np.where(same, middle, a), np.where(same, b, middle)
            found.append(a[np.abs(self._value(series, a) - level) < 1e-9])  # elsewhere a fault is between
        points = np.concatenate(found)[: case.contacts]
        return points + case.noise * self.random.normal(size=points.shape)

    def _dips(self, series):
        points = self.random.uniform(LOW, HIGH, (self.case.dips, 3))
        return points, series.fold.normals(self.case.before(points, series))

    def _observations(self):
        case, rows = self.case, []
        points = self.random.uniform(LOW, HIGH, (case.places, 3))
        for point, block in zip(points, case.blocks_at(points).tolist(), strict=True):
            if 0 <= block < BODY:
                rows.append((point, block, "", math.nan))
        for hole, (x, y) in enumerate(self.random.uniform(0.7, 9.3, (case.holes, 2)).tolist()):
            for top, bottom, block in self._log(x, y):
                rows += [([x, y, z], block, f"H{hole}", 8.5 - z) for z in (top, bottom)]
        return list(zip(*rows, strict=True)) if rows else None

    def _log(self, x, y):
        """(top, bottom, block) of the intervals of a vertical hole without those in bodies and air."""
        case, z = self.case, np.linspace(8.5, 0.2, 1500)
        blocks = case.blocks_at(np.column_stack([0 * z + x, 0 * z + y, z]))
        last, begin = np.flatnonzero(np.diff(blocks)), z[0]
        above, below = z[last], z[last + 1]
        for _ in range(45):
            middle = (above + below) / 2
            same = case.blocks_at(np.column_stack([0 * middle + x, 0 * middle + y, middle])) == blocks[last]
            above, below = np.where(same, middle, above), np.where(same, below, middle)
        ends = [*zip(last.tolist(), above.tolist(), strict=True), (len(z) - 1, z[-1])]
        for row, end in ends:
            block = int(blocks[row])
            if block != AIR and block < BODY:
                yield begin, end, block
            begin = end
