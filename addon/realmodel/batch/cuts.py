# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts, sections, fences, sheets of them and boreholes of the command line: WHAT=FILE."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..core.base.errors import InputRefused, UsageError, counted
from ..core.base.text import read_text
from ..core.exporters import (
    BOREHOLE,
    JUXTAPOSITION,
    MODEL,
    PLANNED_HOLE,
    SECTION,
    SHEETS,
    STEREONET,
    Exporter,
)
from ..core.exporters.mesh_request import cleaned_line
from ..core.model.cutting import Section
from ..core.readers import read_mesh
from ..core.readers.formats import MESH, endings
from ..core.results.model_holes import HoleAxis, HoleInterval, Interval
from ..core.results.sheets import draw_sheets
from ..core.settings.data_files import MeshFile
from .sources import ENDINGS, OpenedFile


class _Request:
    """What is made of a model and written to one file."""

    file: Path

    @property
    def outputs(self) -> list[Path]:
        return [self.file]

    @property
    def inputs(self) -> list[Path]:
        return []

    def read(self) -> None:
        pass


@dataclass
class SectionRequest(_Request):
    """A section by a plane, or a fence, and its file. what: point and normal (6,), or a polyline (N, 2).
    exaggeration, hole_width, hole_column: of drawings, as of Section.save. exporter: writes the file."""

    option: str
    file: Path
    what: np.ndarray | Path
    exporter: Exporter = SECTION
    exaggeration: float = 1.0
    hole_width: float = 0.0
    hole_column: str | None = None
    made: Section | None = None

    @property
    def inputs(self) -> list[Path]:
        return [self.what] if isinstance(self.what, Path) else []

    def read(self) -> None:
        """Reads the polyline, where it is a file. Raises InputRefused."""
        if isinstance(self.what, Path):
            self.what = read_polyline(self.what)

    def cut(self, model, threads: int = 0) -> Section:
        """The section of a model, which is made once."""
        if self.made is None:
            self.made = (
                model.fence(self.what, threads=threads)
                if self.option == "--fence"
                else model.section(self.what[:3], self.what[3:], threads=threads)
            )
        return self.made

    def run(self, model, outputs, threads: int, progress) -> str:
        """Makes the section and stages its file. Returns the summary for the terminal."""
        progress(1.0, f"cutting {self.file.name}")
        section = self.cut(model, threads)
        names = ("exaggeration", "hole_width", "hole_column")
        drawn = {name: getattr(self, name) for name in names}
        self.exporter.write(section, self.file, outputs, **drawn)
        kind = self.option.removeprefix("--")
        return f"{kind} {self.file.name}: {len(section)} polygons, area {section.area:.2f}"


@dataclass
class SheetRequest(_Request):
    """Sheets to print, and their file. size, scale: as of draw_sheets. sections: what they show beside the
    map; the first has the settings of the drawing."""

    file: Path
    size: str
    scale: float | None
    sections: list[SectionRequest]
    exporter = SHEETS

    def run(self, model, outputs, threads: int, progress) -> str:
        """Draws the sheets and stages their file. Returns the summary for the terminal."""
        progress(1.0, f"drawing {self.file.name}")
        sections = [request.cut(model, threads) for request in self.sections]
        first = self.sections[0] if self.sections else None
        drawn = () if first is None else (first.exaggeration, first.hole_width, first.hole_column)
        sheets = draw_sheets(model, sections, self.size, self.scale, *drawn)
        self.exporter.write(sheets, self.file, outputs)
        return f"{self.file.name}: {counted(len(sheets), 'sheet')} on {self.size}"


@dataclass
class JuxtapositionRequest(_Request):
    """The juxtaposition diagram of a fault, by its name, and its file. exaggeration: of elevations."""

    file: Path
    fault: str
    exaggeration: float = 1.0
    exporter = JUXTAPOSITION

    def run(self, model, outputs, _threads: int, progress) -> str:
        """Stages the file. Returns the areas for the terminal."""
        progress(1.0, f"writing {self.file.name}")
        sides = model.juxtaposition(self.fault)
        self.exporter.write(sides, self.file, outputs, exaggeration=self.exaggeration)
        head = f"juxtaposition {self.file.name}: fault '{self.fault}', area {sides.area:.2f}"
        pairs = (
            f"{low or 'no rock'} against {high or 'no rock'}: {area:.2f}"
            for (low, high), area in sides.areas.items()
        )
        return "\n  ".join([head, *pairs])


@dataclass
class StereonetRequest(_Request):
    """The stereonet of the dips of the project, or of those of the surface, block, series, rock mass or fault
    `of`, and its file. net: as of Stereonet.save."""

    file: Path
    of: str | None
    net: str = "equal_area"
    exporter = STEREONET

    def run(self, model, outputs, _threads: int, progress) -> str:
        """Stages the file. Returns the numbers for the terminal."""
        progress(1.0, f"writing {self.file.name}")
        dips = model.stereonet(self.of)
        self.exporter.write(dips, self.file, outputs, net=self.net)
        return "\n  ".join([f"stereonet {self.file.name}: {dips.name}", *dips.lines()])


@dataclass
class BoreholeRequest(_Request):
    """A borehole and its file. what: where it is planned, or the position in plan of one that goes straight
    down through the whole model. exporter: writes the file."""

    file: Path
    what: HoleAxis | tuple[float, float]
    exporter: Exporter

    def run(self, model, outputs, _threads: int, progress) -> str:
        """Stages the file. Returns the summary of the borehole for the terminal."""
        progress(1.0, f"writing {self.file.name}")
        intervals: Sequence[HoleInterval | Interval]
        remarks: Sequence[str] = ()
        if isinstance(self.what, HoleAxis):
            axis = self.what
            hole = model.planned_hole(axis.collar, axis.azimuth, axis.dip, axis.length)
            self.exporter.write(hole, self.file, outputs)
            intervals, remarks = hole.intervals, hole.remarks
        else:
            intervals = model.borehole(*self.what)
            self.exporter.write((model, intervals), self.file, outputs)
        length = sum(interval.length for interval in intervals)
        line = f"borehole {self.file.name}: {counted(len(intervals), 'interval')}, {length:.2f} of rock"
        return "\n  ".join([line, *remarks])


@dataclass
class CutRequest:
    """A cut and the files of its halves; one of them may be left out.

    cell_size, contour_interval, tolerance: as of Model.save.
    cutter: point and normal of a plane (6,), the file of a surface, or (file of a project or model, or None
    for the model itself, block).
    """

    cutter: np.ndarray | Path | tuple[Path | None, str]
    below: Path | None
    above: Path | None
    cell_size: Sequence[float] | None = None
    contour_interval: float | None = None
    tolerance: float | None = None
    exporter = MODEL

    @property
    def outputs(self) -> list[Path]:
        return [path for path in (self.below, self.above) if path is not None]

    @property
    def inputs(self) -> list[Path]:
        if isinstance(self.cutter, Path):
            return [self.cutter]
        if isinstance(self.cutter, tuple) and self.cutter[0] is not None:
            return OpenedFile.of(self.cutter[0]).inputs
        return []

    def read(self) -> None:
        """Reads the surface and builds the other model, if any. Raises their errors."""
        if isinstance(self.cutter, Path):
            self._mesh = read_mesh(self.cutter)
        elif isinstance(self.cutter, tuple) and self.cutter[0] is not None:
            self._other = OpenedFile.of(self.cutter[0]).model(cells="blocks")

    def run(self, model, outputs, threads: int, progress) -> str:
        """Cuts, and stages the halves for writing. Returns the summary for the terminal."""
        names = ", ".join(path.name for path in self.outputs)

        def step(_share, _text):
            progress(1.0, f"cutting {names}")

        lines = []
        if isinstance(self.cutter, np.ndarray):
            cut = model.cut_by_plane(self.cutter[:3], self.cutter[3:], threads=threads, progress=step)
            text = "by the plane"
        elif isinstance(self.cutter, Path):
            vertices, warnings = self._mesh.in_model(MeshFile(self.cutter), model.project.units)
            lines += [f"warning: {warning}" for warning in warnings]
            try:
                cut = model.cut_by_surface(vertices, self._mesh.triangles, threads=threads, progress=step)
            except InputRefused as error:
                raise InputRefused(f"{self.cutter}: {error}") from error
            text = f"by {self.cutter.name}"
        else:
            other = model if self.cutter[0] is None else self._other
            block = self.cutter[1]
            cut = model.cut_by_block(
                other, int(block) if block.isdecimal() else block, threads=threads, progress=step
            )
            text = f"by block '{block}'"
        for half, path in ((cut.below, self.below), (cut.above, self.above)):
            if path is None:
                continue
            cells = None
            if self.tolerance is not None and path.suffix.lower() in MODEL.endings("tolerance"):
                progress(1.0, f"cleaning cells of {path.name}")
                cells = half.cleaned_cells(self.tolerance, threads=threads, progress=step)
                lines.append(f"{path.name}: {cleaned_line(cells)}")
            sizes = {"cell_size": self.cell_size, "contour_interval": self.contour_interval}
            MODEL.write(half, path, outputs, **sizes, cells=cells)
        low, high = ("inside", "outside") if isinstance(self.cutter, tuple) else ("below", "above")
        line = f"cut {text}: volume {cut.below.volume:.2f} {low}, {cut.above.volume:.2f} {high}"
        return "\n".join([line, *lines])


def section_request(text: str, exporter: Exporter = SECTION) -> SectionRequest:
    """X,Y,Z,NX,NY,NZ=FILE. Raises UsageError."""
    what, file = _divided("--section", text, "X,Y,Z,NX,NY,NZ=FILE")
    exporter.format(file)
    return SectionRequest("--section", Path(file), _plane("--section", what), exporter)


def fence_request(text: str, exporter: Exporter = SECTION) -> SectionRequest:
    """X,Y,X,Y,...=FILE or LINE.csv=FILE. Raises UsageError."""
    what, file = _divided("--fence", text, "X,Y,X,Y,...=FILE or LINE.csv=FILE")
    exporter.format(file)
    numbers = _numbers(what)
    if numbers is None:
        return SectionRequest("--fence", Path(file), Path(what), exporter)
    if len(numbers) < 4 or len(numbers) % 2:
        raise UsageError(f"--fence {text}: a line needs at least two points, x and y of each")
    line = _line(numbers.reshape(-1, 2), f"--fence {text}", UsageError)
    return SectionRequest("--fence", Path(file), line, exporter)


def juxtaposition_request(text: str) -> JuxtapositionRequest:
    """FAULT=FILE. Raises UsageError."""
    fault, file = _divided("--juxtaposition", text, "FAULT=FILE")
    JUXTAPOSITION.format(file)
    return JuxtapositionRequest(Path(file), fault)


def stereonet_request(text: str) -> StereonetRequest:
    """FILE or NAME=FILE. Raises UsageError."""
    of, file = _divided("--stereonet", text, "NAME=FILE") if "=" in text else (None, text)
    STEREONET.format(file)
    return StereonetRequest(Path(file), of)


def borehole_request(text: str, exporter: Exporter | None = None) -> BoreholeRequest:
    """X,Y=FILE or X,Y,Z,AZIMUTH,DIP,LENGTH=FILE. exporter: None: that of the model's holes. Raises
    UsageError."""
    what, file = _divided("--borehole", text, "X,Y=FILE or X,Y,Z,AZIMUTH,DIP,LENGTH=FILE")
    numbers = _numbers(what)
    if exporter is None:
        exporter = BOREHOLE if numbers is not None and len(numbers) == 2 else PLANNED_HOLE
    exporter.format(file)
    if numbers is None or len(numbers) not in (2, 6):
        raise UsageError(
            f"--borehole {text}: a position in plan is two numbers, X,Y, and a planned hole six, "
            "X,Y,Z,AZIMUTH,DIP,LENGTH"
        )
    if len(numbers) == 2:
        return BoreholeRequest(Path(file), tuple(numbers.tolist()), exporter)
    try:
        axis = HoleAxis(tuple(numbers[:3].tolist()), *numbers[3:].tolist())
        return BoreholeRequest(Path(file), axis, exporter)
    except UsageError as error:
        raise UsageError(f"--borehole {text}: {error}") from error


def cut_request(text: str) -> CutRequest:
    """CUTTER=BELOW,ABOVE: a plane X,Y,Z,NX,NY,NZ, a file of a surface, a block PROJECT.toml:BLOCK,
    MODEL.npz:BLOCK or :BLOCK. Raises UsageError."""
    form = "CUTTER=BELOW,ABOVE (one of them may be left out)"
    what, files = _divided("--cut", text, form)
    halves = files.split(",")
    if len(halves) > 2 or not any(halves):
        raise UsageError(f"--cut {text}: expected {form}")
    below, above = (Path(half) if half else None for half in (*halves, "")[:2])
    for path in (below, above):
        if path is not None:
            MODEL.format(path)
    if _numbers(what) is not None:
        return CutRequest(_plane("--cut", what), below, above)
    project, colon, block = what.rpartition(":")
    if colon and (not project or Path(project).suffix.lower() in ENDINGS):
        if not block:
            raise UsageError(f"--cut {text}: the block is missing; write {what}NAME")
        return CutRequest((Path(project) if project else None, block), below, above)
    if Path(what).suffix.lower() not in endings(MESH) and not Path(what).is_file():
        raise UsageError(
            f"--cut {text}: '{what}' is not a cutter; use a plane X,Y,Z,NX,NY,NZ, a surface "
            f"FILE{' or FILE'.join(endings(MESH))}, or a block PROJECT.toml:BLOCK or "
            "MODEL.npz:BLOCK (:BLOCK for one of the model's own)"
        )
    return CutRequest(Path(what), below, above)


def read_polyline(file: Path) -> np.ndarray:
    """(N, 2) float64 of a text file: x and y in each line, by commas, semicolons or spaces. A first line of
    names, empty lines and what follows # are passed over. Raises InputRefused naming file and line."""
    places = []
    for number, line in enumerate(read_text(file).splitlines(), 1):
        entries = [entry for entry in re.split(r"[,;\s]+", line.partition("#")[0].strip()) if entry]
        if not entries:
            continue
        numbers = _numbers(",".join(entries))
        if numbers is None and not places:
            continue  # names of columns
        if numbers is None or len(numbers) < 2:
            raise InputRefused(f"{file}:{number}: each line must have two numbers, x and y")
        places.append(numbers[:2])
    if len(places) < 2:
        raise InputRefused(f"{file}: a polyline needs at least two points, x and y on each line")
    return _line(np.array(places), str(file), InputRefused)


def _line(places: np.ndarray, where: str, error: type[Exception]) -> np.ndarray:
    if not np.diff(places, axis=0).any(axis=1).all():
        raise error(f"{where}: two consecutive points are equal; remove one")
    return places


def _divided(option: str, text: str, form: str) -> tuple[str, str]:
    what, equals, file = text.rpartition("=")
    if not equals or not what or not file:
        raise UsageError(f"{option} {text}: expected {option} {form}")
    return what, file


def _numbers(text: str) -> np.ndarray | None:
    """Finite numbers with commas between them; None where the text is something else."""
    try:
        numbers = np.array([float(entry) for entry in text.split(",")])
    except ValueError:
        return None
    return numbers if np.isfinite(numbers).all() else None


def _plane(option: str, text: str) -> np.ndarray:
    numbers = _numbers(text)
    if numbers is None or len(numbers) != 6:
        raise UsageError(f"{option} {text}: a plane is six numbers, a point and a normal: X,Y,Z,NX,NY,NZ")
    if not numbers[3:].any():
        raise UsageError(f"{option} {text}: the normal must not be zero")
    return numbers
