// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <optional>

#include "../sanitized.hpp"
#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {
namespace {

using strata::box;
using strata::CellComplex;
using strata::grid;
using strata::OwnedSurface;

TriangleView view(const OwnedSurface& s) {
    return {s.vertices, s.triangles};
}

CellComplex sized_layers(const std::vector<double>& heights, double size = 2, int n = 2) {
    std::vector<OwnedSurface> surfaces;
    for (const double z : heights)
        surfaces.push_back(grid(n, n, 0, 0, size, size, [z](double, double) { return z; }));
    return strata::build(surfaces);
}

double total(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

Cut checked(const CellComplex& c, const Cut& cut) {
    strata::expect_valid(cut.above, cut.above_touches);
    strata::expect_valid(cut.below, cut.below_touches);
    for (std::size_t b = 0; b < c.volumes.size(); ++b) {
        EXPECT_NEAR(cut.above.volumes[b] + cut.below.volumes[b], c.volumes[b],
                    1e-12 * (1 + c.volumes[b]));
    }
    return cut;
}

Cut checked_cut(const CellComplex& c, const OwnedSurface& s) {
    return checked(c, cut_by_surface(c, view(s), {1, nullptr}));
}

std::string refusal(const CellComplex& c, const OwnedSurface& s) {
    try {
        cut_by_surface(c, view(s), {1, nullptr});
    } catch (const InputError& error) {
        return error.kind;
    }
    return "";
}

TEST(SurfaceCut, ALevelSurfaceHalvesALayer) {
    const CellComplex c = sized_layers({0, 1});
    const Cut cut = checked_cut(c, grid(3, 1, -1, -1, 4, 5, [](double, double) { return 0.25; }));
    EXPECT_DOUBLE_EQ(total(cut.below.volumes), 1.0);
    EXPECT_DOUBLE_EQ(total(cut.above.volumes), 3.0);
}

TEST(SurfaceCut, WhichWayTrianglesTurnDoesNotMatter) {
    const CellComplex c = sized_layers({0, 1});
    OwnedSurface s = grid(2, 2, -1, -1, 4, 5, [](double x, double) { return 0.5 + x / 16; });
    for (std::size_t t = 0; t < s.triangles.size(); t += 9)
        std::swap(s.triangles[t], s.triangles[t + 1]);
    const Cut cut = checked_cut(c, s);
    EXPECT_NEAR(total(cut.below.volumes), 4 * (0.5 + 1.0 / 16), 1e-14);
}

TEST(SurfaceCut, AFoldedSurfaceCutsWhereItPasses) {
    const CellComplex c = sized_layers({0, 1, 2}, 3, 3);
    // a roof with its ridge at x = 1, height 1.75; eaves at x = -1 and 4
    OwnedSurface roof;
    for (const double y : {-1.0, 4.0}) {
        roof.vertex(-1, y, -0.25);
        roof.vertex(1, y, 1.75);
        roof.vertex(4, y, 0.25);
    }
    for (std::int32_t i = 0; i < 2; ++i) {
        roof.triangle(i, i + 1, i + 4);
        roof.triangle(i, i + 4, i + 3);
    }
    const Cut cut = checked_cut(c, roof);
    const double below = 3 * ((0.75 + 1.75) / 2 + 2 * (1.75 + 0.75) / 2);
    EXPECT_NEAR(total(cut.below.volumes), below, 1e-13);
}

TEST(SurfaceCut, AVerticalFaultPartsTheModel) {
    const CellComplex c = sized_layers({0, 1, 3});
    OwnedSurface fault;
    fault.vertex(0.5, -1, -1);
    fault.vertex(0.5, 3, -1);
    fault.vertex(0.5, 3, 4);
    fault.vertex(0.5, -1, 4);
    fault.triangle(0, 1, 2);
    fault.triangle(0, 2, 3);
    const Cut cut = checked_cut(c, fault);
    const double smaller = std::min(total(cut.above.volumes), total(cut.below.volumes));
    EXPECT_DOUBLE_EQ(smaller, 0.5 * 2 * 3);
}

TEST(SurfaceCut, AlongASurfaceOfTheModelNoCellIsCut) {
    const CellComplex c = sized_layers({0, 1, 3}, 2, 4);
    const Cut cut = checked_cut(c, grid(
                                       3, 3, 0, 0, 2, 2, [](double, double) { return 1.0; }, true));
    EXPECT_EQ(cut.below.cell_block.size() + cut.above.cell_block.size(), c.cell_block.size());
    EXPECT_DOUBLE_EQ(total(cut.below.volumes), 4.0);
    for (const auto& cells : cut.section.cells)
        EXPECT_NE(cells[0], cells[1]);
}

TEST(SurfaceCut, AClosedSurfaceWithinACellLeavesAHollow) {
    const CellComplex c = strata::merge_columns(sized_layers({0, 3}, 3, 1));
    const OwnedSurface s = box({1, 1, 1}, {2, 2, 2});
    const Cut cut = checked(c, cut_by_surface(c, view(s), {1, nullptr}));
    EXPECT_EQ(cut.below.cell_block.size(), 1u);
    EXPECT_EQ(cut.above.cell_block.size(), 1u);
    EXPECT_DOUBLE_EQ(total(cut.below.volumes), 1.0);
    EXPECT_DOUBLE_EQ(total(cut.above.volumes), 26.0);
}

TEST(SurfaceCut, ABoxAcrossCornersAndFaces) {
    const CellComplex c = sized_layers({0, 1, 2}, 2, 2);
    EXPECT_DOUBLE_EQ(total(checked_cut(c, box({1, 1, 1}, {2, 2, 2})).below.volumes), 1.0);
    EXPECT_DOUBLE_EQ(total(checked_cut(c, box({0.5, 0.5, 0.5}, {3, 3, 3})).below.volumes),
                     1.5 * 1.5 * 1.5);
    EXPECT_DOUBLE_EQ(total(checked_cut(c, box({-1, -1, -1}, {3, 3, 3})).below.volumes), 8.0);
    EXPECT_DOUBLE_EQ(total(checked_cut(c, box({5, 5, 5}, {6, 6, 6})).below.volumes), 0.0);
}

OwnedSurface joined(const OwnedSurface& one, const OwnedSurface& other) {
    OwnedSurface both = one;
    const auto first = static_cast<std::int32_t>(one.vertices.size() / 3);
    both.vertices.insert(both.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const std::int32_t v : other.triangles)
        both.triangles.push_back(first + v);
    return both;
}

TEST(SurfaceCut, OfClosedShellsInsideIsWhatAnOddNumberIsRound) {
    const CellComplex c = sized_layers({0, 1, 4}, 4, 3);
    const OwnedSurface outer = box({0.5, 0.5, 0.5}, {3.5, 3.5, 3.5});
    EXPECT_DOUBLE_EQ(total(checked_cut(c, joined(outer, box({1, 1, 1}, {2, 2, 2}))).below.volumes),
                     26.0);  // a hollow
    EXPECT_DOUBLE_EQ(
        total(checked_cut(c, joined(box({1, 1, 1}, {2, 2, 2}), box({2, 1, 1}, {3, 2, 2})))
                  .below.volumes),
        2.0);  // a wall in common
    EXPECT_DOUBLE_EQ(
        total(checked_cut(c, joined(box({1, 1, 1}, {2, 2, 2}), box({2, 2, 1}, {3, 3, 2})))
                  .below.volumes),
        2.0);  // an edge in common
    EXPECT_DOUBLE_EQ(
        total(checked_cut(c, joined(box({1, 1, 1}, {3, 3, 3}), box({2, 2, 2}, {4, 4, 4})))
                  .below.volumes),
        14.0);  // they cross
}

TEST(SurfaceCut, BordersThatRunAlongOneAnotherAreJoined) {
    // one long edge against two short ones, whose common corner is off the line by rounding
    const CellComplex c = sized_layers({0, 1}, 3, 3);
    OwnedSurface bricks;
    bricks.vertex(-1, -1, 0.1);
    bricks.vertex(4, -1, 0.2);
    bricks.vertex(4, 1.1, 0.3);
    bricks.vertex(-1, 1.1, 0.7);
    bricks.triangle(0, 1, 2);
    bricks.triangle(0, 2, 3);
    const double share = 1.0 / 3;
    bricks.vertex(-1 + 5 * share, 1.1, 0.7 + (0.3 - 0.7) * share);
    bricks.vertex(1, 4, 0.4);
    bricks.vertex(5, 4, 0.4);
    bricks.vertex(-2, 4, 0.4);
    bricks.triangle(3, 4, 7);
    bricks.triangle(4, 5, 7);
    bricks.triangle(4, 2, 5);
    bricks.triangle(2, 6, 5);
    const Cut cut = checked_cut(c, bricks);
    EXPECT_GT(total(cut.below.volumes), 2.0);
    EXPECT_LT(total(cut.below.volumes), 7.0);
}

TEST(SurfaceCut, ASurfaceThatIsThereTwiceCutsOnce) {
    const CellComplex c = sized_layers({0, 1});
    const OwnedSurface s = grid(2, 2, -1, -1, 3, 3, [](double x, double) { return 0.5 + x / 8; });
    EXPECT_DOUBLE_EQ(total(checked_cut(c, joined(s, s)).below.volumes),
                     total(checked_cut(c, s).below.volumes));
}

TEST(SurfaceCut, AModelWhoseFacesCrossByRoundingIsCut) {
    // the middle layer is two units in the last place thick, and its top crosses its bottom
    CellComplex c = sized_layers({0, 0.5, 1}, 2, 2);
    for (auto& p : c.vertices) {
        if (p[2] != 0.5) continue;
        p[2] = p[0] < 1.5 ? 0.5 : 1.0 + 0x1p-52;
    }
    for (const double z : {0.25, 0.5, 0.75, 1.0}) {
        const Cut cut = cut_by_surface(
            c, view(grid(1, 1, -1, -1, 3, 3, [z](double, double) { return z; })), {1, nullptr});
        strata::expect_valid(cut.above, true);
        strata::expect_valid(cut.below, true);
    }
}

TEST(SurfaceCut, TheSameForAnyNumberOfThreads) {
    const auto wavy = [](double height) {
        return [height](double x, double y) { return height + 0.4 * std::sin(9 * x + 5 * y); };
    };
    const CellComplex c =
        strata::build({grid(17, 17, 0, 0, 1, 1, wavy(0)), grid(16, 16, 0, 0, 1, 1, wavy(0.3)),
                       grid(18, 18, 0, 0, 1, 1, wavy(0.5))});
    // more triangles than one thread takes at once, some of them in planes of the model's walls
    const OwnedSurface cutter = grid(20, 20, -0.1, -0.1, 1.2, 1.2, wavy(0.25));
    const OwnedSurface shaft = box({0.25, 0.25, -2}, {0.5, 0.75, 2});
    for (const OwnedSurface& s : {cutter, shaft}) {
        const Cut one = cut_by_surface(c, view(s), {1, nullptr});
        const Cut four = cut_by_surface(c, view(s), {4, nullptr});
        for (const auto half : {&Cut::below, &Cut::above}) {
            EXPECT_TRUE(std::ranges::equal((one.*half).vertices, (four.*half).vertices));
            EXPECT_TRUE(std::ranges::equal((one.*half).face_vertices, (four.*half).face_vertices));
            EXPECT_TRUE(std::ranges::equal((one.*half).face_cells, (four.*half).face_cells));
        }
        EXPECT_EQ(one.section.vertices, four.section.vertices);
        EXPECT_EQ(one.section.polygon_vertices, four.section.polygon_vertices);
    }
}

TEST(SurfaceCut, ANeedleTipThatEndsOnTheOutsideButForRoundingCuts) {
    constexpr double kFar = 4e6, kUnit = 0x1p-31;  // what coordinates are, and their last place
    for (const double width : {1.0, 0.05}) {
        for (const double inside : {0.0, kUnit, 2 * kUnit}) {
            const auto needle = [width](double z, double tip) {
                OwnedSurface s;
                s.vertex(kFar + tip, kFar, z);
                s.vertex(kFar + 4, kFar - width, z);
                s.vertex(kFar + 4, kFar + width, z);
                s.triangle(0, 1, 2);
                return s;
            };
            const CellComplex c = strata::build({needle(0, 0), needle(1, 0)});
            const Cut cut = cut_by_surface(c, view(needle(0.25, inside)), {1, nullptr});
            EXPECT_NEAR(total(cut.below.volumes), width, 1e-6);
            EXPECT_NEAR(total(cut.above.volumes), 3 * width, 1e-6);
        }
    }
}

TEST(SurfaceCut, BesideTheModelTheNearestSideCounts) {
    const CellComplex c = sized_layers({0, 1});
    for (const double z : {-1.0, 2.0}) {
        const Cut cut = checked_cut(c, grid(1, 1, -1, -1, 3, 3, [z](double, double) { return z; }));
        EXPECT_DOUBLE_EQ(total(z < 0 ? cut.above.volumes : cut.below.volumes), 4.0);
    }
}

TEST(SurfaceCut, BlocksOfItsOwnAndOfAnotherModel) {
    const CellComplex c = sized_layers({0, 1, 3}, 2, 3);
    const Cut own = checked(c, cut_by_block(c, c, 1, {1, nullptr}));
    EXPECT_EQ(own.below.volumes, (std::vector<double>{0, 4, 0}));
    EXPECT_EQ(own.below.cell_block.size() + own.above.cell_block.size(), c.cell_block.size());
    const CellComplex other = sized_layers({0.5, 2}, 1, 2);
    const Cut cut = checked(c, cut_by_block(c, other, 1, {1, nullptr}));
    EXPECT_DOUBLE_EQ(cut.below.volumes[1], 0.5);
    EXPECT_DOUBLE_EQ(cut.below.volumes[2], 1.0);
}

TEST(SurfaceCut, RefusesWhatDoesNotPartTheModel) {
    const CellComplex c = sized_layers({0, 1});
    EXPECT_EQ(refusal(c, grid(1, 1, -1, -1, 1, 3, [](double, double) { return 0.5; })),
              "ends_inside");
    OwnedSurface strip;  // a Moebius strip
    for (int i = 0; i < 6; ++i) {
        strip.vertex(std::cos(i), std::sin(i), i % 2);
        strip.triangle(i, (i + 1) % 6, (i + 2) % 6);
    }
    strip.triangles.resize(9);
    strip.triangles.insert(strip.triangles.end(), {3, 4, 0, 4, 0, 1, 0, 1, 2});
    EXPECT_NE(refusal(c, strip), "");
    OwnedSurface branching = grid(1, 1, -1, -1, 3, 3, [](double, double) { return 0.5; });
    const std::int32_t top = branching.vertex(0, 0, 3);
    branching.triangle(0, 2, top);
    branching.triangle(0, 3, top);
    EXPECT_EQ(refusal(c, branching), "branching");
    const auto level = [](double z) {
        return grid(1, 1, -1, -1, 3, 3, [z](double, double) { return z; });
    };
    EXPECT_EQ(refusal(c, joined(level(0.25), level(0.5))), "two_sides");
    EXPECT_EQ(refusal(c, OwnedSurface{}), "no_triangles");
    OwnedSurface wrong = box({0, 0, 0}, {1, 1, 1});
    wrong.triangles[0] = 9;
    EXPECT_EQ(refusal(c, wrong), "bad_index");
    wrong = box({0, 0, 0}, {1, 1, NAN});
    EXPECT_EQ(refusal(c, wrong), "not_finite");
}

TEST(SurfaceCut, ALargeModelGivesTheSameHalvesOnAnyNumberOfThreads) {
    const CellComplex c = sized_layers({0, 1, 2}, 10, 60);  // more faces than one thread takes
    ASSERT_GT(c.face_cells.size(), 40000U);
    const OwnedSurface sheet = grid(7, 7, -1, -1, 11, 11, [](double x, double y) {
        return 0.7 + 0.04 * x + 0.3 * std::sin(x + 2 * y);
    });
    std::optional<Cut> first;
    for (const int threads : {1, 2, 5}) {
        if (kSanitized && threads != 5) continue;
        const Cut cut = cut_by_surface(c, view(sheet), {threads, nullptr});
        for (const CellComplex* half : {&cut.below, &cut.above}) {
            // vertices are numbered in the order in which they come up
            std::int32_t next = 0;
            for (const std::int32_t v : half->face_vertices) {
                ASSERT_LE(v, next);
                next += v == next ? 1 : 0;
            }
            EXPECT_EQ(static_cast<std::size_t>(next), half->vertices.size());
        }
        if (!first) first = cut;
        for (const auto& [one, other] :
             {std::pair(&first->below, &cut.below), std::pair(&first->above, &cut.above)}) {
            EXPECT_EQ(one->vertices, other->vertices);
            EXPECT_EQ(one->face_offsets, other->face_offsets);
            EXPECT_EQ(one->face_vertices, other->face_vertices);
            EXPECT_EQ(one->face_cells, other->face_cells);
            EXPECT_EQ(one->face_surface, other->face_surface);
            EXPECT_EQ(one->cell_block, other->cell_block);
        }
        EXPECT_EQ(first->section.polygon_vertices, cut.section.polygon_vertices);
        EXPECT_EQ(first->above_cells, cut.above_cells);
    }
    if (!kSanitized) checked(c, *first);
}

}  // namespace
}  // namespace realmodel::cutting
