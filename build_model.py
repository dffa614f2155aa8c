#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a model from a project file, without a window.

    blender -b --factory-startup --python-exit-code 1 -P build_model.py -- PROJECT [options]
    python3 build_model.py PROJECT [options]            (then without --blend and --render)

Exit status: 0 done, 1 the input was refused or the build failed (one line on standard error),
2 wrong usage, 130 interrupted. Files appear whole or not at all.
"""

import argparse
import contextlib
import os
import signal
import sys
import threading
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "addon"))

IN_BLENDER = "bpy" in sys.modules
DONE, REFUSED, USAGE, TERMINATED, INTERRUPTED = 0, 1, 2, 143, 130
_BLENDER_USAGE = "blender -b --factory-startup --python-exit-code 1 -P build_model.py -- PROJECT [options]"
_SECONDS_TO_UNWIND = 1.0


def main(arguments: list[str]) -> int:
    """Runs the command line and returns the exit status."""
    signal.signal(signal.SIGTERM, _terminate)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal that lacks a letter of a name stops no build
    if hasattr(signal, "SIGXFSZ"):
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing too much becomes an error that is told
    try:
        options = _parse(arguments)
    except SystemExit as leaving:
        return leaving.code or DONE
    try:
        from realmodel.core import RealModelError, UsageError
    except ImportError as error:
        return _say(_not_importable(error), REFUSED)
    try:
        _run(options)
    except UsageError as error:
        return _say(str(error), USAGE)
    except RealModelError as error:
        return _say(str(error), REFUSED)
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - nobody listens any more
        return _say("nobody reads the standard output any more: nothing was written; use --quiet", REFUSED)
    except MemoryError:
        return _say("not enough memory for this model; use fewer triangles or a longer edge length", REFUSED)
    return DONE


def _not_importable(error: ImportError) -> str:
    version = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    if IN_BLENDER:
        return (
            f"Blender's {version} cannot run this: {error}; it looks for modules under {sys.prefix}, of the "
            "python3 that comes first on PATH: install NumPy there, or start Blender with another PATH"
        )
    return f"{version} cannot run this: {error}; it takes Python 3.11 or newer with NumPy"


def _say(line: str, status: int) -> int:
    print(f"build_model.py: {line}", file=sys.stderr, flush=True)
    return status


def _terminate(_number, _frame) -> None:
    raise SystemExit(TERMINATED)


def _parse(arguments: list[str]) -> argparse.Namespace:
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
        help="the cells of regular grids by --export (.csv, .vti, .tif, .asc)",
    )
    parser.add_argument(
        "--contour-interval",
        metavar="H",
        type=_length,
        help="the distance of contours in maps by --export (.gpkg, .geojson)",
    )
    parser.add_argument(
        "--cell-tolerance",
        metavar="T",
        type=_length,
        help="clean the model's cells by --export (.vtu, .foam, .exo, .disu): T is the least size",
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
        help="tell cells, memory and time that it would take, and build nothing",
    )
    parser.add_argument(
        "--surfaces-only",
        action="store_true",
        help="stop after the heights: --export then writes the surfaces with height, variance and distance",
    )
    parser.add_argument(
        "--eroded",
        action="store_true",
        help="tell what each surface removed and each body took of each block, in the table and the report",
    )
    parser.add_argument(
        "--check-model",
        action="store_true",
        help="prove the model before anything is written, and print the proof",
    )
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    options = parser.parse_args(arguments)
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
            "cut",
            "mesh",
            "cell_tolerance",
        ):
            if getattr(options, name):
                parser.error(f"--surfaces-only goes without --{name.replace('_', '-')}")
    if options.exaggeration != 1.0 and not options.section and not options.fence:
        parser.error("--exaggeration is of drawings: it goes with --section or --fence")
    outputs = ("--blend", "--export", "--report", "--render", "--section", "--fence", "--cut", "--mesh")
    if options.estimate and any(getattr(options, name[2:]) for name in outputs):
        parser.error(f"--estimate builds nothing: it goes without {', '.join(outputs)}")
    of_mesh = ("edge", "thickness", "layers", "layer_thickness", "elements")
    for name in of_mesh:
        if getattr(options, f"mesh_{name}") is not None and options.mesh is None:
            parser.error(f"--mesh-{name.replace('_', '-')} goes with --mesh")
    return options


def _length(text: str) -> float:
    try:
        length = float(text)
    except ValueError:
        length = 0.0
    if not 0.0 < length < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a length above 0")
    return length


def _gigabytes(text: str) -> int:
    try:
        size = float(text) * 1e9
    except ValueError:
        size = 0.0
    if not 1.0 <= size < 1e18:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of gigabytes above 0")
    return int(size)


def _factor(text: str) -> float:
    from realmodel.core.section_drawing import MOST_EXAGGERATION

    try:
        factor = float(text)
    except ValueError:
        factor = 0.0
    if not 0.0 < factor <= MOST_EXAGGERATION:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number above 0, at most {MOST_EXAGGERATION:g}")
    return factor


def _sizes(text: str) -> list[float]:
    try:
        sizes = [float(word) for word in text.split(",")]
    except ValueError:
        sizes = []
    if not 1 <= len(sizes) <= 3 or not all(0.0 < size < 1e300 for size in sizes):
        raise argparse.ArgumentTypeError(f"'{text}' is not one to three numbers above 0")
    return sizes


def _whole(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 0")
    return int(text)


def _run(options: argparse.Namespace) -> None:
    from realmodel.core import build, load_project
    from realmodel.core.atomic import Outputs
    from realmodel.core.batch_mesh import cleaned_line
    from realmodel.core.table import volume_table
    from realmodel.core.terminal import TerminalProgress

    requests = _requests(options)
    mesh_request = _mesh_request(options)
    targets = _checked_targets(options, requests, mesh_request)
    project = load_project(options.project)
    _refuse_overwriting([*project.input_files(), *(f for r in requests for f in r.inputs)], targets)
    progress = TerminalProgress(sys.stdout, options.quiet)
    if options.estimate:
        _estimate(options, project, progress)
        return
    if options.surfaces_only:
        _surfaces_only(options, project, progress)
        return
    with Outputs(project.input_files()) as outputs, _Interruptible(outputs):
        try:
            for request in requests:
                request.read()
            model = build(
                project,
                cells=options.cells,
                threads=options.threads,
                progress=progress,
                stage=options.stage,
                memory=options.memory,
            )
            validation = _validation(options, model, progress)
            erosion = _erosion(options, model, progress)
            mesh = mesh_request.make(model, options.threads, progress) if mesh_request else None
            cells = _cleaned_cells(options, model, progress)
            _write(options, project, model, outputs, progress, validation, erosion, mesh, cells)
            if mesh is not None:
                mesh_request.write(mesh, outputs, project.units, progress)
            told = [request.run(model, outputs, options.threads, progress) for request in requests]
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)  # in a moment all is there: too late to stop
        finally:
            progress.close()
    if not options.quiet:
        with contextlib.suppress(BrokenPipeError):  # the outputs are there
            made = [each for each in (mesh, cells) if each is not None]
            for warning in [*model.warnings, *(warning for each in made for warning in each.warnings)]:
                print(f"warning: {warning}")
            if options.check_model:
                print(f"{validation}\n")
            print(volume_table(model, erosion), flush=True)
            for line in told:
                print(line, flush=True)
            if mesh is not None:
                print(mesh_request.line(mesh), flush=True)
            if cells is not None:
                print(cleaned_line(cells), flush=True)


def _surfaces_only(options: argparse.Namespace, project, progress) -> None:
    from realmodel.core import build_surfaces
    from realmodel.core.atomic import Outputs
    from realmodel.core.exporters.surfaces import surface_writer_for, write_surfaces_report
    from realmodel.core.table import surface_table

    with Outputs() as outputs, _Interruptible(outputs):
        try:
            surfaces = build_surfaces(project, options.threads, progress, stage=options.stage)
            for path in options.export:
                with outputs.file(path) as file:
                    progress(1.0, f"writing {path.name}")
                    surface_writer_for(path)(surfaces, file)
            if options.report is not None:
                with outputs.file(options.report) as file:
                    write_surfaces_report(surfaces, file)
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
        finally:
            progress.close()
    if not options.quiet:
        with contextlib.suppress(BrokenPipeError):
            for warning in surfaces.warnings:
                print(f"warning: {warning}")
            print(surface_table(surfaces), flush=True)


def _estimate(options: argparse.Namespace, project, progress) -> None:
    from realmodel.core import estimate

    try:
        found = estimate(
            project, cells=options.cells, threads=options.threads, progress=progress, stage=options.stage
        )
    finally:
        progress.close()
    print(found.table(), flush=True)
    limit = found.available if options.memory is None else options.memory
    if found.memory > limit:
        print("this would be refused: it takes more memory than there is (see --cells, --memory)", flush=True)


def _erosion(options: argparse.Namespace, model, progress):
    if not options.eroded:
        return None
    return model.eroded(progress=lambda _share, text: progress(1.0, f"what was eroded: {text}"))


def _validation(options: argparse.Namespace, model, progress):
    """The proof of the model, where it is asked for or goes into the report. One that was asked for and
    failed keeps anything from being written."""
    from realmodel.core import BuildFailed, BuildWarning
    from realmodel.core.validation import PLACES_OF_CHECK, PLACES_OF_REPORT

    if not options.check_model and options.report is None:
        return None
    report = model.validate(
        PLACES_OF_CHECK if options.check_model else PLACES_OF_REPORT,
        threads=options.threads,
        progress=lambda _share, text: progress(1.0, text),
    )
    if report.passed:
        return report
    if options.check_model:
        progress.close()
        if not options.quiet:
            print(report, flush=True)
        raise BuildFailed(
            f"the model fails its check: {report.failure()}; nothing was written; this is a defect of "
            "RealModel: please report it with the project"
        )
    text = f"the model fails its check: {report.failure()}; the report says more"
    model.warnings.append(BuildWarning(text, "validation"))
    return report


def _requests(options: argparse.Namespace) -> list:
    """Sections, fences and cuts, in this order. Raises UsageError."""
    from realmodel.core.batch_cuts import cut_request, fence_request, section_request

    return [
        *(section_request(text, options.exaggeration) for text in options.section),
        *(fence_request(text, options.exaggeration) for text in options.fence),
        *map(cut_request, options.cut),
    ]


def _cleaned_cells(options: argparse.Namespace, model, progress):
    """The cells that --cell-tolerance asks for, or None."""
    if options.cell_tolerance is None:
        return None
    return model.cleaned_cells(
        options.cell_tolerance,
        threads=options.threads,
        progress=lambda _share, text: progress(1.0, text),
    )


def _mesh_request(options: argparse.Namespace):
    """What --mesh asks for, or None."""
    from realmodel.core.batch_mesh import BatchMesh

    if options.mesh is None:
        return None
    return BatchMesh(
        options.mesh,
        options.mesh_edge,
        options.mesh_thickness,
        options.mesh_layers,
        options.mesh_layer_thickness,
        options.mesh_elements or "prisms",
    )


def _checked_targets(options: argparse.Namespace, requests: list, mesh=None) -> list[Path]:
    """Where the outputs will stand; refused before anything is built rather than after."""
    from realmodel.core import UsageError
    from realmodel.core.exporters import FORMATS, format_for, output_target
    from realmodel.core.exporters.surfaces import surface_writer_for

    for path in options.export:
        surface_writer_for(path) if options.surfaces_only else format_for(path)
    if options.cell_tolerance is not None:
        able = [known.ending for known in FORMATS.values() if known.has_cells]
        if not any(path.suffix.lower() in able for path in options.export):
            raise UsageError(f"--cell-tolerance goes with --export of a file with cells: {', '.join(able)}")
    paths = [*options.export, *(p for p in (options.report, options.blend, options.render) if p is not None)]
    paths += [path for request in requests for path in request.outputs]
    targets = [output_target(path) for path in paths]
    if mesh is not None:
        paths.append(mesh.path)
        targets.append(mesh.target())
    for path, target in zip(paths, targets, strict=True):
        if targets.count(target) > 1:
            raise UsageError(f"{path}: two outputs have this name")
    return targets


def _refuse_overwriting(files: list[Path], targets: list[Path]) -> None:
    from realmodel.core import UsageError

    inputs = {Path(os.path.realpath(file)) for file in files}
    for target in targets:
        if target in inputs:
            raise UsageError(f"{target}: this is a file that the project reads; choose another name")


def _write(
    options: argparse.Namespace, project, model, outputs, progress, validation, erosion, mesh, cells
) -> None:
    from realmodel.core.exporters import write_model
    from realmodel.core.exporters.report import write_report

    for path in options.export:
        write_model(
            model,
            path,
            outputs,
            lambda share, path=path: progress(1.0, f"writing {path.name}"),
            options.cell_size,
            options.contour_interval,
            cells,
        )
    if options.blend is not None or options.render is not None:
        _write_with_blender(options, project, model, outputs, progress)
    if options.report is not None:
        with outputs.file(options.report) as file:
            write_report(model, options.report, file, options.stage, validation, erosion, mesh, cells)


def _write_with_blender(options: argparse.Namespace, project, model, outputs, progress) -> None:
    import realmodel
    from realmodel.bl import batch
    from realmodel.core.rock_input import with_arrays

    realmodel.register_for_batch()
    progress(1.0, "making the scene")
    # of a stage the project is another one, as the model has it
    batch.write_scene(model, with_arrays(project) if options.stage is None else None)
    if options.blend is not None:
        with outputs.path(options.blend) as path, _named(path, options.blend):
            progress(1.0, f"writing {options.blend.name}")
            batch.save_blend(path)
    if options.render is not None:
        with outputs.path(options.render) as path, _named(path, options.render):
            progress(1.0, f"rendering {options.render.name}")
            batch.render(path)


@contextlib.contextmanager
def _named(path, target: Path):
    """What could not be written is named as the user did, not by the place where it is kept meanwhile."""
    from realmodel.core import OutputFailed

    try:
        yield
    except OutputFailed as error:
        raise OutputFailed(str(error).replace(str(path), str(target))) from error


class _Interruptible:
    """Ctrl-C while Blender renders or saves, when no line of Python runs that could notice it.

    A thread of its own hears the signal. Where the main thread has not gone by then on its own, it drops
    the outputs and ends the process.
    """

    def __init__(self, outputs):
        self.outputs = outputs
        self.left = threading.Event()

    def __enter__(self):
        if IN_BLENDER:
            self._hear, self._told = os.pipe()
            if hasattr(os, "set_blocking"):  # Windows, from Python 3.12 on, and it does not ask for it
                os.set_blocking(self._told, False)
            signal.set_wakeup_fd(self._told)
            threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, *_error) -> None:
        self.left.set()
        if IN_BLENDER:
            signal.set_wakeup_fd(-1)
            os.close(self._told)

    def _watch(self) -> None:
        while heard := os.read(self._hear, 1):
            status = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}.get(heard[0])
            if status is not None and not self.left.wait(_SECONDS_TO_UNWIND):
                self.outputs.drop()
                os._exit(_say("interrupted: nothing was written", status))
        os.close(self._hear)


def _arguments() -> list[str]:
    if IN_BLENDER:
        return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    return sys.argv[2:] if sys.argv[1:2] == ["--"] else sys.argv[1:]


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        exit_status = main(_arguments())
    except KeyboardInterrupt:
        exit_status = _say("interrupted: nothing was written", INTERRUPTED)
    except Exception:  # a defect: told in full, and with a status that Blender too hands on
        traceback.print_exc()
        exit_status = REFUSED
    with contextlib.suppress(BrokenPipeError):
        sys.stdout.flush()
    sys.exit(exit_status)
