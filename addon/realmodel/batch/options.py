# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the command line."""

import argparse
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from . import IN_BLENDER, PROGRAM

_NEGATIVE = re.compile(r"-\.?\d")
_BLENDER_USAGE = "blender -b --factory-startup --python-exit-code 1 -P build_model.py -- PROJECT [options]"
_USAGE = (
    "realmodel PROJECT [options without --blend and --render]"
    if PROGRAM == "realmodel"
    else f"{_BLENDER_USAGE}\n       python3 build_model.py PROJECT [options without --blend and --render]"
)


def _length(text: str) -> float:
    return _number(text, lambda value: 0.0 < value < math.inf, "a length above 0")


def _correlation(text: str) -> float:
    return _number(text, lambda value: -1.0 <= value <= 1.0, "a number from -1 to 1")


def _gigabytes(text: str) -> int:
    return int(1e9 * _number(text, lambda value: 1e-9 <= value < 1e9, "a number of gigabytes above 0"))


def _factor(text: str) -> float:
    from ..core.results.sections.section_drawing import MOST_EXAGGERATION

    what = f"a number above 0, at most {MOST_EXAGGERATION:g}"
    return _number(text, lambda value: 0.0 < value <= MOST_EXAGGERATION, what)


def _paper(text: str) -> str:
    from ..core.results.sheets import SHEET_SIZES

    if text not in SHEET_SIZES:
        raise argparse.ArgumentTypeError(f"'{text}' is not one of {', '.join(SHEET_SIZES)}")
    return text


def _sizes(text: str) -> list[float]:
    words = text.split(",")
    if len(words) > 3:
        raise argparse.ArgumentTypeError(f"'{text}' is not one to three numbers above 0")
    return [_number(word, lambda value: 0.0 < value < 1e300, "a number above 0") for word in words]


def _place(text: str) -> list[float]:
    what = "three numbers"
    place = [_number(word, math.isfinite, what) for word in text.split(",")]
    if len(place) != 3:
        raise argparse.ArgumentTypeError(f"'{text}' is not {what}: X,Y,Z")
    return place


def _tile_size(text: str) -> list[float]:
    what = "two lengths above 0"
    sizes = [_number(word, lambda value: 0.0 < value < math.inf, what) for word in text.split(",")]
    if len(sizes) != 2:
        raise argparse.ArgumentTypeError(f"'{text}' is not {what}: W,H")
    return sizes


def _number(text: str, is_valid, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not is_valid(number):
        raise argparse.ArgumentTypeError(f"'{text}' is not {what}")
    return number


def _whole(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 0")
    return int(text)


def _layers(text: str) -> int:
    number = _whole(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of layers from 1")
    return number


def _angle(text: str) -> float:
    return _number(text, math.isfinite, "a number of degrees")


def _groups(text: str) -> int:
    number = _whole(text)
    if number < 2:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of groups from 2")
    return number


class _Parser(argparse.ArgumentParser):
    """Fills endings from the table of formats into the help, for which alone the table is imported."""

    def print_help(self, file=None):
        from ..core.exporters import BOREHOLE, JUXTAPOSITION, MESH, MODEL, SECTION, SHEETS

        exporters = {"model": MODEL, "section": SECTION, "mesh": MESH, "borehole": BOREHOLE, "sheet": SHEETS}
        exporters["drawing"] = JUXTAPOSITION
        endings = {name: [f.ending for f in exporter.formats()] for name, exporter in exporters.items()}
        for option in ("cell_size", "contour_interval", "tolerance", "origin", "grid_layers", "grid_azimuth"):
            endings[option] = MODEL.endings(option)
        texts = {name: ", ".join(listed) for name, listed in endings.items()}
        for action in self._actions:
            action.help = action.help.format(**texts)
        super().print_help(file)


class Option(NamedTuple):
    """An option of the command line. help: with names of `_Parser` instead of endings.

    value: how the help shows its value, or the values to choose from; "" where it has none. default: [] where
    it may be given several times. needs: it goes with one of these options only. ending: of its file.
    in_blender: whether it needs Blender (True) or plain Python (False). beside: the options that it goes
    with; None: any.
    """

    name: str
    value: str | tuple[str, ...]
    help: str
    read: Callable[[str], Any] = str
    default: Any = None
    needs: tuple[str, ...] = ()
    ending: str = ""
    in_blender: bool | None = None
    beside: tuple[str, ...] | None = None

    @property
    def attribute(self) -> str:
        """Its name in the parsed options."""
        return self.name.replace("-", "_")

    def add_to(self, parser: argparse.ArgumentParser) -> None:
        if not self.value:
            parser.add_argument(f"--{self.name}", action="store_true", help=self.help)
            return
        shown = "metavar" if isinstance(self.value, str) else "choices"
        parser.add_argument(
            f"--{self.name}",
            **{shown: self.value},
            action="append" if isinstance(self.default, list) else "store",
            type=self.read,
            default=self.default,
            help=self.help,
        )


_OF_DASK = ("ensemble", "tiles")
_MESH = ("mesh",)
_LINES = ("section", "fence", "borehole")
# A built model has them no more.
_OF_BUILDS = (*_OF_DASK, "cells", "device", "memory", "estimate", "surfaces-only")
MODEL_ENDING = ".npz"
OPTIONS = (
    Option("blend", "F", "write the scene to F.blend (in Blender)", Path, ending=".blend", in_blender=True),
    Option(
        "export",
        "F",
        "write the model to F in the format of its extension ({model}); may be repeated",
        Path,
        [],
    ),
    Option(
        "export-field",
        "F",
        "write the fields of series to F.vtu: the tetrahedra of their lattices, with the value at each node",
        Path,
        ending=".vtu",
    ),
    Option(
        "cell-size",
        "X[,Y[,Z]]",
        "size of the cells of regular grids by --export and --cut ({cell_size})",
        _sizes,
    ),
    Option(
        "grid-layers",
        "N",
        "layers of each block in corner-point grids by --export ({grid_layers}); default: 1",
        _layers,
        needs=("export",),
    ),
    Option(
        "grid-azimuth",
        "A",
        "direction of their columns, degrees clockwise from north ({grid_azimuth}); default: 0",
        _angle,
        needs=("export",),
    ),
    Option(
        "contour-interval",
        "H",
        "distance of contours in maps by --export and --cut ({contour_interval})",
        _length,
    ),
    Option(
        "cell-tolerance",
        "T",
        "clean the cells by --export and --cut ({tolerance}): remove details smaller than T",
        _length,
    ),
    Option(
        "origin",
        "X,Y,Z",
        "origin of the coordinates of shapes by --export ({origin}), for programs with 32-bit numbers",
        _place,
        needs=("export",),
    ),
    Option("report", "F", "write a report to F.json", Path, ending=".json"),
    Option("render", "F", "render a picture to F.png (in Blender)", Path, ending=".png", in_blender=True),
    Option(
        "section",
        "X,Y,Z,NX,NY,NZ=F",
        "write the section by a plane (point, normal) to F, a drawing or polygons ({section}); may be "
        "repeated",
        default=[],
    ),
    Option(
        "fence",
        "LINE=F",
        "write vertical sections along a line in plan to F: X,Y,X,Y,... or a text file of x and y",
        default=[],
    ),
    Option(
        "juxtaposition",
        "FAULT=F",
        "draw the blocks on both sides of a fault, and its throw, to F ({drawing}); may be repeated",
        default=[],
    ),
    Option(
        "stereonet",
        "[NAME=]F",
        "draw the dips of the project, or those of a surface, block, series, rock mass or fault, to F "
        "({drawing}), with their mean plane and fold axis; may be repeated",
        default=[],
    ),
    Option(
        "net",
        ("equal_area", "equal_angle"),
        "net of --stereonet: equal area (Schmidt, default) or equal angle (Wulff)",
        needs=("stereonet",),
    ),
    Option(
        "borehole",
        "X,Y=F",
        "write the blocks in a vertical borehole at a position in plan to F ({borehole}); "
        "X,Y,Z,AZIMUTH,DIP,LENGTH=F: the blocks in a planned hole, by depth along it",
        default=[],
    ),
    Option(
        "sheet",
        "F",
        "write the geological map and the sections by --section and --fence to F, sheets to print ({sheet})",
        Path,
    ),
    Option(
        "sheet-size",
        "SIZE",
        "paper of the sheets: A4 to A0 for landscape, A4-portrait to A0-portrait (default: A3)",
        _paper,
        needs=("sheet",),
    ),
    Option(
        "sheet-scale",
        "N",
        "scale 1 : N of the map and sections (default: the largest round scale at which they fit)",
        _length,
        needs=("sheet",),
    ),
    Option(
        "exaggeration",
        "X",
        "vertical exaggeration of drawings by --section, --fence, --juxtaposition and --sheet",
        _factor,
        1.0,
        needs=("section", "fence", "juxtaposition"),
    ),
    Option(
        "hole-width",
        "W",
        "draw the boreholes of the project within this distance on drawings by --section, --fence and "
        "--sheet",
        _length,
        0.0,
        needs=("section", "fence"),
    ),
    Option(
        "hole-column",
        "NAME",
        "draw a curve of the logs of the boreholes beside them, such as GR",
        needs=("hole-width",),
    ),
    Option(
        "cut",
        "CUTTER=BELOW,ABOVE",
        "cut the model by a plane X,Y,Z,NX,NY,NZ, a file of a surface, or a block PROJECT.toml:BLOCK, "
        "MODEL.npz:BLOCK or :BLOCK (of this model), and write the halves as --export does; one file may be "
        "omitted",
        default=[],
    ),
    Option(
        "mesh",
        "FILE",
        "write a mesh for simulation to FILE in the format of its extension ({mesh}); may be repeated",
        Path,
        [],
    ),
    Option(
        "mesh-edge", "L", "edge length of the mesh in plan (default: 1/50 of the model)", _length, needs=_MESH
    ),
    Option(
        "mesh-thickness",
        "T",
        "minimum thickness: layers end where they are thinner (default: 1/10 of the edge length)",
        _length,
        needs=_MESH,
    ),
    Option("mesh-layers", "N", "divide each block into N layers", _whole, needs=_MESH),
    Option(
        "mesh-layer-thickness",
        "H",
        "divide blocks into layers of thickness H or less (with --mesh-layers: at most N layers)",
        _length,
        needs=_MESH,
    ),
    Option(
        "mesh-elements",
        ("prisms", "tetrahedra"),
        "prisms, with pyramids and tetrahedra where layers end (default), or tetrahedra only, as required "
        "for models with bodies or inclined faults and for halves of cuts",
        needs=_MESH,
    ),
    Option(
        "ensemble",
        "N",
        "build N realizations with Dask and write their volumes to the folder --out; "
        "--section, --fence, --borehole, and --export (a grid) write the probability of each block",
        _whole,
        in_blender=False,
        beside=("out", "scheduler", "seed", "correlation", *_LINES, "export", "cell-size", "exaggeration"),
    ),
    Option(
        "tiles",
        "W,H",
        "build the model with Dask in tiles of this width and height, and write it to the folder --out",
        _tile_size,
        in_blender=False,
        beside=("out", "scheduler", "cells", "export-field"),
    ),
    Option("out", "FOLDER", "folder of --ensemble or --tiles", Path, needs=_OF_DASK),
    Option("seed", "S", "seed of the random numbers (default: 0)", _whole, needs=("ensemble",)),
    Option(
        "correlation",
        "C",
        "correlation of the errors of each surface and the next older one, -1 to 1 (default: 0)",
        _correlation,
        needs=("ensemble",),
    ),
    Option(
        "scheduler",
        "ADDRESS",
        "address of a running Dask scheduler (default: all processors of this machine)",
        needs=_OF_DASK,
    ),
    Option("stage", "M", "build only the surfaces up to M, counted from 0", _whole),
    Option(
        "cells",
        ("columns", "blocks"),
        "one cell for each facet (default), or one cell for each connected component of a block",
    ),
    Option("threads", "N", "number of threads; 0 (default): all", _whole, 0),
    Option(
        "device",
        ("cpu", "cuda"),
        "what helps the build: nothing (default), or a GPU, by the module _native_cuda; the same bytes",
        default="cpu",
    ),
    Option(
        "memory",
        "GB",
        "memory limit of the build (default: the free memory); a build that needs more is refused",
        _gigabytes,
    ),
    Option(
        "estimate",
        "",
        "print the expected cells, memory and time, and build nothing",
        beside=(
            *("stage", "cells", "threads", "memory", "eroded", "check-model"),
            *("cell-size", "contour-interval"),
        ),
    ),
    Option(
        "surfaces-only",
        "",
        "stop after the interpolation: --export writes the surfaces with elevation, variance and distance",
        beside=("export", "report", "stage", "cells", "threads", "device", "cell-size", "contour-interval"),
    ),
    Option(
        "eroded",
        "",
        "add to the table and the report how much of each block each surface and each body removed",
    ),
    Option(
        "cross-validate",
        "N",
        "cross-validation by boreholes in N groups: print how well models without a group predict it; "
        "--report lists each hole",
        _groups,
    ),
    Option("check-model", "", "validate the model before anything is written, and print the result"),
    Option("quiet", "", "print nothing but errors"),
)


def parse(arguments: list[str]) -> argparse.Namespace:
    """Raises SystemExit with status 2 where they are wrong."""
    parser = _Parser(
        prog=PROGRAM,
        usage=_USAGE,
        description="Builds a model of sedimentary rock from a project file.",
    )
    parser.add_argument(
        "project",
        metavar="PROJECT",
        type=Path,
        help="project file (.toml), or a model built before (.npz)",
    )
    for option in OPTIONS:
        option.add_to(parser)
    options = parser.parse_args(_with_negative_values(arguments))
    values = {option.name: getattr(options, option.attribute) for option in OPTIONS}
    chosen = [option for option in OPTIONS if values[option.name] != parser.get_default(option.attribute)]
    for option in sorted(chosen, key=lambda option: not option.needs):  # what is missing is said first
        if problem := _conflict(option, values[option.name], {other.name for other in chosen}):
            parser.error(f"--{option.name} {problem}")
        if option.name in _OF_BUILDS and options.project.suffix.lower() == MODEL_ENDING:
            parser.error(f"--{option.name} goes with a project file; {options.project} is a built model")
    options.cells = options.cells or "columns"
    return options


def _with_negative_values(arguments: list[str]) -> list[str]:
    """The arguments, a value that begins with a negative number joined to its option: alone argparse takes it
    for an option."""
    words: list[str] = []
    for argument in arguments:
        if _NEGATIVE.match(argument) and words and words[-1].startswith("--") and "=" not in words[-1]:
            words[-1] += f"={argument}"
        else:
            words.append(argument)
    return words


def _conflict(option: Option, value: Any, chosen: set[str]) -> str:
    """What is wrong with an option of this value beside the other chosen ones, or ""."""
    if option.ending and value.suffix.lower() != option.ending:
        return f"writes {option.ending} files, not {value}"
    if option.in_blender is not None and option.in_blender != IN_BLENDER:
        where = (
            ("plain Python", "python3 build_model.py PROJECT ...")
            if IN_BLENDER
            else ("Blender", _BLENDER_USAGE)
        )
        return f"needs {where[0]}; run it as: {where[1]}"
    if option.needs and chosen.isdisjoint(option.needs):
        return f"goes with {' or '.join(f'--{name}' for name in option.needs)}"
    if option.name in _OF_DASK and "out" not in chosen:
        return "needs --out FOLDER"
    if option.beside is not None and (others := chosen - {option.name, "quiet", *option.beside}):
        return f"goes without {', '.join(f'--{name}' for name in sorted(others))}"
    return ""
