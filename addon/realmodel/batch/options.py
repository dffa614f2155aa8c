# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of build_model.py."""

import argparse
import math
import re
from pathlib import Path

from . import IN_BLENDER

_NEGATIVE = re.compile(r"-\.?\d")
_BLENDER_USAGE = "blender -b --factory-startup --python-exit-code 1 -P build_model.py -- PROJECT [options]"


def parse(arguments: list[str]) -> argparse.Namespace:
    """Raises SystemExit with status 2 where they are wrong."""
    parser = argparse.ArgumentParser(
        prog="build_model.py",
        usage=(
            f"{_BLENDER_USAGE}\n       python3 build_model.py PROJECT [options without --blend and --render]"
        ),
        description="Builds a model of sedimentary rock from a project file.",
    )
    parser.add_argument("project", metavar="PROJECT", type=Path, help="project file (.toml)")
    parser.add_argument("--blend", metavar="F", type=Path, help="write the scene to F.blend (in Blender)")
    parser.add_argument(
        "--export",
        metavar="F",
        type=Path,
        action="append",
        default=[],
        help="write the model to F, whose ending says the format; may be given several times",
    )
    parser.add_argument(
        "--cell-size",
        metavar="X[,Y[,Z]]",
        type=_sizes,
        help="the cells of regular grids by --export and --cut (.csv, .vti, .tif, .asc)",
    )
    parser.add_argument(
        "--contour-interval",
        metavar="H",
        type=_length,
        help="the distance of contours in maps by --export and --cut (.gpkg, .geojson)",
    )
    parser.add_argument(
        "--cell-tolerance",
        metavar="T",
        type=_length,
        help="clean the cells by --export and --cut (.vtu, .foam, .exo, .disu): T is the least size",
    )
    parser.add_argument("--report", metavar="F", type=Path, help="write a report to F.json")
    parser.add_argument("--render", metavar="F", type=Path, help="render a picture to F.png (in Blender)")
    parser.add_argument(
        "--section",
        metavar="X,Y,Z,NX,NY,NZ=F",
        action="append",
        default=[],
        help=(
            "write the section by a plane (point, normal) to F, a drawing (.svg, .dxf, .png) or polygons "
            "(.vtu, .obj, .ply, .stl, .glb, .ts, .csv, .npz); any number of times"
        ),
    )
    parser.add_argument(
        "--fence",
        metavar="LINE=F",
        action="append",
        default=[],
        help="write vertical sections along a line in plan to F: X,Y,X,Y,... or a text file of x and y",
    )
    parser.add_argument(
        "--borehole",
        metavar="X,Y=F",
        action="append",
        default=[],
        help="write what a vertical borehole at a position in plan meets to F (.csv)",
    )
    parser.add_argument(
        "--exaggeration",
        metavar="X",
        type=_factor,
        default=1.0,
        help="exaggerate the heights of drawings by --section and --fence X times",
    )
    parser.add_argument(
        "--cut",
        metavar="CUTTER=BELOW,ABOVE",
        action="append",
        default=[],
        help=(
            "cut the model by a plane X,Y,Z,NX,NY,NZ, a file of a surface, or a block PROJECT.toml:BLOCK "
            "(:BLOCK of the model itself) and write its halves as --export does; one may be left out"
        ),
    )
    parser.add_argument(
        "--mesh",
        metavar="FILE",
        type=Path,
        help="write a mesh for simulation to FILE, whose ending says the format (.foam, .vtu, .msh, ...)",
    )
    parser.add_argument(
        "--mesh-edge",
        metavar="L",
        type=_length,
        help="its edge length in plan (default: 1/50 of the model)",
    )
    parser.add_argument(
        "--mesh-thickness",
        metavar="T",
        type=_length,
        help="layers end where they are thinner (default: 1/10 of the edge length)",
    )
    parser.add_argument("--mesh-layers", metavar="N", type=_whole, help="divide each block into N layers")
    parser.add_argument(
        "--mesh-layer-thickness",
        metavar="H",
        type=_length,
        help="divide blocks into layers no thicker than H (with --mesh-layers: into N at most)",
    )
    parser.add_argument(
        "--mesh-elements",
        choices=("prisms", "tetrahedra"),
        help="prisms, with pyramids and tetrahedra where layers end (default), or tetrahedra alone, which "
        "models with bodies and inclined faults and halves of cuts need",
    )
    parser.add_argument(
        "--ensemble",
        metavar="N",
        type=_whole,
        help="build N realizations on several processes by Dask and write their volumes to the folder --out; "
        "--section, --fence, --borehole, and --export (a grid) write the probability of each block",
    )
    parser.add_argument(
        "--tiles",
        metavar="W,H",
        type=_tile_size,
        help="build the model in tiles of this width and height by Dask, and write it to the folder --out",
    )
    parser.add_argument("--out", metavar="FOLDER", type=Path, help="the folder of --ensemble or --tiles")
    parser.add_argument("--seed", metavar="S", type=_whole, help="of the random numbers (default: 0)")
    parser.add_argument(
        "--correlation",
        metavar="C",
        type=_correlation,
        help="of the errors of each surface with those of the next older one, -1 to 1 (default: 0)",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a running scheduler of Dask (default: the processors of this machine)",
    )
    parser.add_argument("--stage", metavar="M", type=_whole, help="only up to surface M, counted from 0")
    parser.add_argument(
        "--cells",
        choices=("columns", "blocks"),
        default="columns",
        help="columns under facets (default), or one cell for each connected part of a block",
    )
    parser.add_argument(
        "--threads", metavar="N", type=_whole, default=0, help="0 (default): all that there are"
    )
    parser.add_argument(
        "--memory",
        metavar="GB",
        type=_gigabytes,
        help="what building may take (default: what is free); what would take more is refused at once",
    )
    parser.add_argument(
        "--estimate",
        action="store_true",
        help="print the expected cells, memory and time, and build nothing",
    )
    parser.add_argument(
        "--surfaces-only",
        action="store_true",
        help="stop after the heights: --export then writes the surfaces with height, variance and distance",
    )
    parser.add_argument(
        "--eroded",
        action="store_true",
        help="add the volume that each surface removed and each body took of each block to table and report",
    )
    parser.add_argument(
        "--check-model",
        action="store_true",
        help="prove the model before anything is written, and print the proof",
    )
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    options = parser.parse_args(_with_negative_values(arguments))
    _check(parser, options)
    return options


def _with_negative_values(arguments: list[str]) -> list[str]:
    """The arguments, a value that begins with a negative number joined to its option: alone argparse takes it
    for an option."""
    found: list[str] = []
    for argument in arguments:
        if _NEGATIVE.match(argument) and found and found[-1].startswith("--") and "=" not in found[-1]:
            found[-1] += f"={argument}"
        else:
            found.append(argument)
    return found


def _check(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Checks combinations of options. Exits with status 2 and one line."""
    for name, ending in (("blend", ".blend"), ("report", ".json"), ("render", ".png")):
        path = getattr(options, name)
        if path is not None and path.suffix.lower() != ending:
            parser.error(f"--{name} writes {ending} files, not {path}")
    for name in ("blend", "render"):
        if getattr(options, name) is not None and not IN_BLENDER:
            parser.error(f"--{name} needs Blender; run it as: {_BLENDER_USAGE}")
    if options.surfaces_only:
        for name in (
            "blend",
            "render",
            "estimate",
            "eroded",
            "check_model",
            "memory",
            "section",
            "fence",
            "borehole",
            "cut",
            "mesh",
            "cell_tolerance",
        ):
            if getattr(options, name):
                parser.error(f"--surfaces-only goes without --{name.replace('_', '-')}")
    if options.exaggeration != 1.0 and not options.section and not options.fence:
        parser.error("--exaggeration is of drawings: it goes with --section or --fence")
    outputs = (
        *("--blend", "--export", "--report", "--render"),
        *("--section", "--fence", "--borehole", "--cut", "--mesh"),
    )
    if options.estimate and any(getattr(options, name[2:]) for name in outputs):
        parser.error(f"--estimate builds nothing: it goes without {', '.join(outputs)}")
    _check_dask(parser, options)
    of_mesh = ("edge", "thickness", "layers", "layer_thickness", "elements")
    for name in of_mesh:
        if getattr(options, f"mesh_{name}") is not None and options.mesh is None:
            parser.error(f"--mesh-{name.replace('_', '-')} goes with --mesh")


_OF_DASK = {
    "ensemble": (
        *("out", "scheduler", "seed", "correlation"),
        *("section", "fence", "borehole", "export", "cell_size", "exaggeration"),
    ),
    "tiles": ("out", "scheduler", "cells"),
}


def _check_dask(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """The options of what Dask does, --ensemble and --tiles."""
    asked = [name for name in _OF_DASK if getattr(options, name) is not None]
    for name in ("out", "scheduler", "seed", "correlation"):
        takes = [f"--{option}" for option, names in _OF_DASK.items() if name in names]
        if getattr(options, name) is not None and not any(f"--{option}" in takes for option in asked):
            parser.error(f"--{name} goes with {' or '.join(takes)}")
    for name in asked:
        if options.out is None:
            parser.error(f"--{name} needs --out FOLDER")
        if IN_BLENDER:
            parser.error(f"--{name} needs plain Python; run it as: python3 build_model.py PROJECT ...")
        if others := _set_beside(parser, options, {name, *_OF_DASK[name], "quiet"}):
            parser.error(f"--{name} goes without {', '.join(others)}")


def _set_beside(parser: argparse.ArgumentParser, options: argparse.Namespace, names: set[str]) -> list[str]:
    """The options that were given beside those of these names."""
    return [
        f"--{name.replace('_', '-')}"
        for name, value in vars(options).items()
        if name not in {"project", *names} and value != parser.get_default(name)
    ]


def _length(text: str) -> float:
    return _number(text, lambda value: 0.0 < value < math.inf, "a length above 0")


def _correlation(text: str) -> float:
    return _number(text, lambda value: -1.0 <= value <= 1.0, "a number from -1 to 1")


def _gigabytes(text: str) -> int:
    return int(1e9 * _number(text, lambda value: 1e-9 <= value < 1e9, "a number of gigabytes above 0"))


def _factor(text: str) -> float:
    from ..core.results.section_drawing import MOST_EXAGGERATION

    what = f"a number above 0, at most {MOST_EXAGGERATION:g}"
    return _number(text, lambda value: 0.0 < value <= MOST_EXAGGERATION, what)


def _sizes(text: str) -> list[float]:
    words = text.split(",")
    if len(words) > 3:
        raise argparse.ArgumentTypeError(f"'{text}' is not one to three numbers above 0")
    return [_number(word, lambda value: 0.0 < value < 1e300, "a number above 0") for word in words]


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
