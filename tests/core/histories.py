# SPDX-License-Identifier: GPL-3.0-or-later
"""Random successions of known truth, with what is seen of them: near-flat beds with errors, rough ones with
few data, and folds."""

from dataclasses import dataclass

import numpy as np
from folded.case import Fold
from realmodel.core.base.work import run
from realmodel.core.fields import Lattice, LevelSetData, solve_field
from stacks.places import REAL_DATA

PLACES = 5000


@dataclass
class History:
    """What is seen, and f of the truth, whose surfaces have these levels in a box of some size."""

    data: LevelSetData
    truth: object
    levels: np.ndarray
    size: np.ndarray

    def blocks(self, f, levels):
        """(P,) the number of the block that each of some places is in, from the oldest."""
        return np.searchsorted(levels, f(self._places()))

    def share_right(self, nodes):
        """Of places, with a field on a lattice of about so many nodes. Raises InputRefused."""
        lattice = lattice_of(self, nodes)
        field = run(lambda work: solve_field(lattice, self.data, work))
        return self._share(self.blocks(field.at, field.levels))

    def share_of_planes(self):
        """The same with a plane through the contacts of each surface."""
        at, block = self._places(), 0
        for surface in range(len(self.levels)):
            contacts = self.data.contacts[self.data.contact_surfaces == surface] / self.size
            plane = np.linalg.lstsq(_terms(contacts), contacts[:, 2], rcond=None)[0]
            block = block + (at[:, 2] / self.size[2] > _terms(at / self.size) @ plane)
        return self._share(block)

    def _share(self, block):
        return float(np.mean(block == self.blocks(self.truth, self.levels)))

    def _places(self):
        return np.random.default_rng(7).uniform(0, self.size, (PLACES, 3))


def lattice_of(history, nodes):
    """Of its box, with about so many nodes."""
    steps = np.ceil(history.size / np.cbrt(history.size.prod() / nodes)).astype(int)
    return Lattice((0.0, 0.0, 0.0), tuple(history.size / steps), tuple((steps + 1).tolist()))


def _terms(points):
    return np.column_stack([np.ones(len(points)), points[:, :2]])


def near_flat(seed):
    """2 by 2 km, three surfaces 120 to 150 m apart: a plane of up to 15 degrees, or a wave of 15 or 40 m."""
    random = np.random.default_rng([60, 5, seed])
    size = np.array([2000.0, 2000.0, 1000.0])
    dip, azimuth = np.radians(random.uniform(0, 15)), random.uniform(0, 2 * np.pi)
    slope = np.tan(dip) * np.array([np.sin(azimuth), np.cos(azimuth)])
    wave = random.choice([0.0, 15.0, 40.0])
    if wave:
        slope *= random.choice([0.0, 0.3])
    direction, phase = random.uniform(0, 2 * np.pi), random.uniform(0, 2 * np.pi)
    waves = 2 * np.pi / random.uniform(800, 2000) * np.array([np.sin(direction), np.cos(direction)])
    levels = np.cumsum([0, *random.uniform(120, 150, 2)])
    levels -= levels.mean()

    def height(points):
        plan = points[:, :2]
        return 500 + (plan - 1000) @ slope + wave * np.sin(plan @ waves + phase)

    count, dips = int(random.integers(4, 41)), int(random.integers(5, 41))
    noise, tilt = random.uniform(3, 30), np.tan(np.radians(random.uniform(0, 4)))
    contacts = random.uniform(40, 1960, (3 * count, 3))
    surfaces = np.repeat(np.arange(3, dtype=np.int32), count)
    contacts[:, 2] = height(contacts) + levels[surfaces] + random.normal(0, noise, 3 * count)
    at = random.uniform(40, 1960, (dips, 3))
    at[:, 2] = height(at) + random.uniform(levels[0] - 50, levels[2] + 50, dips)
    rise = slope + (wave * np.cos(at[:, :2] @ waves + phase))[:, None] * waves
    rise = rise + tilt * random.normal(size=(dips, 2))
    normals = np.column_stack([-rise, np.ones(dips)])
    for places in (contacts, at):
        places[:, 2] = np.clip(places[:, 2], 5, 995)
    return _history(contacts, surfaces, at, normals, lambda p: p[:, 2] - height(p), levels, size)


def rough(seed):
    """2 by 2 km, three surfaces 120 to 150 m apart: a plane of up to 10 degrees, a Gaussian field of 20 to
    60 m on it, 3 to 8 contacts each, and 2 to 6 dips in all."""
    random = np.random.default_rng([63, seed])
    size = np.array([2000.0, 2000.0, 1000.0])
    dip, azimuth = np.radians(random.uniform(0, 10)), random.uniform(0, 2 * np.pi)
    slope = np.tan(dip) * np.array([np.sin(azimuth), np.cos(azimuth)])
    rises = random.normal(size=(40, 2)) / random.uniform(250, 600)  # of a field with a Gaussian variogram
    phases = random.uniform(0, 2 * np.pi, 40)
    deviation = random.uniform(20, 60) * np.sqrt(2 / 40)
    levels = np.cumsum([0, *random.uniform(120, 150, 2)])
    levels -= levels.mean()

    def height(points):
        plan = points[:, :2]
        waves = np.cos(np.outer(plan[:, 0], rises[:, 0]) + np.outer(plan[:, 1], rises[:, 1]) + phases)
        return 500 + (plan - 1000) @ slope + deviation * waves.sum(axis=1)

    count, dips = int(random.integers(3, 9)), int(random.integers(2, 7))
    noise, tilt = random.uniform(0, 5), np.tan(np.radians(random.uniform(0, 5)))
    contacts = random.uniform(40, 1960, (3 * count, 3))
    surfaces = np.repeat(np.arange(3, dtype=np.int32), count)
    contacts[:, 2] = height(contacts) + levels[surfaces] + random.normal(0, noise, 3 * count)
    at = random.uniform(40, 1960, (dips, 3))
    at[:, 2] = height(at) + random.choice(levels, dips)
    east, north = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
    rise = np.column_stack([height(at + step) - height(at - step) for step in (east, north)]) / 2
    rise += tilt * random.normal(size=(dips, 2))
    normals = np.column_stack([-rise, np.ones(dips)])
    for places in (contacts, at):
        places[:, 2] = np.clip(places[:, 2], 5, 995)
    return _history(contacts, surfaces, at, normals, lambda p: p[:, 2] - height(p), levels, size)


def folded(seed):
    """Folds of any attitude, upright to recumbent, some folded twice, with errors or without; None where a
    surface is not seen."""
    random = np.random.default_rng([61, seed])
    size = np.array([10.0, 10.0, 8.0])
    fold = Fold(
        amplitude=random.choice([0.3, 1.0, 1.6, 2.2]),
        wavelength=random.uniform(0.9, 2.5),
        azimuth=random.uniform(0, 2 * np.pi),
        tilt=random.choice(
            [0.0, random.uniform(-0.4, 0.4), random.uniform(0.6, 1.2), random.uniform(1.5, 2.9)]
        ),
        plunge=random.choice([0.0, random.uniform(-0.6, 0.6)]),
        phase=random.uniform(0, 2 * np.pi),
        again=random.choice([0.0, 0.0, random.uniform(0.2, 0.9)]),
        again_wavelength=random.uniform(1.2, 3.0),
    )
    levels = np.quantile(
        fold(random.uniform(0, size, (2000, 3))), np.linspace(0.2, 0.8, random.integers(2, 5))
    )
    noise = random.choice([0.0, 0.0, 0.03, 0.1])
    tilt = np.radians(random.choice([0.0, 3.0, 6.0])) if noise else 0.0
    z = np.linspace(0.1, 7.9, 800)
    contacts, surfaces = [], []
    for x, y in random.uniform(0.3, 9.7, (random.integers(5, 25), 2)):
        hole = np.column_stack([np.full(800, x), np.full(800, y), z])
        block = np.searchsorted(levels, fold(hole))
        for n in np.flatnonzero(np.diff(block)):
            contacts.append(hole[n])
            surfaces.append(min(block[n], block[n + 1]))
    if set(surfaces) != set(range(len(levels))):
        return None
    contacts = np.array(contacts) + noise * random.normal(size=(len(contacts), 3))
    contacts = np.clip(contacts, 0.01, size - 0.01)
    at = random.uniform(0.3, size - 0.3, (random.integers(10, 70), 3))
    normals = fold.normals(at) + tilt * random.normal(size=at.shape)
    return _history(contacts, np.array(surfaces, np.int32), at, normals, fold, levels, size)


def moureze(seed):
    """Some points and dips of the real surface of Moureze as a history without truth, places beside its other
    dips, and which of them are above it."""
    folder, random = REAL_DATA / "folds" / "moureze", np.random.default_rng([9, seed])
    contacts = np.loadtxt(folder / "s0.csv", delimiter=",", skiprows=1)
    rows = np.loadtxt(folder / "dips.csv", delimiter=",", skiprows=1)
    low = np.minimum(contacts.min(axis=0), rows[:, :3].min(axis=0)) - 20
    size = np.maximum(contacts.max(axis=0), rows[:, :3].max(axis=0)) + 20 - low
    dip, azimuth = np.radians(rows[:, 3:5]).T
    normals = np.column_stack([np.sin(dip) * np.sin(azimuth), np.sin(dip) * np.cos(azimuth), np.cos(dip)])
    at, normals = rows[:, :3] - low, normals * rows[:, 5:6]
    count, dips = random.integers(5, 40), random.integers(3, 16)
    seen = contacts[random.choice(len(contacts), count, replace=False)] - low
    known = random.choice(len(at), dips, replace=False)
    surfaces = np.zeros(count, np.int32)
    history = History(LevelSetData("A", seen, surfaces, at[known], normals[known]), None, np.zeros(1), size)
    beside = random.choice([5.0, 10.0, 20.0, 40.0], len(at)) * random.choice([-1, 1], len(at))
    asked = at + beside[:, None] * normals
    counts = np.all((asked > 0) & (asked < size), axis=1)
    counts[known] = False
    return history, asked[counts], beside[counts] > 0


def _history(contacts, surfaces, dips, normals, truth, levels, size):
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    names = "ABCD"[: len(levels)]
    return History(LevelSetData(names, contacts, surfaces, dips, normals), truth, levels, size)


@dataclass
class Nappe:
    """A recumbent fold whose beds keep their thickness: f is the distance from its axial surface, which ends
    at the hinge. Its history, and lines across the limb without data from the one surface that is seen there:
    where they begin, their direction, the thickness to each of the other surfaces, and their numbers."""

    history: History
    starts: np.ndarray
    across: np.ndarray
    seen: int

    def thickness_errors(self, field):
        """(L, surfaces - 1) by how much the others are too far from the one that is seen on the limb."""
        levels = self.history.levels
        steps = np.linspace(levels[0] - levels[self.seen] - 1.5, levels[-1] - levels[self.seen] + 1.5, 601)
        along = self.starts[:, None] + steps[None, :, None] * self.across[:, None]
        f = field.at(along.reshape(-1, 3)).reshape(along.shape[:2])
        inside = np.all((along > 0) & (along < self.history.size), axis=2)
        errors = []
        for number, level in enumerate(levels):
            crossed = [
                _crossing(row, steps, own, field.levels[number], level - levels[self.seen])
                for row, own in zip(f, inside, strict=True)
            ]
            errors.append(np.array(crossed) - (level - levels[self.seen]))
        errors = np.array(errors).T
        others = np.arange(len(levels)) != self.seen
        return (errors - errors[:, [self.seen]])[:, others]


def _crossing(values, steps, is_inside, level, near):
    """Where a function along a line has a level, next to a place; the end of the line where it has not."""
    values, steps = values[is_inside], steps[is_inside]
    at = np.flatnonzero((values[:-1] < level) & (values[1:] >= level))
    if not len(at):
        return steps[-1] if values[-1] < level else steps[0]
    share = (level - values[at]) / (values[at + 1] - values[at])
    crossings = steps[at] + share * (steps[at + 1] - steps[at])
    return crossings[np.abs(crossings - near).argmin()]


def nappe(seed):
    """10 by 10 by 8 km, two to four surfaces, seen at the hinge and on the upper limb, and one of them on the
    lower limb, too."""
    random = np.random.default_rng([62, seed])
    size = np.array([10.0, 10.0, 8.0])
    azimuth, tilt, plunge = (
        random.uniform(0, 2 * np.pi),
        random.uniform(-0.25, 0.25),
        random.uniform(-0.2, 0.2),
    )
    axis = np.array([np.cos(azimuth) * np.cos(plunge), np.sin(azimuth) * np.cos(plunge), np.sin(plunge)])
    forward = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])  # to where the hinge points
    up = np.cross(axis, forward)
    forward, up = np.cos(tilt) * forward + np.sin(tilt) * up, np.cos(tilt) * up - np.sin(tilt) * forward
    hinge = size / 2 + random.uniform(0.0, 1.0) * forward + random.uniform(-0.3, 0.3, 3)
    count = int(random.integers(2, 5))
    levels = 0.8 + np.cumsum([0, *random.uniform(0.5, 2.2 / count + 0.2, count - 1)])

    def truth(points):
        away = np.asarray(points, float) - hinge
        return np.hypot(np.maximum(away @ forward, 0), away @ up)

    def at(along, turned, behind, far):
        """Places at some distances from the axial surface."""
        out = np.cos(turned)[:, None] * forward + np.sin(turned)[:, None] * up
        return hinge + along[:, None] * axis - behind[:, None] * forward + far[:, None] * out, out

    def seen(number, far, on_hinge, sign):
        turned = np.where(on_hinge, random.uniform(-np.pi / 2, np.pi / 2, number), sign * np.pi / 2)
        behind = np.where(on_hinge, 0.0, random.uniform(0, 5, number))
        return at(random.uniform(-4, 4, number), turned, behind, far)

    contacts, surfaces = [], []
    for surface, level in enumerate(levels):
        places = seen(24, np.full(24, level), random.random(24) < 0.5, 1)[0]
        places = places[np.all((places > 0.05) & (places < size - 0.05), axis=1)][
            : int(random.integers(4, 10))
        ]
        contacts.append(places)
        surfaces.append(np.full(len(places), surface))
    known = int(random.integers(count))
    places = seen(24, np.full(24, levels[known]), np.zeros(24, bool), -1)[0]
    places = places[np.all((places > 0.05) & (places < size - 0.05), axis=1)][:4]
    contacts, surfaces = (
        np.concatenate([*contacts, places]),
        np.concatenate([*surfaces, np.full(len(places), known)]),
    )
    places, normals = seen(60, random.uniform(levels[0], levels[-1], 60), random.random(60) < 0.5, 1)
    inside = np.flatnonzero(np.all((places > 0.05) & (places < size - 0.05), axis=1))[
        : int(random.integers(8, 21))
    ]
    lines = 40
    starts, across = at(
        random.uniform(-4, 4, lines),
        np.full(lines, -np.pi / 2),
        random.uniform(1, 4, lines),
        np.full(lines, levels[known]),
    )
    fits = np.ones(lines, bool)
    for level in levels:
        ends = starts + (level - levels[known]) * across
        fits &= np.all((ends > 0.3) & (ends < size - 0.3), axis=1)
    history = _history(
        contacts, surfaces.astype(np.int32), places[inside], normals[inside], truth, levels, size
    )
    return Nappe(history, starts[fits], across[fits], known)


def slab(seed):
    """Beds 200 m thick, tilted or gently folded, seen in the middle of 4 by 4 km only."""
    random = np.random.default_rng([63, seed])
    size = np.array([4000.0, 4000.0, 2000.0])
    dip, azimuth = np.radians(random.uniform(0, 12)), random.uniform(0, 2 * np.pi)
    slope = np.tan(dip) * np.array([np.sin(azimuth), np.cos(azimuth)])
    wave = random.choice([0.0, 60.0])
    direction, phase = random.uniform(0, 2 * np.pi), random.uniform(0, 2 * np.pi)
    waves = 2 * np.pi / 4000 * np.array([np.sin(direction), np.cos(direction)])

    def height(points):
        plan = points[:, :2]
        return 1000 + (plan - 2000) @ slope + wave * np.sin(plan @ waves + phase)

    levels = np.array([-200.0, 0.0, 200.0])
    count, dips = int(random.integers(4, 12)), int(random.integers(4, 12))
    noise, tilt = random.choice([0.0, 5.0, 10.0]), np.tan(np.radians(random.choice([0.0, 2.0, 4.0])))
    contacts = random.uniform(1400, 2600, (3 * count, 3))
    surfaces = np.repeat(np.arange(3, dtype=np.int32), count)
    contacts[:, 2] = height(contacts) + levels[surfaces] + random.normal(0, noise, 3 * count)
    at = random.uniform(1400, 2600, (dips, 3))
    at[:, 2] = height(at) + random.uniform(-200, 200, dips)
    rise = slope + (wave * np.cos(at[:, :2] @ waves + phase))[:, None] * waves
    rise = rise + tilt * random.normal(size=(dips, 2))
    normals = np.column_stack([-rise, np.ones(dips)])
    return _history(contacts, surfaces, at, normals, lambda p: p[:, 2] - height(p), levels, size)


def border_thickness(history, field):
    """Of both beds of a slab, upward, in columns around its box."""
    z = np.linspace(0, history.size[2], 801)
    side = np.linspace(50, 3950, 9)
    columns = [(x, y) for x in side for y in side if not (400 < x < 3600 and 400 < y < 3600)]
    thickness = []
    for x, y in columns:
        f = field.at(np.column_stack([np.full(801, x), np.full(801, y), z]))
        thickness.append(np.diff(np.interp(field.levels, f, z)))
    return np.array(thickness)
