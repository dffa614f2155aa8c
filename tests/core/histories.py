# SPDX-License-Identifier: GPL-3.0-or-later
"""Random successions of known truth, with what is seen of them: near-flat beds with errors, and folds."""

from dataclasses import dataclass

import numpy as np
from folded.case import Fold
from realmodel.core.base.work import run
from realmodel.core.fields import Lattice, LevelSetData, solve_field

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
        steps = np.ceil(self.size / np.cbrt(self.size.prod() / nodes)).astype(int)
        lattice = Lattice((0.0, 0.0, 0.0), tuple(self.size / steps), tuple((steps + 1).tolist()))
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


def _history(contacts, surfaces, dips, normals, truth, levels, size):
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    names = "ABCD"[: len(levels)]
    return History(LevelSetData(names, contacts, surfaces, dips, normals), truth, levels, size)
