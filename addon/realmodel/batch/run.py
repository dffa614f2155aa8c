# SPDX-License-Identifier: GPL-3.0-or-later
"""The main program of build_model.py: builds the project or loads the model, writes the outputs, prints the
table."""

import argparse
import contextlib
import os
import sys
from dataclasses import replace
from pathlib import Path

from ..core import (
    BuildFailed,
    BuildWarning,
    OutputFailed,
    UsageError,
    build_surfaces,
    estimate,
)
from ..core.base.atomic import Outputs, make_folder, writable_target
from ..core.exporters import FIELDS, MODEL, SURFACES
from ..core.exporters.mesh_request import MeshRequest, cleaned_line
from ..core.exporters.report import hole_entries, model_report, write_report
from ..core.exporters.surface_files import write_surfaces_report
from ..core.results.sheets import DEFAULT_SIZE
from ..core.surfaces.prepare import with_arrays
from ..core.validation.validation import PLACES_OF_CHECK, PLACES_OF_REPORT
from .cuts import (
    CutRequest,
    JuxtapositionRequest,
    SheetRequest,
    borehole_request,
    cut_request,
    fence_request,
    juxtaposition_request,
    section_request,
    stereonet_request,
)
from .sources import OpenedFile
from .table import (
    ProbabilityRequests,
    ensemble_table,
    left_out_table,
    surface_table,
    tiles_table,
    volume_table,
)
from .terminal import Interruptible, TerminalProgress, ignore_interruption


def run(options: argparse.Namespace) -> None:
    """Runs the program with these options. Raises RealModelError; files appear whole or not at all."""
    probabilities = ProbabilityRequests.of(options) if options.ensemble is not None else None
    requests = _requests(options) if probabilities is None else probabilities.made
    if probabilities is not None and requests:
        make_folder(options.out)  # they may go there
    mesh_requests = _mesh_requests(options)
    targets = _checked_targets(options, requests, mesh_requests)
    source = OpenedFile.of(options.project)
    project = source.project
    _refuse_overwriting([*source.inputs, *(f for r in requests for f in r.inputs)], targets)
    if project is not None:
        _require_fields(options, project)
        _require_faults(requests, project)
    by_dask = options.ensemble is not None or options.tiles is not None
    progress = TerminalProgress(sys.stdout, options.quiet, time_left=by_dask)
    if options.estimate:
        _estimate(options, project, progress)
        return
    if options.surfaces_only:
        _surfaces_only(options, project, progress)
        return
    if probabilities is not None:
        _ensemble(options, project, progress, probabilities)
        return
    if options.tiles is not None:
        _tiles(options, project, progress)
        return
    with Outputs(source.inputs) as outputs, Interruptible(outputs):
        try:
            for request in requests:
                request.read()
            model = source.model(
                options.cells, options.threads, options.device, progress, options.stage, options.memory
            )
            _require_fields(options, model.project)
            validation = _validation(options, model, progress)
            erosion = _erosion(options, model, progress)
            holes = _left_out_holes(options, model, progress)
            mesh = mesh_requests[0].make(model, options.threads, progress) if mesh_requests else None
            cells = _cleaned_cells(options, model, progress)
            grid = _corner_point(options, model, progress)
            _export(options, model, outputs, progress, cells, grid)
            if options.export_field is not None:
                fields = [entry.fields for entry in model.rock_inputs]
                FIELDS.write(fields, options.export_field, outputs)
            if options.blend is not None or options.render is not None:
                _write_with_blender(options, project, model, outputs, progress)
            if options.report is not None:
                with outputs.file(options.report) as file:
                    report = model_report(model, options.stage, validation, erosion, mesh, cells, grid)
                    write_report(report if holes is None else report | hole_entries(holes), file)
            for wanted in mesh_requests:
                wanted.write(mesh, outputs, model.project.units, progress)
            lines = [request.run(model, outputs, options.threads, progress) for request in requests]
            ignore_interruption()
        finally:
            progress.close()
    validated = [f"{validation}\n"] if options.check_model else []
    lines = [*validated, volume_table(model, erosion), *lines]
    if any(rock.observed is not None for rock in model.project.rocks):
        lines.append(f"observed: {model.observed().summary()}")
    if holes is not None:
        lines += [f"cross-validation: {holes.summary()}", left_out_table(holes)]
    if options.origin is not None:
        names = map(str, _with_option(options.export, "origin"))
        lines.append(f"{', '.join(names)}: coordinates are relative to {', '.join(map(str, options.origin))}")
    lines += [wanted.line(mesh) for wanted in mesh_requests]
    if cells is not None:
        lines.append(cleaned_line(cells))
    made = [result for result in (model, mesh, cells, grid) if result is not None]
    _print(options, [warning for result in made for warning in result.warnings], lines)


def _require_fields(options: argparse.Namespace, project) -> None:
    if options.export_field is not None and not any(rock.has_fields for rock in project.rocks):
        raise UsageError("--export-field: none of the series of the project is of the kind 'field'")


def _require_faults(requests: list, project) -> None:
    names = [fault.name for fault in project.faults]
    for request in requests:
        if isinstance(request, JuxtapositionRequest) and request.fault not in names:
            there = f"the project has {', '.join(names)}" if names else "the project has none"
            raise UsageError(f"--juxtaposition: no fault is called '{request.fault}'; {there}")


def _print(options: argparse.Namespace, warnings: list, lines: list[str]) -> None:
    """Prints warnings and lines, unless --quiet. A closed output is no error here: the files are written."""
    if not options.quiet:
        with contextlib.suppress(BrokenPipeError):
            for line in (*(f"warning: {warning}" for warning in warnings), *lines):
                print(line)
            sys.stdout.flush()


def _surfaces_only(options: argparse.Namespace, project, progress) -> None:
    with Outputs() as outputs, Interruptible(outputs):
        try:
            surfaces = build_surfaces(
                project,
                threads=options.threads,
                device=options.device,
                progress=progress,
                stage=options.stage,
            )
            for path in options.export:
                progress(1.0, f"writing {path.name}")
                SURFACES.write(surfaces, path, outputs)
            if options.report is not None:
                with outputs.file(options.report) as file:
                    write_surfaces_report(surfaces, file)
            ignore_interruption()
        finally:
            progress.close()
    _print(options, surfaces.warnings, [surface_table(surfaces)])


def _estimate(options: argparse.Namespace, project, progress) -> None:
    try:
        forecast = estimate(
            project, cells=options.cells, threads=options.threads, progress=progress, stage=options.stage
        )
    finally:
        progress.close()
    print(forecast.table(), flush=True)
    limit = forecast.available if options.memory is None else options.memory
    if forecast.memory > limit:
        print("a build would be refused: it needs more memory (see --cells, --memory)", flush=True)


@contextlib.contextmanager
def _client(options: argparse.Namespace, progress):
    """The client for --scheduler, or None."""
    from ..distributed.workers import connected

    client = None if options.scheduler is None else connected(options.scheduler)
    try:
        yield client
    finally:
        progress.close()
        if client is not None:
            client.close()


def _tiles(options: argparse.Namespace, project, progress) -> None:
    from ..distributed import build as build_tiles

    with _client(options, progress) as client:
        tiled = build_tiles(
            project, options.out, options.tiles, client, cells=options.cells, progress=progress
        )
    if options.export_field is not None:
        FIELDS.save([rock.fields for rock in tiled.rock_fields()], options.export_field)
    _print(options, tiled.warnings, [tiles_table(tiled)])


def _ensemble(options: argparse.Namespace, project, progress, probabilities: ProbabilityRequests) -> None:
    from ..distributed import ensemble

    for request in probabilities.made:
        request.read()
    with _client(options, progress) as client:
        result = ensemble(
            project,
            options.ensemble,
            options.out,
            options.seed or 0,
            client,
            correlation=options.correlation or 0.0,
            places=probabilities.places,
            also=probabilities.write,
            progress=progress,
        )
    _print(options, result.model.warnings, [ensemble_table(result)])


def _left_out_holes(options: argparse.Namespace, model, progress):
    if options.cross_validate is None:
        return None
    return model.cross_validate_holes(
        options.cross_validate,
        threads=options.threads,
        progress=lambda _share, text: progress(1.0, f"without holes: {text}"),
    )


def _erosion(options: argparse.Namespace, model, progress):
    if not options.eroded:
        return None
    return model.eroded(progress=lambda _share, text: progress(1.0, f"eroded volumes: {text}"))


def _validation(options: argparse.Namespace, model, progress):
    """The validation of the model, if it is requested or part of the report. If a requested one fails,
    nothing is written."""
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
            f"the model fails its validation: {report.failure()}; nothing was written; this is a defect of "
            "RealModel: please report it with the project"
        )
    text = f"the model fails its validation: {report.failure()}; see the report"
    model.warnings.append(BuildWarning(text, "validation"))
    return report


def _requests(options: argparse.Namespace) -> list:
    """Sections, fences, the sheets that show them, juxtapositions, stereonets, boreholes and cuts, in this
    order. Raises UsageError."""
    drawn = {name: getattr(options, name) for name in ("exaggeration", "hole_width", "hole_column")}
    sections = [
        *(replace(section_request(text), **drawn) for text in options.section),
        *(replace(fence_request(text), **drawn) for text in options.fence),
    ]
    size = options.sheet_size or DEFAULT_SIZE
    return [
        *sections,
        *([SheetRequest(options.sheet, size, options.sheet_scale, sections)] if options.sheet else []),
        *(
            replace(juxtaposition_request(text), exaggeration=options.exaggeration)
            for text in options.juxtaposition
        ),
        *(replace(stereonet_request(text), net=options.net or "equal_area") for text in options.stereonet),
        *(borehole_request(text) for text in options.borehole),
        *(
            replace(
                cut_request(text),
                cell_size=options.cell_size,
                contour_interval=options.contour_interval,
                tolerance=options.cell_tolerance,
            )
            for text in options.cut
        ),
    ]


def _with_option(paths: list[Path], option: str) -> list[Path]:
    """The files of models on which a setting has an effect."""
    able = MODEL.endings(option)
    return [path for path in paths if path.suffix.lower() in able]


def _cleaned_cells(options: argparse.Namespace, model, progress):
    """The cells of the model for --cell-tolerance, or None."""
    if options.cell_tolerance is None or not _with_option(options.export, "tolerance"):
        return None
    return model.cleaned_cells(
        options.cell_tolerance,
        threads=options.threads,
        progress=lambda _share, text: progress(1.0, text),
    )


def _with_grid(options: argparse.Namespace) -> list[Path]:
    """The files of --export that have a corner-point grid: RESQML's where the size of cells is given."""
    return [
        path
        for path in _with_option(options.export, "grid")
        if options.cell_size is not None or "corner point" in MODEL.format(path).takes
    ]


def _corner_point(options: argparse.Namespace, model, progress):
    """The corner-point grid of --export, or None."""
    if not _with_grid(options):
        return None
    progress(1.0, "making the corner-point grid")
    return model.corner_point_grid(options.cell_size, options.grid_layers or 1, options.grid_azimuth or 0.0)


def _mesh_requests(options: argparse.Namespace) -> list[MeshRequest]:
    """The files of --mesh: of one mesh."""
    return [
        MeshRequest(
            path,
            options.mesh_edge,
            options.mesh_thickness,
            options.mesh_layers,
            options.mesh_layer_thickness,
            options.mesh_elements or "prisms",
        )
        for path in options.mesh
    ]


def _checked_targets(options: argparse.Namespace, requests: list, meshes: list[MeshRequest]) -> list[Path]:
    """The paths of the outputs. Refuses wrong ones before anything is built."""
    exported = [] if options.ensemble is not None else options.export  # else they are requests
    exporter = SURFACES if options.surfaces_only else MODEL
    targets = [exporter.target(path) for path in exported]
    if options.cell_tolerance is not None:
        cut = [path for request in requests if isinstance(request, CutRequest) for path in request.outputs]
        if not _with_option([*options.export, *cut], "tolerance"):
            able = ", ".join(MODEL.endings("tolerance"))
            raise UsageError(f"--cell-tolerance goes with --export or --cut to a file with cells: {able}")
    for name in ("grid_layers", "grid_azimuth"):
        is_able = not options.surfaces_only and exported and _with_grid(options)
        if getattr(options, name) is not None and not is_able:
            option, able = name.replace("_", "-"), ", ".join(MODEL.endings(name))
            raise UsageError(
                f"--{option} goes with --export to a corner-point grid: {able} (.epc: with --cell-size)"
            )
    if options.origin is not None and (options.surfaces_only or not _with_option(exported, "origin")):
        raise UsageError(f"--origin goes with --export of blocks to {', '.join(MODEL.endings('origin'))}")
    single = (options.export_field, options.report, options.blend, options.render)
    paths = [*exported, *(p for p in single if p is not None)]
    targets += [writable_target(path) for path in paths[len(exported) :]]
    for request in (*requests, *meshes):
        paths += request.outputs
        targets += [request.exporter.target(path) for path in request.outputs]
    for path, target in zip(paths, targets, strict=True):
        if targets.count(target) > 1:
            raise UsageError(f"{path}: two outputs have this name")
    return targets


def _refuse_overwriting(files: list[Path], targets: list[Path]) -> None:
    inputs = {Path(os.path.realpath(file)) for file in files}
    for target in targets:
        if target in inputs:
            raise UsageError(f"{target}: this is a file that is read; choose another name")


def _export(options: argparse.Namespace, model, outputs, progress, cells, grid) -> None:
    for path in options.export:
        MODEL.write(
            model,
            path,
            outputs,
            lambda share, path=path: progress(1.0, f"writing {path.name}"),
            cell_size=options.cell_size,
            contour_interval=options.contour_interval,
            cells=cells,
            grid=grid,
            origin=options.origin,
        )


def _write_with_blender(options: argparse.Namespace, project, model, outputs, progress) -> None:
    from .. import register_for_batch
    from ..bl.pictures import batch

    register_for_batch()
    progress(1.0, "making the scene")
    # of a stage the project is another one, as the model has it; a built model has no other
    is_whole = options.stage is None and project is not None
    batch.write_scene(model, with_arrays(project) if is_whole else None)
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
    """Names the user's path in errors of writing, instead of the temporary one."""
    try:
        yield
    except OutputFailed as error:
        raise OutputFailed(str(error).replace(str(path), str(target))) from error
