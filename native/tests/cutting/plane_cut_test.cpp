// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <numeric>

#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {
namespace {

using strata::CellComplex;
using strata::grid;
using strata::OwnedSurface;

CellComplex level_layers(const std::vector<double>& heights, int n = 2) {
    std::vector<OwnedSurface> surfaces;
    for (const double z : heights)
        surfaces.push_back(grid(n, n, 0, 0, 2, 2, [z](double, double) { return z; }));
    return strata::build(surfaces);
}

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double area(const Section& s, std::size_t polygon) {
    std::array<double, 3> twice{0, 0, 0};
    const auto begin = static_cast<std::size_t>(s.offsets[polygon]);
    const auto end = static_cast<std::size_t>(s.offsets[polygon + 1]);
    const auto at = [&](std::size_t i) {
        return s.vertices[static_cast<std::size_t>(s.polygon_vertices[i])];
    };
    for (std::size_t i = begin + 1; i + 1 < end; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
            const auto o = at(begin), p = at(i), q = at(i + 1);
            twice[k] += (p[l] - o[l]) * (q[m] - o[m]) - (p[m] - o[m]) * (q[l] - o[l]);
        }
    }
    return std::sqrt(twice[0] * twice[0] + twice[1] * twice[1] + twice[2] * twice[2]) / 2;
}

double area(const Section& s) {
    double total = 0;
    for (std::size_t i = 0; i < s.cells.size(); ++i)
        total += area(s, i);
    return total;
}

Cut checked_cut(const CellComplex& c, const Plane& plane, bool blocks = false) {
    const Cut cut = cut_by_plane(c, plane, {1, nullptr});
    strata::expect_valid(cut.above, blocks);
    strata::expect_valid(cut.below, blocks);
    for (std::size_t b = 0; b < c.volumes.size(); ++b) {
        EXPECT_NEAR(cut.above.volumes[b] + cut.below.volumes[b], c.volumes[b],
                    1e-12 * (1 + c.volumes[b]));
    }
    EXPECT_NEAR(area(section_by_plane(c, plane, {1, nullptr})), area(cut.section), 1e-12);
    return cut;
}

int count_caps(const CellComplex& c) {
    return static_cast<int>(
        std::count(c.face_surface.begin(), c.face_surface.end(), strata::kCutFace));
}

TEST(PlaneCut, HalvesALayer) {
    const CellComplex c = level_layers({0, 1});
    const Cut cut = checked_cut(c, {{0, 0, 0.25}, {0, 0, 3}});
    EXPECT_DOUBLE_EQ(sum(cut.below.volumes), 1.0);
    EXPECT_DOUBLE_EQ(sum(cut.above.volumes), 3.0);
    EXPECT_DOUBLE_EQ(area(cut.section), 4.0);
    EXPECT_EQ(cut.above.cell_block.size(), c.cell_block.size());
    EXPECT_EQ(cut.section.cells.size(), c.cell_block.size());
    EXPECT_EQ(count_caps(cut.above), count_caps(cut.below));
}

TEST(PlaneCut, RunsAlongASurfaceWithoutCuttingAnyCell) {
    const CellComplex c = level_layers({0, 1, 3});
    const Cut cut = checked_cut(c, {{0, 0, 1}, {0, 0, 1}});
    EXPECT_EQ(cut.below.volumes, (std::vector<double>{0, 4, 0}));
    EXPECT_EQ(cut.above.volumes, (std::vector<double>{0, 0, 8}));
    EXPECT_EQ(cut.below.cell_block.size() + cut.above.cell_block.size(), c.cell_block.size());
    EXPECT_DOUBLE_EQ(area(cut.section), 4.0);
    for (const auto& cells : cut.section.cells) {
        EXPECT_EQ(c.cell_block[static_cast<std::size_t>(cells[0])], 1);
        EXPECT_EQ(c.cell_block[static_cast<std::size_t>(cells[1])], 2);
    }
}

TEST(PlaneCut, RunsThroughGridLinesAndDiagonals) {
    const CellComplex c = level_layers({0, 1}, 4);
    const Cut across = checked_cut(c, {{1, 0, 0}, {1, 0, 0}});
    EXPECT_EQ(across.below.cell_block.size() + across.above.cell_block.size(), c.cell_block.size());
    EXPECT_DOUBLE_EQ(area(across.section), 2.0);
    const Cut diagonal = checked_cut(c, {{0, 0, 0}, {1, -1, 0}});
    EXPECT_EQ(diagonal.below.cell_block.size() + diagonal.above.cell_block.size(),
              c.cell_block.size());
    EXPECT_NEAR(area(diagonal.section), std::sqrt(8.0), 1e-14);
    EXPECT_DOUBLE_EQ(sum(diagonal.above.volumes), 2.0);
}

TEST(PlaneCut, ThroughTwoEdgesOfACube) {
    const Cut cut = checked_cut(level_layers({0, 2}, 1), {{0, 0, 0}, {1, 0, -1}});
    EXPECT_DOUBLE_EQ(sum(cut.above.volumes), 4.0);
    EXPECT_DOUBLE_EQ(sum(cut.below.volumes), 4.0);
    EXPECT_NEAR(area(cut.section), 2 * std::sqrt(8.0), 1e-14);
}

TEST(PlaneCut, BesideTheModelLeavesItWhole) {
    const CellComplex c = level_layers({0, 1});
    for (const double z : {-1.0, 0.0}) {
        const Cut cut = checked_cut(c, {{0, 0, z}, {0, 0, 1}});
        EXPECT_TRUE(cut.below.cell_block.empty());
        EXPECT_EQ(cut.above.vertices.size(), c.vertices.size());
        EXPECT_EQ(cut.above.face_surface, c.face_surface);  // what was outside keeps its code
        EXPECT_DOUBLE_EQ(area(cut.section), z == 0.0 ? 4.0 : 0.0);
    }
}

/// A block whose lower side has a ridge of height 1 in its middle.
CellComplex over_a_ridge(double ends) {
    OwnedSurface floor = grid(
        2, 1, 0, 0, 2, 1, [=](double x, double y) { return x == 1 ? (y == 1 ? ends : 1.0) : 0.0; });
    return strata::merge_columns(
        strata::build({floor, grid(1, 1, 0, 0, 2, 1, [](double, double) { return 2.0; })}));
}

TEST(PlaneCut, ThatTouchesARidgeLeavesACellOnEitherSide) {
    const CellComplex c = over_a_ridge(1.0);
    ASSERT_EQ(c.cell_block.size(), 1u);
    const Cut cut = checked_cut(c, {{0, 0, 1}, {0, 0, 1}}, true);
    EXPECT_EQ(cut.below.cell_block.size(), 2u);
    EXPECT_EQ(cut.above.cell_block.size(), 1u);
    EXPECT_NEAR(sum(cut.below.volumes), 1.0, 1e-15);
    EXPECT_DOUBLE_EQ(area(cut.section), 2.0);
    // upside down the same
    const Cut turned = checked_cut(c, {{0, 0, 1}, {0, 0, -1}}, true);
    EXPECT_EQ(turned.above.cell_block.size(), 2u);
}

TEST(PlaneCut, AboveAValleyThatMeetsItGoesPastIt) {
    // the ground's valley touches the plane from above: nothing is open there
    const OwnedSurface floor = grid(1, 1, 0, 0, 2, 1, [](double, double) { return 0.0; });
    const OwnedSurface ground =
        grid(2, 1, 0, 0, 2, 1, [](double x, double) { return x == 1 ? 1.0 : 2.0; });
    const CellComplex c = strata::merge_columns(strata::build({floor, ground}));
    const Cut cut = checked_cut(c, {{0, 0, 1}, {0, 0, 1}}, true);
    EXPECT_EQ(cut.above.cell_block.size(), 2u);
    EXPECT_EQ(cut.below.cell_block.size(), 1u);
    EXPECT_NEAR(sum(cut.above.volumes), 1.0, 1e-15);
}

TEST(PlaneCut, CellsFallApart) {
    // two humps of one block above the plane
    const OwnedSurface floor = grid(1, 1, 0, 0, 4, 1, [](double, double) { return 0.0; });
    const OwnedSurface ground =
        grid(4, 1, 0, 0, 4, 1, [](double x, double) { return x == 1 || x == 3 ? 2.0 : 0.5; });
    const CellComplex c = strata::merge_columns(strata::build({floor, ground}));
    ASSERT_EQ(c.cell_block.size(), 1u);
    const Cut cut = checked_cut(c, {{0, 0, 1}, {0, 0, 1}}, true);
    EXPECT_EQ(cut.above.cell_block.size(), 2u);
    EXPECT_EQ(cut.above_cells, (std::vector<std::int32_t>{0, 0}));
    EXPECT_EQ(cut.below.cell_block.size(), 1u);
}

TEST(PlaneCut, RoundAHoleTheSectionIsOneRing) {
    // a pit in the ground: the section around it is a ring in convex polygons
    const OwnedSurface floor = grid(1, 1, 0, 0, 4, 4, [](double, double) { return 0.0; });
    const OwnedSurface ground =
        grid(4, 4, 0, 0, 4, 4, [](double x, double y) { return x == 2 && y == 2 ? 1.0 : 3.0; });
    const CellComplex c = strata::merge_columns(strata::build({floor, ground}));
    const Cut cut = checked_cut(c, {{0, 0, 2}, {0, 0, 1}}, true);
    EXPECT_GT(cut.section.cells.size(), 1u);
    EXPECT_EQ(cut.above.cell_block.size(), 1u);
    EXPECT_LT(area(cut.section), 16.0);
    const double pit = 16.0 - area(cut.section);
    EXPECT_NEAR(pit, 0.75, 1e-14);  // a hexagon, half as large as the six triangles round the pit
}

TEST(PlaneCut, TheSameForAnyNumberOfThreads) {
    const auto wave = [](double x, double y) { return std::sin(3 * x) * std::cos(2 * y); };
    const CellComplex c = strata::build(
        {grid(20, 20, 0, 0, 3, 3, wave),
         grid(17, 19, 0, 0, 3, 3, [](double x, double y) { return 0.5 + std::cos(2 * x + y); })});
    const Plane plane{{1.3, 1.1, 0.2}, {1, 2, 0.3}};
    const Cut one = cut_by_plane(c, plane, {1, nullptr});
    const Cut four = cut_by_plane(c, plane, {4, nullptr});
    EXPECT_EQ(one.above.vertices, four.above.vertices);
    EXPECT_EQ(one.above.face_vertices, four.above.face_vertices);
    EXPECT_EQ(one.below.face_cells, four.below.face_cells);
    EXPECT_EQ(one.section.polygon_vertices, four.section.polygon_vertices);
}

TEST(PlaneCut, FarFromTheOriginTheVolumesAddUp) {
    const auto far = [](double x, double y) { return 400 + 3 * std::sin(x) + 2 * std::cos(y); };
    const CellComplex c = strata::build(
        {grid(7, 7, 4.5e6, 5.3e6, 4.5e6 + 30, 5.3e6 + 30, far),
         grid(5, 6, 4.5e6, 5.3e6, 4.5e6 + 30, 5.3e6 + 30, [](double, double) { return 402.0; })});
    const Plane plane{{4.5e6 + 13, 5.3e6 + 11, 401}, {0.3, 0.7, 0.2}};
    const Cut cut = cut_by_plane(c, plane, {1, nullptr});
    strata::expect_valid(cut.above);
    strata::expect_valid(cut.below);
    EXPECT_NEAR(sum(cut.above.volumes) + sum(cut.below.volumes), sum(c.volumes),
                1e-9 * sum(c.volumes));
}

TEST(PlaneCut, CornersOfCapsLieInThePlaneHoweverLongTheEdges) {
    const OwnedSurface floor =
        grid(3, 3, 0, 0, 3, 3, [](double x, double y) { return -1e6 - 1e5 * x - y; });
    const OwnedSurface ground =
        grid(3, 3, 0, 0, 3, 3, [](double x, double y) { return x < 1 ? -7.0 : 2e-6 + 1e-7 * y; });
    const CellComplex c = strata::build({floor, ground});
    for (const double z : {0.0, -0.0, 1e-7}) {
        const Cut cut = checked_cut(c, {{0, 0, z}, {0, 0, 1}});
        EXPECT_FALSE(cut.section.vertices.empty());
        for (const auto& p : cut.section.vertices)
            EXPECT_EQ(p[2], z);
    }
    // the diagonal plane x + z = 1: where x is, z is the nearest double to 1 - x
    const Cut cut = checked_cut(c, {{1, 0, 0}, {1, 0, 1}});
    for (const auto& p : cut.section.vertices)
        EXPECT_NEAR(p[0] + p[2], 1.0, 0x1p-53 * (std::abs(p[0]) + std::abs(p[2])));
}

TEST(PlaneCut, FencePanelEndsWhereItIsToldTo) {
    const CellComplex c = level_layers({0, 1, 3}, 3);
    const Section s = fence_panel(c, {0.5, 1.25}, {1.75, 1.25}, {1, nullptr});
    EXPECT_NEAR(area(s), 1.25 * 3, 1e-14);
    for (const auto& v : s.vertices) {
        EXPECT_DOUBLE_EQ(v[1], 1.25);
        EXPECT_GE(v[0], 0.5);
        EXPECT_LE(v[0], 1.75);
    }
}

TEST(PlaneCut, RefusesPlanesAndModelsThatAreNone) {
    const CellComplex c = level_layers({0, 1});
    const auto kind = [&](const ComplexView& model, const Plane& plane) -> std::string {
        try {
            cut_by_plane(model, plane, {1, nullptr});
        } catch (const InputError& error) {
            return error.kind;
        }
        return "";
    };
    EXPECT_EQ(kind(c, {{0, 0, 0}, {0, 0, 0}}), "bad_plane");
    EXPECT_EQ(kind(c, {{0, 0, NAN}, {0, 0, 1}}), "not_finite");
    ComplexView few = c;
    few.vertices = few.vertices.first(3);
    EXPECT_EQ(kind(few, {{0, 0, 0}, {0, 0, 1}}), "bad_model");
    ComplexView blockless = c;
    blockless.blocks = 0;
    EXPECT_EQ(kind(blockless, {{0, 0, 0}, {0, 0, 1}}), "bad_model");
}

TEST(PlaneCut, Cancels) {
    const CellComplex c = level_layers({0, 1});
    Progress progress;
    progress.cancel();
    EXPECT_THROW(cut_by_plane(c, {{0, 0, 0.5}, {0, 0, 1}}, {1, &progress}), Cancelled);
    EXPECT_THROW(section_by_plane(c, {{0, 0, 0.5}, {0, 0, 1}}, {1, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::cutting
