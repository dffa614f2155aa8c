# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a case is built right: a list of sentences, each with a kind of failure before its colon."""

import numpy as np
from faulted.contract import PROTECTS
from faulted.judge import model_bytes, topology

from .case import AIR, BODY, SIZE, SheetCase
from .generate import HIGH, LOW, Drawn

VALIDATED = 1500  # points of the validation
DENSE = 40  # contacts of each surface, and dips, from which the model must be about the truth
LEAST_SHARE = 0.85


def project_of(case):
    """The project of a case, and its data."""
    from realmodel.core import (
        Body,
        Fault,
        Observations,
        Project,
        Rock,
        Series,
        SpaceDips,
        Surface,
    )

    drawn, surfaces, all_series = Drawn(case), [], []
    for event in case.events:
        if isinstance(event, SheetCase):
            vertices, triangles = event.mesh()
            surfaces.append(
                Surface(event.name, rule=event.rule, vertices=case.placed(vertices), triangles=triangles)
            )
            continue
        for name, rule in zip(event.surfaces(), event.rules, strict=True):
            points = case.placed(drawn.contacts[name]) if len(drawn.contacts[name]) else None
            surfaces.append(Surface(name, rule=rule, points=points, series=event.name))
        places, normals = drawn.dips[event.name]
        dips = SpaceDips(case.placed(places), normals) if len(places) else None
        all_series.append(Series(event.name, dips=dips, resolution=case.resolution * case.scale))
    square = case.placed([[0, 0, 0], [SIZE, 0, 0], [SIZE, SIZE, 0], [0, SIZE, 0]])
    rock = Rock("r", surfaces, region=square[:, :2].tolist(), base_elevation=float(square[0, 2]))
    rock.series = all_series
    if drawn.observations is not None:
        at, blocks, holes, depths = drawn.observations
        names = [case.names()[block] for block in blocks]
        rock.observations = Observations(case.placed(at), names, holes, np.multiply(depths, case.scale))
    faults = [Fault(f.name, case.placed(f.vertices), f.triangles, youngest=f.youngest) for f in case.faults]
    bodies = [
        Body(b.name, case.placed(b.vertices), b.triangles, after=b.after, void=b.void) for b in case.bodies
    ]
    return Project("p", [rock], faults=faults, bodies=bodies), drawn


def failures_of(case):
    """What is wrong with what the program makes of a case; [] where nothing is."""
    from realmodel.core import InputRefused, build

    project, drawn = project_of(case)
    try:
        model = build(project, cells=case.cells, threads=1)
    except InputRefused as error:
        return [] if _may_be_refused(case, drawn, str(error)) else [f"refused: {error}"]
    except Exception as error:
        return [f"raised: {type(error).__name__}: {error}"]
    failures = topology(model)
    report = model.validate(VALIDATED, threads=1)
    failures += [f"validation: {test.name}: {test.offenders[:2]}" for test in report.tests if test.failed]
    failures += _whole(case, model) + _contacts(case, model) + _observed(case, model) + _share(case, model)
    turn = case.seed % 4
    if turn == 0:
        again = build(project_of(case)[0], cells=case.cells, threads=2)
        if model_bytes(again) != model_bytes(model):
            failures.append("threads: two give other bytes than one")
    elif turn == 1:
        failures += _as_other_cells(case, model)
    elif turn == 2:
        failures += _stage(case, model)
    return failures


def _may_be_refused(case, drawn, text):
    """Where data say too little, or noise contradicts itself."""
    few = [name for name, points in drawn.contacts.items() if len(points) < 4]
    nothing = ("it has no contacts", "it has no points", "the direction to younger rock")
    if any(each in text for each in nothing):
        return bool(few) or case.dips == 0
    order = ("older side of surface", "gets younger the other way", "contradicts contacts", "level")
    return any(word in text for word in order) and (case.noise > 0 or case.contacts < DENSE)


def _whole(case, model):
    """Under a level ground above everything, which cuts all, the rock fills its region from the base."""
    if not case.is_level or any(rule in PROTECTS for _, rule, _ in case.surfaces()):
        return []
    if any(body.void or body.after in (None, "ground") for body in case.bodies):
        return []
    whole = SIZE * SIZE * case.events[-1].height * case.scale**3
    found = float(model.cell_volumes.sum())
    if abs(found - whole) > 1e-9 * whole:
        return [f"whole: the cells have the volume {found!r}, the region up to its top {whole!r}"]
    return []


def _contacts(case, model):
    """Level sets pass through all contacts."""
    return [
        f"contacts: {each.text}"
        for each in model.warnings
        if each.kind == "contacts" and "beside" in each.text
    ]


def _lacks(model):
    """Whether some compartment has the field of all data for want of its own, or a sheet that is continued
    from another: then data contradict it."""
    lacks = ("without contacts", "has no triangles in compartment")
    return any(text in each.text for each in model.warnings for text in lacks)


def _is_tight(case):
    """Whether the lattice is too coarse for a fold."""
    return any(series.fold.wavelength < 2 * case.resolution for series in case.series())


def _observed(case, model):
    found = model.observed()
    if found.share is None or case.noise > 0 or _is_tight(case) or _lacks(model):
        return []
    failures = []
    if found.share < 0.99:
        failures.append(f"observed: {found.share:.4f} of the observations lie in their blocks")
    left_out = [each.text for _, each in found.left_out if each.kind == "contradiction"]
    if left_out:
        failures.append(f"left out: {len(left_out)} bounds of a model without contradictions: {left_out[0]}")
    return failures


def _share(case, model):
    """Of dense data without noise the model is about that which they were drawn from."""
    from realmodel.core.base.work import native_module

    few = case.contacts < DENSE or case.dips < DENSE
    if few or _is_tight(case) or case.noise > 0 or case.faults or _lacks(model):
        return []
    points = np.random.default_rng(3).uniform(LOW, HIGH, (4000, 3))
    truth = case.blocks_at(points)
    cells = native_module().cells_at(model.native(), case.placed(points))
    number = np.array([block.surface for block in model.blocks], int)
    found = np.where(cells >= 0, number[model.cell_block[cells]], AIR)
    bodies = found >= len(case.names())
    found[bodies] += BODY - len(case.names()) - len(case.faults)
    share = (found == truth).mean()
    if share < LEAST_SHARE:
        return [f"share: {share:.3f} of random points lie in the right block"]
    return []


def _as_other_cells(case, model):
    """Columns and blocks are one model."""
    from realmodel.core import build

    other = "blocks" if case.cells == "columns" else "columns"
    built = build(project_of(case)[0], cells=other, threads=1)
    report = built.validate(VALIDATED, threads=1)
    failures = [
        f"validation: {other}: {test.name}: {test.offenders[:2]}" for test in report.tests if test.failed
    ]
    volumes = [{block.name: block.volume for block in each.blocks} for each in (model, built)]
    names = set(volumes[0]) | set(volumes[1])
    most = max(max(each.values(), default=0.0) for each in volumes)
    off = [n for n in names if abs(volumes[0].get(n, 0.0) - volumes[1].get(n, 0.0)) > 1e-9 * most]
    if off:
        failures.append(f"cells: columns and blocks give other volumes of {off}: {volumes}")
    return failures


def _stage(case, model):
    stage = model.stage(case.seed % len(case.names()))
    report = stage.validate(VALIDATED, threads=1)
    return [f"stage: {test.name}: {test.offenders[:2]}" for test in report.tests if test.failed]
