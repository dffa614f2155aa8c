// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/columns.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "plane_models.hpp"
#include "plans.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/element_quality.hpp"
#include "simulation/pillar_levels.hpp"

namespace realmodel::simulation {
namespace {

/// Columns of a model of planes over fans().
struct Fixture {
    Model model;
    PlanLines lines;
    RockBlocks blocks;
    PlanTopology plan;
    ColumnHeights heights;
    ColumnInput input{lines, blocks, plan, heights};

    explicit Fixture(const std::vector<Plane>& planes, bool is_step = false)
        : Fixture(planes, halves(is_step)) {}
    Fixture(const std::vector<Plane>& planes, const PlanLines& plan_lines)
        : model(planes),
          lines(plan_lines),
          blocks(model.block_rock),
          plan(lines, fans()),
          heights(pillar_columns(model.view, blocks, lines, plan, {1, nullptr})) {}
    double height(const PillarLevels& levels, std::size_t pillar, std::size_t level) const {
        return levels.heights(
            plan.pillar_node(pillar))[static_cast<std::size_t>(levels.levels(pillar)[level])];
    }
};

TEST(PillarColumnsTest, PillarsHaveTheHeightsAtTheirNodes) {
    const Fixture at({{0, 0}, {4, 14}});
    for (std::size_t p = 0; p < at.plan.pillar_count(); ++p) {
        ASSERT_EQ(at.heights.rock(p), 0);
        EXPECT_NEAR(at.heights.levels(p)[1], 4 + at.plan.point(at.plan.pillar_node(p))[0], 1e-6);
    }
}

TEST(PillarColumnsTest, ANodeBeyondTheModelTakesHeightsFromWithin) {
    const Fixture at({{0, 0}, {4, 4}});
    PlanLines lines = at.lines;
    meshing::PlanarMesh mesh = fans();
    lines.points[2] = mesh.vertices[2] = {10.5, 0};
    const PlanTopology plan(lines, mesh);
    const auto heights = pillar_columns(at.model.view, at.blocks, lines, plan, {1, nullptr});
    for (std::size_t p = 0; p < plan.pillar_count(); ++p) {
        EXPECT_EQ(heights.rock(p), 0);
        EXPECT_EQ(heights.levels(p)[1], 4);
    }
}

TEST(PillarLevelsTest, BlocksAreDividedAsTheirThicknessAllows) {
    const Fixture at({{0, 0}, {1, 1}, {5, 5}});
    const PillarLevels levels(at.input, {.minimum_thickness = 0.4, .layers = {3, 2}});
    EXPECT_EQ(levels.layer_blocks(0).size(), 5u);
    for (std::size_t p = 0; p < at.plan.pillar_count(); ++p) {
        ASSERT_EQ(levels.levels(p).size(), 6u);
        EXPECT_DOUBLE_EQ(at.height(levels, p, 1), 0.5);
        EXPECT_DOUBLE_EQ(at.height(levels, p, 2), 1);
        EXPECT_DOUBLE_EQ(at.height(levels, p, 3), 1);  // 1 m has no room for three layers
        EXPECT_DOUBLE_EQ(at.height(levels, p, 4), 3);
        EXPECT_DOUBLE_EQ(at.height(levels, p, 5), 5);
    }
    EXPECT_THROW(
        PillarLevels(at.input,
                     {.minimum_thickness = 0.4, .layers = {0, 0}, .layer_thickness = 1e-6}),
        InputError);
}

TEST(PillarLevelsTest, WhatIsTooThinIsSharedByItsNeighbors) {
    const Fixture at({{0, 0}, {4, 4}, {4.2, 4.2}, {9, 9}});
    const PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {1, 1, 1}});
    for (std::size_t p = 0; p < at.plan.pillar_count(); ++p) {
        EXPECT_EQ(levels.levels(p)[1], levels.levels(p)[2]);
        EXPECT_DOUBLE_EQ(at.height(levels, p, 1), 4.1);
    }
}

TEST(PillarLevelsTest, PillarsOfOneNodeShareHeights) {
    const Fixture at({{0, 0}, {4, 4}}, true);
    const PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {2}});
    EXPECT_EQ(levels.height_count(), 3 * at.plan.nodes());
    EXPECT_GT(at.plan.pillar_count(), at.plan.nodes());
}

TEST(PillarLevelsTest, AHeightThatIsRemovedBecomesTheNext) {
    const Fixture at({{0, 0}, {4, 4}});
    PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {4}});
    const std::size_t before = levels.height_count();
    std::vector<PillarLevels::Removal> removals{{6, 2, 1}, {6, 3, 2}, {0, 1, 0}};
    EXPECT_EQ(levels.remove(at.plan, removals), 2u);  // one of each node
    EXPECT_EQ(levels.height_count(), before - 2);
    EXPECT_EQ(levels.heights(6).size(), 4u);
    EXPECT_EQ(levels.heights(6)[1], 1);
    EXPECT_EQ(levels.heights(6)[2], 3);
    EXPECT_EQ(levels.heights(0)[1], 2);
}

TEST(PillarLevelsTest, HeightsMoveWithinBoundsAndKeepTheirDistance) {
    const Fixture at({{0, 0}, {4, 4}});
    PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {4}});
    std::vector<std::uint8_t> moved(at.plan.nodes(), 0), flat(at.plan.nodes(), 0);
    flat[0] = 1;
    const std::vector<PillarLevels::Move> moves{{6, 2, 9}, {0, 4, 1}, {0, 4, 0}};
    EXPECT_TRUE(levels.relax_heights(moves, 0.75, 0.5, true, flat, moved));
    EXPECT_DOUBLE_EQ(levels.heights(6)[2], 2.5);  // as near to 3 as they may be
    EXPECT_DOUBLE_EQ(levels.heights(6)[3], 3);
    EXPECT_DOUBLE_EQ(levels.heights(0)[4], 4.5);  // by the mean of what was asked
    EXPECT_TRUE(levels.relax_heights({{0, 4, 9}}, 0.75, 0.5, false, flat, moved));
    EXPECT_DOUBLE_EQ(levels.heights(0)[4], 4.75);  // no farther from where it was at first
    EXPECT_EQ(levels.heights(0)[0], 0);            // a flat base
    EXPECT_GT(levels.heights(0)[2], 2);
    EXPECT_EQ(moved, (std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 1, 0}));
}

TEST(ColumnFillerTest, ColumnsOfPrisms) {
    for (const bool is_step : {false, true}) {
        const Fixture at({{0, 0}, {4, 4}, {6, 6}}, is_step);
        const PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {2, 1}});
        const FilledColumns columns = fill_columns(at.input, levels, nullptr);
        EXPECT_EQ(columns.mesh.prisms.corners.size(), 3 * at.plan.triangles());
        EXPECT_EQ(columns.mesh.volumes, (std::vector<double>{240, 120}));
        EXPECT_EQ(columns.mesh.layers, 3);
        // of each triangle base, top, and what is between the blocks; six edges at the border
        EXPECT_EQ(columns.mesh.triangles.corners.size(), 3 * at.plan.triangles());
        EXPECT_EQ(columns.mesh.quadrilaterals.corners.size(), 3u * 6);
        EXPECT_EQ(columns.step_faces.size(), is_step ? 2u * 3 : 0u);
    }
}

TEST(ColumnFillerTest, FacesOnAStepThatBothSidesHaveAreInside) {
    const Fixture at({{0, 0}, {4, 4}}, true);
    const PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {1}});
    FilledColumns columns = fill_columns(at.input, levels, nullptr);
    const std::size_t before = columns.mesh.quadrilaterals.corners.size();
    add_step_faces(columns, VerticalFaults(at.model.view, at.lines.steps));
    EXPECT_EQ(columns.mesh.quadrilaterals.corners.size(), before);
    columns.step_faces.resize(1);
    add_step_faces(columns, VerticalFaults(at.model.view, at.lines.steps));
    EXPECT_EQ(columns.mesh.quadrilaterals.corners.size(), before + 1);
}

TEST(ColumnFillerTest, WhereALayerEndsElementsHaveFewerCorners) {
    const Fixture at({{0, 0}, {4, 4}, {4, 9}});  // the upper one has no thickness at x = 0
    const PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {1, 1}});
    const FilledColumns columns = fill_columns(at.input, levels, nullptr);
    // of the four triangles of the left half one has an edge at x = 0, two a corner
    EXPECT_EQ(columns.mesh.tetrahedra.corners.size(), 1u);
    EXPECT_EQ(columns.mesh.pyramids.corners.size(), 2u);
    EXPECT_EQ(columns.mesh.prisms.corners.size(), 2 * at.plan.triangles() - 3);
    EXPECT_NEAR(columns.mesh.volumes[1], 5.0 / 2 * 60, 1e-6);
}

TEST(ElementQualityTest, NothingIsWrongWithUprightPrisms) {
    const Fixture at({{0, 0}, {4, 4}});
    const PillarLevels levels(at.input, {.minimum_thickness = 0.5, .layers = {3}});
    const FilledColumns columns = fill_columns(at.input, levels, nullptr);
    const ElementQuality quality(at.plan, levels, columns.fronts, 0.5, nullptr);
    const auto narrow = narrow_strips(at.plan, columns.fronts);
    EXPECT_TRUE(quality.weak(narrow).empty());
    EXPECT_TRUE(quality.failing(narrow).empty());
    EXPECT_TRUE(quality.steep(std::vector<std::uint8_t>(at.plan.nodes(), 1)).empty());
    for (const bool divided : {false, true})
        EXPECT_EQ(quality.skewed(divided).faces, 0u);
}

TEST(ElementQualityTest, ThinElementsUnderASteepTopAreSkewed) {
    const Fixture at({{0, 60}, {0.6, 60.6}});
    const PillarLevels levels(at.input, {.minimum_thickness = 0.1, .layers = {2}});
    const FilledColumns columns = fill_columns(at.input, levels, nullptr);
    const ElementQuality quality(at.plan, levels, columns.fronts, 0.1, nullptr);
    const auto skewed = quality.skewed(false);
    EXPECT_GT(skewed.faces, 0u);
    EXPECT_GT(skewed.most, kSkewnessLimit);
    ASSERT_FALSE(skewed.removals.empty());
    for (const PillarLevels::Removal& removal : skewed.removals)
        EXPECT_EQ(std::abs(removal.height - removal.into), 1);
    const auto moves = quality.steep(std::vector<std::uint8_t>(at.plan.nodes(), 1));
    EXPECT_FALSE(moves.empty());
}

TEST(ColumnRepairTest, ColumnsInOrderAreDividedAsAsked) {
    const Fixture at({{0, 0}, {4, 4}});
    const LayeredMesh mesh =
        repaired_columns(at.input, VerticalFaults(at.model.view, at.lines.steps),
                         {.minimum_thickness = 0.5, .layers = {2}}, nullptr);
    EXPECT_EQ(mesh.prisms.corners.size(), 2 * at.plan.triangles());
    EXPECT_EQ(mesh.volumes, (std::vector<double>{240}));
    EXPECT_EQ(mesh.skewed.faces, 0u);
}

TEST(ColumnRepairTest, LevelsUnderASteepTopAreMergedUntilFewerFacesAreSkewed) {
    const Fixture at({{0, 60}, {0.6, 60.6}});
    const Layering layering{.minimum_thickness = 0.1, .layers = {2}};
    const PillarLevels levels(at.input, layering);
    const FilledColumns columns = fill_columns(at.input, levels, nullptr);
    const auto before =
        ElementQuality(at.plan, levels, columns.fronts, 0.1, nullptr).skewed(false).faces;
    const LayeredMesh mesh = repaired_columns(
        at.input, VerticalFaults(at.model.view, at.lines.steps), layering, nullptr);
    EXPECT_LT(mesh.skewed.faces, before);
    EXPECT_LT(mesh.prisms.corners.size(), columns.mesh.prisms.corners.size());
}

TEST(NarrowStripsTest, AreasOfOneElementFarFromOthersAreWide) {
    const Fixture at({{0, 0}, {4, 4}});
    ColumnFronts columns;
    for (std::size_t t = 0; t < at.plan.triangles(); ++t) {
        for (std::size_t front = 0; front < (t == 0 ? 3u : 2u); ++front)
            columns.fronts.push_back({});
        columns.offset.push_back(columns.fronts.size());
    }
    EXPECT_EQ(narrow_strips(at.plan, columns),
              std::vector<std::uint8_t>(at.plan.triangles(), 1));  // no more than four steps away
    columns.offset.assign(1, 0);
    for (std::size_t t = 0; t < at.plan.triangles(); ++t)
        columns.offset.push_back(2 * (t + 1));
    EXPECT_EQ(narrow_strips(at.plan, columns),
              std::vector<std::uint8_t>(at.plan.triangles(), 0));  // there are no others
}

}  // namespace
}  // namespace realmodel::simulation
