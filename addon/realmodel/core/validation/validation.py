# SPDX-License-Identifier: GPL-3.0-or-later
"""The validation of a model: the tests of docs/dev/geometry.md, with a report."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field

import numpy as np

from ..base.errors import UsageError, place_text
from ..base.work import Cancel, Progress, Work, native_module, run
from ..cells.built_cells import native_rocks
from ..cells.model_data import ModelData
from ..settings.method_options import check_threads
from .closed_form import check_points

_DTYPES = {
    "vertices": np.float64,
    "face_offsets": np.int64,
    "face_vertices": np.int32,
    "face_cells": np.int32,
    "face_surface": np.int32,
    "cell_block": np.int32,
}
# By the name of a test: its number in docs/dev/geometry.md, and its statement about the model.
_SAYS = {
    "arrays": (0, "array lengths and indices are consistent"),
    "closed": (1, "every cell is closed: its faces use each edge once in each direction"),
    "faces": (2, "faces are simple polygons in one plane, convex or vertical walls"),
    "loops": (2, "no face repeats a vertex"),
    "vertices": (2, "vertices are distinct, and all are used"),
    "outside": (3, "faces with one cell are the outer boundary"),
    "volumes": (4, "every cell has positive volume"),
    "block volumes": (4, "the volume of each block is the sum of its cells"),
    "places": (5, "on vertical lines the model has the blocks of the closed form, at their elevations"),
    "surfaces": (5, "faces lie on the surfaces that they name"),
    "walls": (5, "each side of a wall is the block that the wall names, or the outside"),
}
_SAYS_OF_BLOCKS = {"closed": "every cell is closed: its faces use each edge as often in either direction"}
_SAYS_OF_STRUCTURES = {
    "places": "at points anywhere and beside faces and structures the model has the closed form's block",
    "surfaces": "faces lie on the surfaces, faults and bodies that they name",
}
_WIDTH = 100
PLACES_OF_CHECK = 40_000  # where nothing is said: for a reviewer, seconds at most
PLACES_OF_REPORT = 4_000  # in every report.json


@dataclass(frozen=True)
class Offender:
    """One failure: a sentence, the numbers of the cell, face, vertex and block (None: not applicable), and
    the position (x, y, z) in model units or None."""

    text: str
    cell: int | None = None
    face: int | None = None
    vertex: int | None = None
    block: int | None = None
    place: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class ValidationTest:
    """One test. number: as in docs/dev/geometry.md (0: that the others can be asked). says: what it says of a
    model that passes. examined counts cells, faces or what else `unit` is; undecided are those that rounding
    leaves open (a cell thinner than the spacing of doubles, a place as close to an edge): they are counted as
    neither passed nor failed. offenders are the first few that failed."""

    name: str
    number: int
    says: str
    unit: str
    examined: int
    failed: int
    undecided: int
    seconds: float
    offenders: list[Offender] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        return self.failed == 0

    def to_json(self) -> dict:
        return {
            "name": self.name,
            "number": self.number,
            "says": self.says,
            "unit": self.unit,
            "examined": self.examined,
            "passed": self.passed,
            "failed": self.failed,
            "undecided": self.undecided,
            "seconds": self.seconds,
            "offenders": [
                {**vars(offender), "place": list(offender.place) if offender.place else None}
                for offender in self.offenders
            ],
        }


@dataclass(frozen=True)
class ValidationReport:
    """What Model.validate found. `str(report)` is for a reviewer to read, `to_json()` for report.json.

    project: its name; cell_kind: as of Model; cells, faces, vertices: how many there are. tests: what was
    tested, each with what it examined and what failed. seed: of the places where the model was compared with
    the closed form. build_seconds: what intersecting took, to compare the cost with (0: not known).
    """

    project: str
    cell_kind: str
    cells: int
    faces: int
    vertices: int
    tests: list[ValidationTest]
    seed: int = 1
    build_seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether every test passed."""
        return all(test.passed for test in self.tests)

    @property
    def seconds(self) -> float:
        """The time that the tests took, seconds."""
        return sum(test.seconds for test in self.tests)

    def _cost(self) -> list[str]:
        """Lines about the time that validation took."""
        sampled = sum(test.seconds for test in self.tests if test.number == 5)
        whole = self.seconds - sampled
        line = f"every cell, face and vertex in {whole:.2f} s"
        if self.build_seconds:
            line += f" ({100 * whole / self.build_seconds:.1f} % of the time of intersecting)"
        return [line, f"random positions with seed {self.seed} in {sampled:.2f} s"] if sampled else [line]

    def failure(self) -> str | None:
        """One line about the first test that failed, with its first offender; None where all passed."""
        for test in self.tests:
            if not test.passed:
                return f"test '{test.name}' ({test.says}): {_offender_line(test.offenders[0])}"
        return None

    def to_json(self) -> dict:
        """The entry of the report."""
        return {
            "passed": self.passed,
            "seconds": self.seconds,
            "seed": self.seed,
            "tests": [test.to_json() for test in self.tests],
        }

    def __str__(self) -> str:
        verdict = "passed" if self.passed else "FAILED"
        lines = [
            f"Validation of {self.project}: {verdict}",
            f"{self.cells:,} cells ({self.cell_kind}), {self.faces:,} faces, {self.vertices:,} vertices",
            *self._cost(),
            "",
        ]
        names = max(len(test.name) for test in self.tests)
        counts = max(len(_examined(test)) for test in self.tests)
        for test in self.tests:
            result = "passed" if test.passed else "FAILED"
            head = f"{test.number}  {test.name.ljust(names)}  {_examined(test).rjust(counts)}  {result}  "
            rest = " " * len(head)
            lines += textwrap.wrap(test.says, _WIDTH, initial_indent=head, subsequent_indent=rest)
            if test.undecided:
                lines.append(f"{rest}{test.undecided:,} of them within rounding, undecided")
            if test.failed:
                lines.append(f"   {test.failed:,} failed:")
                lines += [f"   - {_offender_line(offender)}" for offender in test.offenders]
                if test.failed > len(test.offenders):
                    lines.append(f"   - and {test.failed - len(test.offenders):,} more")
        return "\n".join(lines)


def _examined(test: ValidationTest) -> str:
    return f"{test.examined:,} {test.unit}"


def _offender_line(offender: Offender) -> str:
    return f"{offender.text} near {place_text(offender.place)}" if offender.place else offender.text


def validate(
    model: ModelData,
    places: int = PLACES_OF_CHECK,
    seed: int = 1,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> ValidationReport:
    """Model.validate."""
    for name, value, least in (("places", places, 0), ("seed", seed, 0)):
        if isinstance(value, bool) or not hasattr(value, "__index__") or not least <= int(value) < 2**63:
            raise UsageError(f"{name} must be a whole number from {least}, not {value!r}")
    threads = check_threads(threads)
    if places and not model.is_cut:
        model.require_project("the closed form")

    def task(work: Work) -> list[ValidationTest]:
        wrong = _wrong_arrays(model)
        if wrong:
            offenders = [Offender(text) for text in wrong]
            number, says = _SAYS["arrays"]
            faces = len(model.face_surface)
            return [ValidationTest("arrays", number, says, "faces", faces, len(wrong), 0, 0.0, offenders)]
        native, arrays = native_module(), _native_model(model)
        with work.phase(0.0, 0.6, "checking every cell and face"):
            results = work.native(native.check_topology, arrays)
        if places and not model.is_cut and results[0]["failed"] == 0 and len(model.vertices):
            with work.phase(0.6, 1.0, "comparing with the closed form"):
                if not model.is_stack:
                    results += check_points(work, model, arrays, int(places), int(seed))
                else:
                    results += work.native(
                        native.check_samples,
                        arrays,
                        native_rocks(model),
                        _block_of_surface(model),
                        int(places),
                        int(seed),
                    )
        tests = [_test(entry, model) for entry in results]
        return sorted(tests, key=lambda test: test.number)

    tests = run(task, progress, cancel, threads=threads)
    return ValidationReport(
        project=model.project.name,
        cell_kind=model.cell_kind,
        cells=len(model.cell_block),
        faces=len(model.face_surface),
        vertices=len(model.vertices),
        tests=tests,
        seed=int(seed),
        build_seconds=model.timings.get("intersect", 0.0),
    )


def _wrong_arrays(model: ModelData) -> list[str]:
    """Sentences about arrays of another dtype or shape than docs/dev/geometry.md gives them."""
    columns = {"vertices": 3, "face_cells": 2}
    wrong = []
    for name, dtype in _DTYPES.items():
        array = getattr(model, name)
        if array.dtype != dtype:
            wrong.append(f"{name} is {array.dtype}, not {np.dtype(dtype)}")
        if array.ndim != (2 if name in columns else 1) or array.shape[1:] != (columns.get(name),) * (
            array.ndim - 1
        ):
            wrong.append(f"{name} has the shape {array.shape}")
    counts = np.diff(model.surface_vertex_offsets)
    triangles = model.surface_triangles
    limit = np.repeat(counts, np.diff(model.surface_triangle_offsets))
    if len(limit) != len(triangles) or (triangles < 0).any() or (triangles >= limit[:, None]).any():
        wrong.append("surface_triangles name vertices that do not exist")
    return wrong


def _native_model(model: ModelData) -> dict:
    """The model as the native tests take it."""
    return {
        **{name: getattr(model, name) for name in _DTYPES},
        "block_volume": np.array([block.volume for block in model.blocks], np.float64),
        "block_base": _bases(model),
        "surfaces": len(model.surface_names),
        "cells_are_blocks": model.cell_kind == "blocks",
    }


def _bases(model: ModelData) -> np.ndarray:
    """(B,) float64 the base elevation that each block may stand on, NaN for none; (0,), not known, where a
    body stands on several, or in a tile on any."""
    if model.lacks_project is not None or not model.rock_inputs:
        return np.empty(0)
    bases = [np.nan if rock.base_elevation is None else rock.base_elevation for rock in model.project.rocks]
    oldest = np.cumsum([0, *(len(rock.surfaces) for rock in model.project.rocks)])
    is_cut = [entry.reaches_base or entry.rock.has_fields for entry in model.rock_inputs]
    elevations = []
    for block in model.blocks:
        rocks = [block.rock] if is_cut[block.rock] or block.surface == oldest[block.rock] else []
        if block.surface >= oldest[-1]:
            if not model.structures.times:
                return np.empty(0)
            rocks = model.structures.times[block.surface - oldest[-1] - len(model.structures.faults)]
        stands = {bases[rock] for rock in rocks} - {np.nan}
        if len(stands) > 1:
            return np.empty(0)
        elevations.append(min(stands, default=np.nan))
    return np.array(elevations, np.float64)


def _block_of_surface(model: ModelData) -> np.ndarray:
    """(S,) int32: the block beneath each surface; -1 beneath the oldest where there is no base."""
    of_surface = np.full(len(model.surface_names), -1, np.int32)
    for number, block in enumerate(model.blocks):
        of_surface[block.surface] = number
    return of_surface


def _test(entry: dict, model: ModelData) -> ValidationTest:
    """A test from the dictionary of the native module, in which -1 means no number."""
    number, says = _SAYS[entry["name"]]
    if not model.is_stack:
        says = _SAYS_OF_STRUCTURES.get(entry["name"], says)
    if model.cell_kind == "blocks":
        says = _SAYS_OF_BLOCKS.get(entry["name"], says)
    offenders = [
        Offender(
            text=offender["text"],
            place=offender["place"],
            **{
                key: offender[key] if offender[key] >= 0 else None
                for key in ("cell", "face", "vertex", "block")
            },
        )
        for offender in entry["offenders"]
    ]
    return ValidationTest(
        name=entry["name"],
        number=number,
        says=says,
        unit=entry["unit"],
        examined=entry["examined"],
        failed=entry["failed"],
        undecided=entry["undecided"],
        seconds=entry["seconds"],
        offenders=offenders,
    )
