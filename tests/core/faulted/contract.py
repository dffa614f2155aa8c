# SPDX-License-Identifier: GPL-3.0-or-later
"""What is at a point, by the contract alone: the events of each rock mass, oldest first, at the point.

The sheets are taken from the model as data. Sides of faults, insides of bodies and heights are decided
exactly, and share nothing with the program.
"""

import numpy as np

from . import signs

CUTS = ("erosional", "discontinuous")
PROTECTS = ("base", "discontinuous")
AIR, UNDECIDED = -1, -9
NEVER = -2  # below the oldest surface, where no block is
NOWHERE = -7  # in no compartment that the model has: an error


class FaultSides:
    """Which side of a fault, continued as the case says, points are on."""

    def __init__(self, fault, facing):
        """facing: (3,) where the upper side of the first triangle looks to."""
        triangles = np.concatenate([fault.triangles, fault.beyond])
        corners = fault.vertices[triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        if normal[0] @ facing < 0:
            corners, normal = corners[:, ::-1], -normal
        self.corners, self.own = corners, corners[: len(fault.triangles)]
        # one place on the upper side beside each of some triangles
        some = np.argsort(-np.linalg.norm(normal[: len(self.own)], axis=1))[:8]
        size = np.linalg.norm(normal[some], axis=1)[:, None]
        self.anchors = corners[some].mean(axis=1) + normal[some] / size * 1e-3 * np.sqrt(size)

    def __call__(self, points):
        """(N,) +1 above, -1 below, 0 where it is on the fault."""
        side = np.zeros(len(points), int)
        for anchor in self.anchors:
            left = np.flatnonzero(side == 0)
            if not len(left):
                break
            count, clean = signs.crossings(points[left], anchor, self.corners)
            assert np.isin(count[clean], (0, 1)).all(), "the fault with what is beyond does not divide space"
            side[left[clean]] = np.where(count[clean] == 0, 1, -1)
        return side

    def upward(self):
        """Of its own triangles: the area seen from above as a share of the area, negative if from below."""
        normal = np.cross(self.own[:, 1] - self.own[:, 0], self.own[:, 2] - self.own[:, 0])
        return normal[:, 2].sum() / np.linalg.norm(normal, axis=1).sum()


def is_inside(points, corners):
    """(N,) whether points are inside of a closed surface: whether a ray leaves it an odd number of times; and
    (N,) whether that is decided."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    inside, decided = np.zeros(len(points), bool), np.zeros(len(points), bool)
    for far in ((1.1, 1.37, 1.73), (-0.41, 1.93, 1.57), (1.67, -0.71, -0.83)):
        left = np.flatnonzero(~decided)
        to = low + np.array(far) * (high - low)
        count, clean = signs.crossings(points[left], to, corners)
        inside[left[clean]] = count[clean] % 2 != 0
        decided[left[clean]] = True
    return inside, decided


def levels(points, sheet):
    """(N,) of points and a sheet: +1 above, -1 below, 0 where it does not exist, 9 on it or on an edge."""
    vertices, triangles = sheet
    corners = vertices[triangles]
    found = np.zeros(len(points), int)
    rows, numbers, on_edge = signs.triangles_over(points[:, :2], corners)
    a, b, c = corners[numbers].transpose(1, 0, 2)
    facing = signs.turn(a[:, :2], b[:, :2], c[:, :2])
    level = signs.over(a, b, c, points[rows]) * facing
    level = np.where(on_edge | (level == 0), 9, level)
    for value in (-1, 1, 9):
        found[rows[level == value]] = value
    return found


def is_in_rings(plan, rings):
    """(N,) even-odd; and (N,) whether that is decided."""
    inside, decided = np.zeros(len(plan), bool), np.ones(len(plan), bool)
    for ring in rings:
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            passes = (a[1] > plan[:, 1]) != (b[1] > plan[:, 1])
            low, high = (a, b) if a[1] < b[1] else (b, a)
            side = signs.turn(low[None], high[None], plan)
            inside ^= passes & (side > 0)
            decided &= ~(passes & (side == 0))
    return inside, decided


class Contract:
    """The events of a case. Blocks are (rock, surface) and ("body", number)."""

    def __init__(self, case, structures, inputs):
        """structures, inputs: of the model, which gives the sheets and says which side of a fault it calls
        upper."""
        self.case, self.inputs = case, inputs
        self.sides = []
        for fault, its in zip(case.faults, structures.faults, strict=True):
            a, b, c = its.vertices[its.triangles[0]]
            self.sides.append(FaultSides(fault, np.cross(b - a, c - a)))
        names = [fault.name for fault in case.faults]
        self.ends = [[names.index(name) for name in fault.ends_at] for fault in case.faults]
        self.kept = [[self._kept(f, other) for other in ends] for f, ends in enumerate(self.ends)]
        self.displaced = []  # of each fault: by rock mass its youngest surface
        for fault in case.faults:
            self.displaced.append(self._times(fault.rocks, fault.youngest))
        self.times = [self._times([body.rock] if body.rock else [], body.after) for body in case.bodies]
        self.blocks = [(r, k) for r, rock in enumerate(case.rocks) for k in range(len(rock.surfaces))]
        self.blocks += [("body", b) for b in range(len(case.bodies))]

    def _times(self, rocks, surface):
        found = {}
        for r, rock in enumerate(self.case.rocks):
            names = [each.name for each in rock.surfaces]
            if rocks and rock.name not in rocks:
                continue
            if surface is None or surface in names:
                found[r] = len(names) - 1 if surface is None else names.index(surface)
        return found

    def _kept(self, branch, other):
        """The side of another fault on which the larger part of a branch is."""
        corners = self.sides[branch].own
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        weights = np.random.default_rng(1).dirichlet((1, 1, 1), (len(corners), 60))
        places = np.einsum("tsi,tik->tsk", weights, corners).reshape(-1, 3)
        above = (self.sides[other](places) > 0).reshape(len(corners), 60).mean(axis=1)
        return 1 if (area * above).sum() * 2 > area.sum() else -1

    def rows(self, points):
        """(N, F) sides of all faults, 0 beyond a fault at which one ends; and (N,) if that is decided."""
        rows = np.array([side(points) for side in self.sides]).reshape(-1, len(points)).T
        decided = (rows != 0).all(axis=1)
        done = set()
        while len(done) < len(self.sides):
            for f, ends in enumerate(self.ends):
                if f in done or not set(ends) <= done:
                    continue
                for other, kept in zip(ends, self.kept[f], strict=True):
                    rows[rows[:, other] == -kept, f] = 0
                done.add(f)
        return rows, decided

    def at(self, points):
        """(N,) numbers of blocks, AIR, or UNDECIDED; (N, F) rows of sides; (N,) the rock mass, -1 none."""
        rows, decided = self.rows(points)
        insides = [is_inside(points, body.vertices[body.triangles]) for body in self.case.bodies]
        for _, known in insides:
            decided &= known
        found, rock_of = np.full(len(points), AIR), np.full(len(points), -1)
        for r in range(len(self.case.rocks)):
            own, known = self._in_rock(r, points, rows, [inside for inside, _ in insides])
            decided &= known
            found = np.where(own != AIR, own, found)
            rock_of = np.where(own != AIR, r, rock_of)
        return np.where(decided, found, UNDECIDED), rows, rock_of

    def _in_rock(self, r, points, rows, insides):
        structure, rock = self.inputs[r].structure, self.case.rocks[r]
        decided = np.ones(len(points), bool)
        taken = np.ones(len(points), bool)
        if rock.rings:
            taken, decided = is_in_rings(points[:, :2], rock.rings)
        if rock.base_elevation is not None:
            decided &= points[:, 2] != rock.base_elevation
            taken &= points[:, 2] > rock.base_elevation
        state = np.full(len(points), AIR)
        own = rows[:, structure.faults.numbers]
        known = np.zeros(len(points), bool)
        for row, sheets in zip(structure.compartments, structure.sheets, strict=True):
            here = np.flatnonzero(taken & (own == row).all(axis=1))
            known[here] = True
            state[here], fine = self._history(r, points[here], sheets, [inside[here] for inside in insides])
            decided[here] &= fine
        first = self.blocks.index((r, 0))
        body = len(self.blocks) - len(insides)
        state = np.where(state >= 100, state - 100 + body, np.where(state >= 0, state + first, AIR))
        if rock.rings:
            shapes = [
                *(v for sheets in structure.sheets for v, _ in sheets),
                *(b.vertices for b in self.case.bodies),
            ]
            heights = np.concatenate([each[:, 2] for each in shapes])
            # there is air above the highest of them, and without a base nothing below the lowest
            is_under = points[:, 2] <= heights.max()
            is_over = (rock.base_elevation is not None) | (points[:, 2] >= heights.min())
            state[taken & decided & ~known & is_under & is_over] = NOWHERE
        return state, decided

    def _history(self, r, points, sheets, insides):
        """Numbers of surfaces, 100 and more for bodies; and whether they are decided."""
        rock = self.case.rocks[r]
        state, decided = np.full(len(points), AIR), np.ones(len(points), bool)
        protected, covered = np.zeros(len(points), bool), np.zeros(len(points), bool)
        if not rock.rings:  # its region is what its surfaces cover
            ever = np.any([levels(points, sheet) != 0 for sheet in sheets], axis=0)
            insides = [inside & ever for inside in insides]
        has_base = rock.base_elevation is not None
        for k, (surface, sheet) in enumerate(zip(rock.surfaces, sheets, strict=True)):
            level = levels(points, sheet)
            decided &= level != 9
            if surface.rule in CUTS:
                state[(level > 0) & ~protected] = AIR
            filled = (level < 0) & (state == AIR)
            block = np.where(covered, k, 0 if k == 0 and has_base else NEVER)
            state[filled] = block[filled]
            covered |= level != 0
            if surface.rule in PROTECTS:
                protected |= (level < 0) | ((level != 0) & (state != AIR))
            for b, inside in enumerate(insides):
                if self.times[b].get(r) != k:
                    continue
                inside = inside & (has_base | (state != NEVER))
                state[inside] = AIR if self.case.bodies[b].void else 100 + b
        return state, decided

    def acts(self, fault, block, rock):
        """Whether a fault displaces a block in a rock mass."""
        youngest = self.displaced[fault].get(rock, -1)
        kind, number = self.blocks[block]
        if kind == "body":
            return self.times[number].get(rock, 10**6) <= youngest
        return kind == rock and number <= youngest
