# SPDX-License-Identifier: GPL-3.0-or-later
"""Models as IFC 4.3, as IfcOpenShell reads and validates them."""

import numpy as np
import pytest
from object_models import assert_closed, assert_shared, corner_triples, crossing_model, logged_model, volume
from realmodel.core import Project, Rock, Surface, build

ifcopenshell = pytest.importorskip("ifcopenshell", reason="not installed: scripts/test.sh installs it")
# the validation leaves the file of its rules open
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]
BLOCKS = ["base block", "Grès à Voltzia", "Clay", "Clay (2)", "Cover"]


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    folder = tmp_path_factory.mktemp("boreholes")

    def write(name, text):
        (folder / name).write_text(text)
        return folder / name

    return crossing_model(write)


@pytest.fixture(scope="module")
def file(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("ifc") / "m.ifc"
    model.save(path)
    return ifcopenshell.open(path)


def faults(file):
    """What the validation finds, with the rules of the schema."""
    import ifcopenshell.validate

    logger = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(file, logger, express_rules=True)
    ifcopenshell.validate.validate_ifc_header(file, logger)
    return logger.statements


def face_sets(element):
    """Vertices and triangles, from 0, of each item of an element's shape."""
    return [
        (np.array(item.Coordinates.CoordList), np.array(item.CoordIndex) - 1)
        for shape in element.Representation.Representations
        for item in shape.Items
    ]


def joined(sets):
    first = np.cumsum([0, *(len(vertices) for vertices, _ in sets[:-1])])
    triangles = [triangles + at for (_, triangles), at in zip(sets, first, strict=True)]
    return np.concatenate([vertices for vertices, _ in sets]), np.concatenate(triangles)


def strata(file):
    (geomodel,) = file.by_type("IfcGeomodel")
    parts = geomodel.IsDecomposedBy[0].RelatedObjects
    return {each.Name: each for each in parts if each.is_a("IfcGeotechnicalStratum")}


def test_it_is_valid_with_all_rules(file):
    assert file.schema_identifier == "IFC4X3_ADD2"
    assert faults(file) == []


def test_an_invalid_file_would_be_found(file):
    """So that the test above may be trusted."""
    copy = ifcopenshell.file.from_string(file.to_string())
    copy.by_type("IfcVirtualElement")[0].ObjectPlacement = None
    assert any("PlacementForShapeRepresentation" in str(each) for each in faults(copy))


def test_each_block_is_a_closed_stratum_that_shares_its_triangles(model, file):
    found = strata(file)
    assert list(found) == BLOCKS
    shapes = []
    for name, block in zip(BLOCKS, model.blocks, strict=True):
        sets = face_sets(found[name])
        assert len(sets) == block.components
        for vertices, triangles in sets:
            assert_closed(triangles)
            assert volume(vertices, triangles) > 0
        shape = joined(sets)
        assert volume(*shape) == pytest.approx(block.volume, rel=1e-9)
        shapes.append(shape)
        assert found[name].PredefinedType == "SOLID"
    assert_shared(shapes, model)


def test_blocks_are_connected_by_the_boundaries_that_they_share(model, file):
    found = strata(file)
    connections = file.by_type("IfcRelConnectsWithRealizingElements")
    pairs = {tuple(sorted(pair)) for pair in model.face_blocks.tolist() if min(pair) >= 0}
    pairs = {pair for pair in pairs if pair[0] != pair[1]}
    names = {
        tuple(sorted((BLOCKS.index(c.RelatingElement.Name), BLOCKS.index(c.RelatedElement.Name))))
        for c in connections
    }
    assert names == pairs
    for each in connections:
        (border,) = each.RealizingElements
        assert border.is_a("IfcVirtualElement") and border.PredefinedType == "BOUNDARY"
        corners = [
            {tuple(sorted(triple)) for triple in corner_triples(*joined(face_sets(element)))}
            for element in (border, each.RelatingElement, each.RelatedElement)
        ]
        assert corners[0] <= corners[1] & corners[2]
    assert {each.Name for each in file.by_type("IfcVirtualElement")} >= {
        "cover: Cover",
        "S1: base block / Clay",
    }
    assert len(found) == 5


def test_properties_quantities_materials_and_colors(model, file):
    import ifcopenshell.util.element as element

    sandstone = strata(file)[BLOCKS[1]]
    sets = element.get_psets(sandstone)
    assert sets["Qto_VolumetricStratumBaseQuantities"]["Volume"] == model.blocks[1].volume
    assert sets["Pset_GeotechnicalStratumCommon"]["StratumColour"] == "#c86432"
    own = sets["RealModel_Block"]
    assert (own["Property"], own["PropertyName"], own["PropertyAge"]) == (1, "Sandstone", "Buntsandstein")
    assert (own["RockMass"], own["Surface"], own["PropertyDensity"]) == ("rock", "S1", 2.5)
    assert element.get_material(sandstone).Name == "Sandstone"
    (styled,) = sandstone.Representation.Representations[0].Items[0].StyledByItem
    color = styled.Styles[0].Styles[0].SurfaceColour
    assert (color.Red, color.Green, color.Blue) == pytest.approx((0xC8 / 255, 0x64 / 255, 0x32 / 255))


def test_boreholes_are_made_of_strata(model, file):
    import ifcopenshell.util.element as element

    upright, inclined = sorted(file.by_type("IfcBorehole"), key=lambda each: each.Name)
    assert (upright.Name, inclined.Name) == ("B1", "B2")
    parts = upright.IsDecomposedBy[0].RelatedObjects
    assert [part.Name for part in parts] == ["Cover", "Clay (2)", "Clay"]
    intervals = [element.get_pset(part, "RealModel_Interval") for part in parts]
    assert [(each["From"], each["To"]) for each in intervals] == [(0.0, 7.5), (7.5, 8.0), (8.0, 9.0)]
    assert [each.get("Top") for each in intervals][1:] == ["S3", "S2"]
    (curve,) = upright.Representation.Representations[0].Items
    assert np.allclose(curve.Points.CoordList, [[0.75, 1.0, z] for z in (9.0, 1.5, 1.0, 0.0)])
    assert parts[0].Representation.Representations[0].Items[0].is_a("IfcSweptDiskSolid")


def test_boreholes_are_as_they_were_logged(write, tmp_path):
    """To their ends, with lost core between; an interval of an inclined hole is one stratum."""
    import ifcopenshell.util.element as element

    logged_model(write).save(tmp_path / "m.ifc")
    read = ifcopenshell.open(tmp_path / "m.ifc")
    assert faults(read) == []
    found = {}
    for hole in read.by_type("IfcBorehole"):
        parts = hole.IsDecomposedBy[0].RelatedObjects
        own = [(part.Name, element.get_pset(part, "RealModel_Interval")) for part in parts]
        found[hole.Name] = [(name, round(each["From"], 6), round(each["To"], 6)) for name, each in own]
    lost = "unknown"
    assert found == {
        "L1": [
            *((lost, 0, 2), ("soil", 2, 10), (lost, 10, 12), (lost, 12, 14)),  # picked at 12
            *(("clay", 14, 25), ("rock", 25, 40)),
        ],
        "L2": [("soil", 0, 12), ("clay", 12, 16), (lost, 16, 18), ("clay", 18, 22), ("rock", 22, 30)],
        "L3": [("soil", 0, 8), ("clay", 8, 28), ("rock", 28, 45)],
    }


def test_the_place_is_that_of_the_projects_system(model, file, write, tmp_path):
    (conversion,) = file.by_type("IfcMapConversion")
    assert (conversion.Eastings, conversion.Northings) == (400_000.0, 5_300_000.0)
    assert conversion.TargetCRS.Name == "EPSG:25832"
    assert conversion.TargetCRS.MapUnit.Name == "METRE"
    place = file.by_type("IfcSite")[0].ObjectPlacement.RelativePlacement.Location
    assert place.Coordinates == (0.0, 0.0, 0.0)
    vertices = np.concatenate([face_sets(each)[0][0] for each in strata(file).values()])
    assert np.abs(vertices).max() < 10.0


def test_without_a_system_the_site_has_the_place_and_units_may_be_feet(tmp_path):
    plan = np.array([[5e5, 4e6], [5e5 + 10, 4e6], [5e5 + 10, 4e6 + 10], [5e5, 4e6 + 10]])
    level = [
        Surface(f"S{z}", np.column_stack([plan, np.full(4, z)]), [[0, 1, 2], [0, 2, 3]]) for z in (0.0, 3.0)
    ]
    built = build(Project("feet", [Rock("r", level)], units="us-ft"))
    built.save(tmp_path / "m.ifc")
    read = ifcopenshell.open(tmp_path / "m.ifc")
    assert faults(read) == []
    assert not read.by_type("IfcMapConversion")
    place = read.by_type("IfcSite")[0].ObjectPlacement.RelativePlacement.Location
    assert place.Coordinates == (5e5, 4e6, 0.0)
    import ifcopenshell.util.unit as unit

    assert unit.calculate_unit_scale(read) == pytest.approx(1200 / 3937, rel=1e-15)


def test_its_geometry_is_that_of_the_model(model, file):
    """As IfcOpenShell's own engine makes it."""
    import ifcopenshell.geom as geom

    settings = geom.settings()
    settings.set("use-world-coords", True)
    for name, block in zip(BLOCKS, model.blocks, strict=True):
        shape = geom.create_shape(settings, strata(file)[name]).geometry
        vertices = np.array(shape.verts).reshape(-1, 3)
        assert volume(vertices, np.array(shape.faces).reshape(-1, 3)) == pytest.approx(block.volume, rel=1e-6)
