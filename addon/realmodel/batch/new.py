# SPDX-License-Identifier: GPL-3.0-or-later
"""`realmodel new`: a folder with a project from data alone, built at once where outputs are named."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import PROGRAM
from .options import parse as parse_build

if TYPE_CHECKING:
    from ..core.proposal.proposal import ProposedProject

_TABLES = ("collars", "survey", "intervals", "picks")
_USAGE = f"""{PROGRAM} new FILE --out FOLDER [options]
       {PROGRAM} new --collars C.csv --intervals I.csv [--survey S.csv] [--picks P.csv] --out FOLDER [options]
       {PROGRAM} new --map GEOLOGY.gpkg --ground DEM.tif [--dips D.csv] --out FOLDER [options]"""


def parse(arguments: list[str]) -> argparse.Namespace:
    """The options of `new`; `build`: those of the build that follows, None for none. Raises SystemExit with
    status 2 where they are wrong."""
    parser = argparse.ArgumentParser(
        prog=f"{PROGRAM} new",
        usage=_USAGE,
        description="Proposes a project from data, ready to build: its file with the reason of each choice, "
        "the tables, and proposal.json. FILE has boreholes with all their tables. With options of a build, "
        "such as --export, the project is also built.",
        allow_abbrev=False,
    )
    for table in _TABLES:
        parser.add_argument(f"--{table}", type=Path, metavar="F", help=f"table of the {table} of boreholes")
    parser.add_argument("--block", metavar="NAME", help="column with the units, in tables of boreholes")
    parser.add_argument(
        "--column",
        metavar="MEANING=NAME",
        action="append",
        default=[],
        help="column of a table of boreholes that is called otherwise, such as z=ZCOORDB; may be repeated",
    )
    parser.add_argument(
        "--names", type=Path, metavar="F", help="table of two columns, code and unit: what codes mean"
    )
    parser.add_argument("--map", type=Path, metavar="F", help="polygons of units: a geological map")
    parser.add_argument("--map-layer", metavar="NAME", help="layer of the map")
    parser.add_argument(
        "--map-block", metavar="NAME", help="attribute with the units (default: detected by its name)"
    )
    parser.add_argument(
        "--ground", type=Path, metavar="F", help="elevations of the ground: raster, points or mesh"
    )
    parser.add_argument("--dips", type=Path, metavar="F", help="table of dips")
    parser.add_argument("--region", type=Path, metavar="F", help="outline (default: around the data)")
    parser.add_argument("--units", metavar="UNIT", default="m", help="unit of lengths (default: m)")
    parser.add_argument(
        "--crs", metavar="CODE", help="coordinate system, such as EPSG:25832 (default: from the files)"
    )
    parser.add_argument("--out", type=Path, metavar="FOLDER", required=True, help="a new folder")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    options, rest = parser.parse_known_args(arguments)
    is_file = rest and not rest[0].startswith("-")
    options.file = Path(rest.pop(0)) if is_file else None
    options.build = None
    if rest:
        quiet = ["--quiet"] if options.quiet else []
        options.build = parse_build([str(options.out / "project.toml"), *rest, *quiet])
    return options


def _column(text: str) -> tuple[str, str | int]:
    """(meaning, name or number) of --column. Raises UsageError."""
    from ..core import UsageError

    meaning, sign, name = text.partition("=")
    if not sign or not name.strip():
        raise UsageError(f"--column {text}: write it as --column z=ZCOORDB")
    return meaning.strip(), int(name) if name.strip().isdecimal() else name.strip()


def _proposed(**keys: Any) -> ProposedProject:
    """propose_project; what a refusal says to write in a project file it says as options. Raises
    RealModelError."""
    from ..core import InputRefused, propose_project

    try:
        return propose_project(**keys)
    except InputRefused as error:
        said = re.sub(r'columns = \{ (\w+) = "([^"]*)" \}', r'--column \1="\2"', error.advice or "")
        if said == (error.advice or ""):
            raise
        raise InputRefused(
            error.what, file=error.file, line=error.line, item=error.item, advice=said
        ) from error


def run(options: argparse.Namespace) -> None:
    """Writes the folder, and builds its project where outputs are named. Raises RealModelError."""
    from ..core import UsageError
    from ..core.proposal.folder import require_new
    from .run import run as run_build

    require_new(options.out)
    tables = {name: getattr(options, name) for name in _TABLES if getattr(options, name) is not None}
    if options.file is not None and tables:
        raise UsageError(f"{options.file} holds all tables; leave out --{next(iter(tables))}")
    map_keys = {"file": options.map, "layer": options.map_layer, "block": options.map_block}
    map_keys = {key: value for key, value in map_keys.items() if value is not None}
    if map_keys and options.map is None:
        raise UsageError("--map-layer and --map-block go with --map")
    boreholes = {"file": options.file} if options.file else tables
    columns = dict(_column(text) for text in options.column)
    columns |= {} if options.block is None else {"block": options.block}
    if columns:
        if not boreholes:
            raise UsageError("--block and --column go with boreholes")
        boreholes["columns"] = columns
    project = _proposed(
        boreholes=boreholes or None,
        map=map_keys or None,
        ground=options.ground,
        region=options.region,
        dips=options.dips,
        names=options.names,
        units=options.units,
        crs=options.crs,
        name=options.out.resolve().name,
    )
    path = project.save(options.out)
    if not options.quiet:
        for warning in project.proposal.warnings:
            print(f"warning: {warning}")
        print(f"units, oldest first: {', '.join(project.proposal.order)}")
        system = [*([project.crs] if project.crs else []), project.proposal.reasons["crs"]]
        print(f"coordinate system: {', '.join(system)}")
        print(f"{options.out}: {len(list(options.out.iterdir()))} files; build it: {PROGRAM} {path}")
    if options.build is not None:
        run_build(options.build)
