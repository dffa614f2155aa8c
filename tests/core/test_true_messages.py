# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages say what is so, azimuths beyond 360 degrees are taken as the same below, and a block that is not
there is not empty in silence."""

import numpy as np
import pytest
from realmodel.core import (
    Boreholes,
    Dips,
    Observations,
    Project,
    Rock,
    Series,
    Strata,
    Surface,
    UsageError,
    build,
)
from realmodel.core.base.work import run
from realmodel.core.fields.solve import LevelSetData, _against_order
from realmodel.core.readers.tables.dips import gradient_of, normal_of
from realmodel.core.results.model_holes import HoleAxis
from realmodel.core.surfaces.prepare import read_rocks

_SQUARE = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 1000.0], [0.0, 1000.0]]
_PLAN = np.array([[100.0, 100.0], [900.0, 200.0], [500.0, 800.0], [300.0, 500.0]])


def _flat(name, z, **options):
    return Surface(name, method="constant", options={"value": z}, **options)


def _model(*surfaces, **options):
    given = {"region": _SQUARE, "edge_length": 100.0, "base_elevation": 0.0}
    return build(Project("p", [Rock("r", [*surfaces], **given, **options)]))


def _plane(plan, z, slope):
    return np.column_stack([plan, z + plan @ slope])


def test_a_surface_that_dips_is_not_its_height_everywhere():
    slope = gradient_of(10.0, 90.0)
    cases = (
        {"series": [Series("s", kind="sheets")]},  # others show the dip
        {},  # its own option does
    )
    for options in cases:
        own = {"series": "s"} if options else {"method": "plane", "options": {"dip": 10, "dip_direction": 90}}
        surfaces = [Surface("A", points=_plane(_PLAN[:1], 300.0, slope), **own)]
        if options:
            surfaces.append(Surface("B", points=_plane(_PLAN, 350.0, slope), series="s"))
        model = _model(*surfaces, _flat("ground", 600.0), **options)
        vertices, _ = model.surface(0)
        assert np.ptp(vertices[:, 2]) > 100.0
        assert not [w for w in model.warnings if w.surface == "A" and "only one point" in w.text]
    model = _model(Surface("A", points=[[500.0, 500.0, 300.0]]), _flat("ground", 600.0))
    assert any("only one point" in warning.text for warning in model.warnings)


def test_the_surface_that_is_extrapolated_may_be_the_wrong_one():
    dip = {"dip": 10.0, "dip_direction": 270.0}
    older = Surface("A", points=[[100.0, 500.0, 200.0]], method="plane", options=dip)
    younger = Surface("B", points=[[900.0, 500.0, 230.0]], rule="conformable")
    model = _model(older, younger, _flat("ground", 600.0))
    text = next(warning.text for warning in model.warnings if warning.kind == "wrong_side")
    assert text.startswith("its only point lies below 'A'")
    assert "'A' is extrapolated there, and may be wrong instead" in text


@pytest.mark.parametrize("order", [1, -1])
def test_the_order_is_to_blame_only_where_it_is_wrong(order):
    class Error:
        items = (0,)
        place = (1.0, 2.0, 3.0)

    contacts = np.vstack([np.column_stack([_PLAN, np.full(4, z)]) for z in (300.0, 350.0)[::order]])
    data = LevelSetData(["A", "B"], contacts, np.repeat([0, 1], 4), contacts[:1], normal_of(3.0, 20.0)[None])
    advice = str(_against_order(Error(), data))
    assert ("list the oldest surface first" in advice) == (order < 0)


@pytest.mark.parametrize("azimuth", [1.0, 345.0, 90.0])
def test_azimuths_go_around(azimuth, tmp_path):
    def found(turn):
        direction = azimuth + turn
        axis = HoleAxis((0.0, 0.0, 0.0), direction, 60.0)
        survey = tmp_path / "collars.csv"
        survey.write_text(f"hole,x,y,z,azimuth,dip\nh0,500,500,600,{direction},60\n")
        (tmp_path / "picks.csv").write_text("hole,surface,depth\nh0,A,300\n")
        holes = Boreholes(picks=tmp_path / "picks.csv", collars=survey)
        model = _model(Surface("A", points=_plane(_PLAN, 300.0, (0, 0))), _flat("g", 600.0), boreholes=holes)
        plane = Surface("A", method="plane", points=_plane(_PLAN, 300.0, (0, 0)))
        plane.options = {"dip": 5.0, "dip_direction": direction}
        return [
            np.asarray(each).tobytes()
            for each in (
                axis.direction,
                gradient_of(30.0, direction),
                normal_of(30.0, direction),
                model.vertices,
                _model(plane, _flat("g", 600.0)).vertices,
            )
        ]

    assert found(0.0) == found(360.0) == found(-360.0)
    for name in ("dip_direction", "fold_axis", "fault_strike"):
        Strata(beds=2, dip=30, **{name: azimuth + 720.0})
        with pytest.raises(UsageError):
            Strata(beds=2, **{name: np.inf})


def test_boundaries_of_blocks_by_name():
    points = [[500.0, 500.0, 900.0]]
    model = _model(Surface("A", points=points), _flat("B", 500.0), _flat("ground", 600.0))
    whole = model.block_boundary("ground block")
    assert len(whole.faces) == len(model.block_boundary(2).faces) > 0
    for unknown in ("nothing", 99, -1):
        with pytest.raises(UsageError, match="blocks are base block, B block, ground block"):
            model.block_boundary(unknown)
    with pytest.raises(UsageError, match="'B block' is absent"):
        model.block_boundary("B block")


def test_a_map_alone_is_said_to_be_a_skin():
    """Where there are dips, holes or points, too, nothing is said."""
    places = [[x, y, 590.0] for x in (100.0, 400.0, 600.0, 900.0) for y in (200.0, 800.0)]
    seen = Observations(places, ["A"] * 4 + ["B"] * 4)
    ground = _flat("ground", 600.0)
    in_hole = Observations([*places, [500, 500, 300]], ["A"] * 4 + ["B"] * 5, [""] * 8 + ["h"])
    dips = Dips(_PLAN[:1], gradient_of(5.0, 90.0)[None])

    def said(a=None, seen=seen, **options):
        rows = [a or Surface("A"), Surface("B", rule="conformable"), ground]
        project = Project(
            "p", [Rock("r", rows, region=_SQUARE, edge_length=200.0, observations=seen, **options)]
        )
        (entry,) = run(lambda work: read_rocks(work, project))
        return [w.text for w in entry.warnings if "blocks may be very thin" in w.text]

    assert len(said()) == 1 and "where 'A' and 'B' are," in said()[0]
    assert "where 'B' is," in said(Surface("A", points=_plane(_PLAN, 300.0, (0, 0))))[0]
    assert not said(seen=in_hole)
    assert not said(dips=dips)
    assert not said(Surface("A", dips=dips))
