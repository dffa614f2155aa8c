# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a case is built right: a list of sentences, each with a kind of failure before its colon."""

import io
import re

import numpy as np
from stacks import places

from . import signs
from .contract import AIR, UNDECIDED, Contract, is_inside
from .located import Faces, distances

NEAR = 128  # units in the last place: what is nearer to some surface is not decided
LINES = 12  # vertical ones on which all that is between two surfaces is looked at
VALIDATED = 600  # points of the validation of one model in three


def kinds_of(failures):
    return {failure.split(":")[0] for failure in failures}


def failures_of(case, count=240, seed=1):
    """What is wrong with what the program makes of a case; [] where nothing is."""
    from realmodel.core import InputRefused, build

    try:
        model = build(case.project(), cells=case.cells, threads=1)
    except InputRefused as error:
        text = str(error)
        if case.refused is not None:
            return [] if re.search(case.refused, text) else [f"refusal: not for {case.refused}: {text}"]
        if _falls_beyond(case, text) or _is_torn(case, error):
            return []
        what = re.sub(r"'[^']*'|[-\d.,()]+", "", text.split(": ", 1)[-1])[:40]
        return [f"refused {' '.join(what.split())}: {text}"]
    except Exception as error:
        return [f"raised: {type(error).__name__}: {error}"]
    if case.refused is not None:
        return [f"built: it should be refused for {case.refused}"]
    failures = topology(model)
    if not len(model.cell_block):
        return failures
    failures += Judgement(case, model, count, seed).failures()
    if not case.label or int(case.label) % 3 == 1:
        report = model.validate(VALIDATED, threads=1)
        failures += [f"validation: {test.name}: {test.offenders[:2]}" for test in report.tests if test.failed]
    if int(case.label or 0) % 3 == 0:
        again = build(case.project(), cells=case.cells, threads=2)
        if model_bytes(again) != model_bytes(model):
            failures.append("threads: two give other bytes than one")
    return failures


def _falls_beyond(case, text):
    """Beside a few points near a line dsi goes up and down without end: below the base, and beyond faults."""
    if all(surface.method != "dsi" for rock in case.rocks for surface in rock.surfaces):
        return False
    if "base_elevation" in text and "is not below all of the rock mass" in text:
        return True
    found = re.search(r"fault '(.*?)': it ends inside the rock .* near \(\S+, \S+, ([-+.\de]+)\)", text)
    if found is None:
        return False
    heights = next(fault.vertices[:, 2] for fault in case.faults if fault.name == found[1])
    return not heights.min() <= float(found[2]) <= heights.max()


def _is_torn(case, error):
    """Whether a mesh has two heights at the place of a refusal, and no fault passes between them: its
    triangles reach beyond the tip of a fault that displaces it."""
    found = re.search(r"surface '(.*?)': it has two elevations beyond the tip of fault", str(error))
    if found is None:
        return False
    place = np.array([error.place])
    for surface in (surface for rock in case.rocks for surface in rock.surfaces if surface.name == found[1]):
        corners = surface.vertices[surface.triangles]
        _, over, _ = signs.triangles_over(place[:, :2], corners)
        a, b, c = corners[over].transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        z = a[:, 2] - ((place[:, :2] - a[:, :2]) * normal[:, :2]).sum(axis=1) / normal[:, 2]
        if len(z) < 2 or z.min() == z.max():
            return False
        low, high = (np.append(place[0, :2], height) for height in (z.min(), z.max()))
        return not any(
            signs.crossings(low[None], high, fault.vertices[fault.triangles])[0].any()
            for fault in case.faults
        )
    return False


def model_bytes(model):
    from realmodel.core.exporters.model_arrays import model_arrays

    buffer = io.BytesIO()
    np.savez(buffer, **model_arrays(model))
    return buffer.getvalue()


def topology(model):
    """Closed cells, distinct vertices, positive volumes; the outside checker's tests where it is there."""
    failures = []
    sizes = np.diff(model.face_offsets)
    face = np.repeat(np.arange(len(sizes)), sizes)
    after = np.arange(len(face)) + 1
    after[model.face_offsets[1:] - 1] = model.face_offsets[:-1]
    begin, end = model.face_vertices, model.face_vertices[after]
    uses = []
    for side, turn in ((0, 1), (1, -1)):
        cells = model.face_cells[face, side]
        known = cells >= 0
        way = np.where(begin < end, turn, -turn)
        uses.append(np.stack([cells, np.minimum(begin, end), np.maximum(begin, end), way], axis=1)[known])
    rows = np.concatenate(uses)
    _, number = np.unique(rows[:, :3], axis=0, return_inverse=True)
    number = number.ravel()
    balance, used = np.bincount(number, rows[:, 3]), np.bincount(number)
    if (balance != 0).any():
        failures.append(f"closed: {(balance != 0).sum()} edges of cells are open")
    if model.cell_kind == "columns" and (used != 2).any():
        failures.append(f"touching: {(used != 2).sum()} edges are used more than twice by a cell")
    least = -1e-12 * float(np.prod(np.ptp(model.vertices, axis=0))) if len(model.vertices) else 0.0
    if (model.cell_volumes < least).any():
        failures.append(f"volume: {(model.cell_volumes < least).sum()} cells have a negative one")
    total = np.bincount(model.cell_block, model.cell_volumes, len(model.blocks))
    given = np.array([block.volume for block in model.blocks])
    if not np.allclose(total, given, rtol=1e-9, atol=1e-9 * max(total.max(initial=0.0), 1e-300)):
        failures.append(f"volumes: blocks have {given}, their cells {total}")
    checker = places.checker()
    if checker is not None:
        buffer = io.BytesIO(model_bytes(model))
        failures += [f"checker: {text}" for text in checker.check_topology(checker.Complex(buffer))]
    return failures


def _area(ring):
    x, y = (ring - ring[0]).T
    return abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())) / 2


class Judgement:
    """A model compared with the contract at random places."""

    def __init__(self, case, model, count, seed):
        self.case, self.model, self.random = case, model, np.random.default_rng(seed)
        self.count = count
        self.contract = Contract(case, model.structures, model.rock_inputs) if model.structures else None
        dying = {fault.name for fault in case.faults if fault.dies_out}
        self.parting = [f for f, fault in enumerate(case.faults) if not dying & {fault.name, *fault.ends_at}]
        around = [f.name for f in case.faults if f.name not in dying and dying & set(f.ends_at)]
        self.around = re.compile("|".join(f"(above|below) {name}" for name in around) or "$^")
        self.faces = Faces(model)
        self.rounding = NEAR * np.spacing(np.abs(model.vertices).max())
        first = np.cumsum([0, *(len(rock.surfaces) for rock in case.rocks)])
        self.number = {}  # of surfaces of the model: that of the contract's block
        for r, rock in enumerate(case.rocks):
            self.number |= {int(first[r]) + k: int(first[r]) + k for k in range(len(rock.surfaces))}
        total = int(first[-1])
        for b in range(len(case.bodies)):
            self.number[total + len(case.faults) + b] = total + b
        self.surfaces = total
        self.block = np.array([self.number[block.surface] for block in model.blocks])[model.cell_block]

    def failures(self):
        if self.contract is None:
            return []
        low, high = self.model.vertices.min(axis=0), self.model.vertices.max(axis=0)
        margin = 0.05 * (high - low)
        spread = self.random.uniform(low - margin, high + margin, (self.count, 3))
        face, at, step = self.faces.beside(self.random, self.count, self.rounding)
        points = np.concatenate([spread, at - step, at + step, self._on_lines(low, high)])
        said, rows, rock = self.contract.at(points)
        cells = self.faces.cells(points)
        failures, of_point = self._blocks(points, said, cells)
        failures += self._sides_of_cells(points, rows, rock, of_point)
        n = self.count
        first, second, last = n, n + len(face), n + 2 * len(face)
        failures += self._neighbors(face, of_point[first:second], of_point[second:last], points[n:])
        failures += self._surfaces(face, at, rows[n:])
        return failures + self._whole_volume()

    def _on_lines(self, low, high):
        """(N, 3) on some vertical lines a point between each two places where anything crosses them."""
        shapes = [v[t] for entry in self.model.rock_inputs for s in entry.structure.sheets for v, t in s]
        shapes += [side.corners for side in self.contract.sides]
        shapes += [body.vertices[body.triangles] for body in self.case.bodies]
        corners = np.concatenate([*shapes, self.faces.corners])
        plan = self.random.uniform(low[:2], high[:2], (LINES, 2))
        rows, numbers, on_edge = signs.triangles_over(plan, corners)
        a, b, c = corners[numbers[~on_edge]].transpose(1, 0, 2)
        rows = rows[~on_edge]
        normal = np.cross(b - a, c - a)
        off = ((plan[rows] - a[:, :2]) * normal[:, :2]).sum(axis=1)
        z = a[:, 2] - off / normal[:, 2]
        bases = [rock.base_elevation for rock in self.case.rocks if rock.base_elevation is not None]
        margin = 0.05 * (high[2] - low[2])
        ends, found = (low[2] - margin, high[2] + margin), []
        for row, place in enumerate(plan):
            levels = np.unique(np.clip([*z[rows == row], *bases, -np.inf, np.inf], *ends))
            middles = (levels[:-1] + levels[1:])[np.diff(levels) > 4 * self.rounding] / 2
            found.append(np.column_stack([np.tile(place, (len(middles), 1)), middles]))
        return np.concatenate(found)

    def _whole_volume(self):
        """Under a level surface above everything else the rock fills its region from the base, but for voids
        that came last."""
        case = self.case
        if not case.is_full:
            return []
        whole = 0.0
        for rock, entry in zip(case.rocks, self.model.rock_inputs, strict=True):
            ring, *holes = (_area(ring) for ring in rock.rings)
            top = float(rock.surfaces[-1].vertices[0, 2])
            sheets = [vertices for of in entry.structure.sheets for vertices, _ in of]
            if any((vertices[:, 2] > top).any() for vertices in sheets):  # splines may go anywhere
                return []
            whole += (ring - sum(holes)) * (top - rock.base_elevation)
        found = float(self.model.cell_volumes.sum())
        if abs(found - whole) > 1e-9 * whole:
            return [f"whole: the cells have the volume {found!r}, the region up to its top {whole!r}"]
        return []

    def _near(self, point, but=None):
        """Whether a point is so near to some surface that rounding may have moved it across."""
        point = point[None]
        shapes = [v[t] for entry in self.model.rock_inputs for s in entry.structure.sheets for v, t in s]
        shapes += [side.corners for side in self.contract.sides]
        shapes += [body.vertices[body.triangles] for body in self.case.bodies]
        away = min((distances(point, shape)[0] for shape in shapes), default=np.inf)
        plan = np.inf
        rings = [ring for rock in self.case.rocks for ring in rock.rings]
        for entry in self.model.rock_inputs:
            rings += [v[t][:, :2] for s in entry.structure.sheets for v, tt in s for t in tt]
        for ring in rings:
            for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                t = np.clip((point[0, :2] - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0, 1)
                plan = min(plan, float(np.linalg.norm(point[0, :2] - a - t * (b - a))))
        bases = [rock.base_elevation for rock in self.case.rocks if rock.base_elevation is not None]
        away = min([away, plan, *(abs(point[0, 2] - base) for base in bases)])
        return away <= self.rounding

    def _blocks(self, points, said, cells):
        failures, of_point = [], np.full(len(points), -9)
        for n, (expected, own) in enumerate(zip(said.tolist(), cells, strict=True)):
            if own is None:
                continue
            if len(own) > 1 or any(times != 1 for times in own.values()):
                if not self._near(points[n]):
                    failures.append(f"overlap: at {points[n].tolist()} are the cells {own}")
                continue
            cell = next(iter(own), -1)
            of_point[n] = cell
            if expected == UNDECIDED:
                continue
            is_block = AIR if cell < 0 else int(self.block[cell])
            if is_block != expected and not self._near(points[n]):
                texts = [self._name(is_block), self._name(expected)]
                failures.append(f"point: at {points[n].tolist()} is {texts[0]}, the contract says {texts[1]}")
        return failures[:6], of_point

    def _name(self, block):
        blocks = self.contract.blocks
        return str(blocks[block]) if 0 <= block < len(blocks) else {AIR: "air"}.get(block, str(block))

    def _sides_of_cells(self, points, rows, rock, of_point):
        """No cell straddles a fault that acts, and compartments are named by these sides.

        A fault that dies out leaves one compartment with a slit: a cell that reaches past its tip is on both
        sides. A branch that ends at such a fault is there on one side of it alone. Past the tip a way leads
        out of where the branch is, and from there to its other side: so that is one compartment, too, and a
        cell that reaches out may be on both sides."""
        failures, seen = [], {}
        for n in np.flatnonzero(of_point >= 0):
            cell = int(of_point[n])
            if rock[n] < 0:
                continue
            own = tuple(
                int(rows[n, f]) if self.contract.acts(f, int(self.block[cell]), int(rock[n])) else 0
                for f in self.parting
            )
            first, at = seen.setdefault((cell, int(rock[n])), (own, n))
            if first != own and not self._near(points[n]) and not self._near(points[at]):
                ends = [points[at].tolist(), points[n].tolist()]
                failures.append(f"straddles: cell {cell} is on {first} at {ends[0]} and {own} at {ends[1]}")
        failures += self._around_branches(points, rows, rock, of_point)
        for (cell, r), (own, at) in seen.items():
            words = [
                f"{'above' if side > 0 else 'below'} {fault.name}"
                for side, fault in zip(own, (self.case.faults[f] for f in self.parting), strict=True)
                if side
            ]
            mass = self.case.rocks[r].name
            name = ", ".join(words)
            if len(self.case.rocks) > 1:
                name = f"{mass}: {name}" if name else mass
            given = self._without_branches(
                self.model.compartment_names[self.model.cell_compartment[cell]], mass
            )
            if given != (name or mass) and not self._near(points[at]):
                place = points[at].tolist()
                failures.append(f"compartment: cell {cell} is in '{given}', at {place} is '{name or mass}'")
        return failures[:6]

    def _around_branches(self, points, rows, rock, of_point):
        """No cell is on both sides of a branch that acts there and ends at a fault that dies out, but one
        that reaches past that fault: with some vertex, as these are planes."""
        failures, model = [], self.model
        for f, fault in enumerate(self.case.faults):
            if not self.around.fullmatch(f"above {fault.name}"):
                continue
            acts = [
                cell >= 0 and self.contract.acts(f, int(self.block[cell]), int(r))
                for cell, r in zip(of_point, rock, strict=True)
            ]
            below, above = (np.array(acts) & (rows[:, f] == side) for side in (-1, 1))
            for cell in set(of_point[below].tolist()) & set(of_point[above].tolist()):
                faces = np.flatnonzero((model.face_cells == cell).any(axis=1))
                spans = zip(model.face_offsets[faces], model.face_offsets[faces + 1], strict=True)
                corners = model.vertices[np.unique([v for a, b in spans for v in model.face_vertices[a:b]])]
                ends = zip(self.contract.ends[f], self.contract.kept[f], strict=True)
                reaches = any((self.contract.sides[other](corners) == -kept).any() for other, kept in ends)
                at = [points[(of_point == cell) & side] for side in (below, above)]
                if not reaches and not any(all(self._near(p) for p in some) for some in at):
                    ends = [some[0].tolist() for some in at]
                    failures.append(
                        f"straddles: cell {cell} is below {fault.name} at {ends[0]}, above at {ends[1]}"
                    )
        return failures

    def _without_branches(self, name, mass):
        """The name of a compartment without the branches that cells may go round."""
        first, colon, rest = name.rpartition(": ")
        words = [word for word in rest.split(", ") if not self.around.fullmatch(word)]
        return first + colon * bool(words) + ", ".join(words) or mass

    def _neighbors(self, face, inner, outer, points):
        """Beside a face are the cells that it names."""
        failures = []
        for k, (f, own, other) in enumerate(zip(face, inner, outer, strict=True)):
            for which, found in ((0, own), (1, other)):
                expected = self.model.face_cells[f, which]
                p = points[k + which * len(face)]
                if found not in (-9, expected) and not self._near(p) and not self._is_between(p, f):
                    failures.append(f"beside: at {p.tolist()} is cell {found}, face {f} names {expected}")
        return failures[:4]

    def _is_between(self, point, face):
        """Whether another face is about as near to a point as that which it was taken beside."""
        own = self.faces.face == face
        away = distances(point[None], self.faces.corners[own])[0]
        return distances(point[None], self.faces.corners[~own])[0] < 2 * away

    def _displaces(self, fault, block):
        """Whether a fault displaces a block somewhere, or what is below the oldest surface: no block."""
        rocks = range(len(self.case.rocks))
        return block == AIR or any(self.contract.acts(fault, block, rock) for rock in rocks)

    def _is_vertical(self, face):
        """Whether the area of a face in plan is only what rounding makes of a line."""
        normal = self.faces.normal[face]
        plan = self.faces.corners[self.faces.face == face][:, :, :2].reshape(-1, 2)
        rounded = self.rounding * np.linalg.norm(np.ptp(plan, axis=0))
        return abs(normal[2]) <= max(1e-6 * np.linalg.norm(normal), rounded)

    def _surfaces(self, face, at, rows):
        """Faces lie on the surfaces that they name, and faults are there only where they act."""
        failures = []
        model = self.model
        tolerance = max(self.rounding, 1e-9 * np.ptp(model.vertices, axis=0).max())
        sheets = {}
        first = 0
        for entry in model.rock_inputs:
            for k in range(len(entry.surfaces)):
                sheets[first + k] = [v[t] for s in entry.structure.sheets for v, t in [s[k]]]
            first += len(entry.surfaces)
        for n, f in enumerate(face):
            name, p = int(model.face_surface[f]), at[n][None]
            cells = model.face_cells[f]
            blocks = [int(self.block[c]) if c >= 0 else AIR for c in cells]
            vertical = self._is_vertical(f)
            said = f"face {f} at {p[0].tolist()} between {blocks} is named {name}"
            if name == -2:
                bases = [rock.base_elevation for rock in self.case.rocks]
                if not any(base is not None and abs(p[0, 2] - base) <= tolerance for base in bases):
                    failures.append(f"base: {said}")
                continue
            if name == -1:
                if not vertical:
                    failures.append(f"wall: {said}, but is not vertical")
            elif name < self.surfaces:
                if min(distances(p, corners)[0] for corners in sheets[name]) > tolerance:
                    failures.append(f"surface: {said}, but is not on it")
            elif name < self.surfaces + len(self.case.faults):
                if distances(p, self.contract.sides[name - self.surfaces].own)[0] > tolerance:
                    failures.append(f"fault: {said}, but is not on it")
            else:
                body = self.case.bodies[name - self.surfaces - len(self.case.faults)]
                if distances(p, body.vertices[body.triangles])[0] > tolerance:
                    failures.append(f"body: {said}, but is not on it")
            inner, outer = rows[n], rows[n + len(face)]
            acting = [
                g
                for g in range(len(self.case.faults))
                if inner[g] != outer[g] and any(self._displaces(g, block) for block in blocks)
            ]
            own = name - self.surfaces
            # in a body that was protected in parts, what came later ends at a fault of what protects
            in_body = any(is_inside(p, body.vertices[body.triangles])[0] for body in self.case.bodies)
            is_needed = own in acting or (in_body and blocks[0] != blocks[1])
            if 0 <= own < len(self.case.faults) and not is_needed:
                failures.append(f"unacting: {said}, which does not act there")
            is_cut = not vertical and not 0 <= name < self.surfaces  # columns in bodies end at surfaces
            same = blocks[0] == blocks[1] and len(set(model.cell_compartment[cells])) == 1
            if same and not acting and (is_cut or model.cell_kind == "blocks"):
                failures.append(f"needless: {said}, both of one block and compartment")
        return failures[:6]
