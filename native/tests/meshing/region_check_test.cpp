// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/region_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {
namespace {

Ring box(double x, double y, double size) {
    return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
}

double area_of(const std::vector<Ring>& rings) {
    const PlanarMesh mesh = triangulate_rings(rings);
    double area = 0;
    for (const auto& [i, j, k] : mesh.triangles) {
        const PlanPoint &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
        area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    return area;
}

std::string verdict(const std::vector<RegionRing>& rings) {
    try {
        (void)checked_region(rings);
        return "accepted";
    } catch (const InputError& error) {
        return error.kind;
    }
}

TEST(RegionCheck, RingsThatShareNothingComeBackAsTheyAre) {
    const std::vector<RegionRing> rings{{box(0, 0, 9), 0, false},
                                        {box(1, 1, 2), 0, true},
                                        {box(20, 0, 3), 1, false},
                                        {box(9, 9, 1), 2, false}};
    const std::vector<Ring> checked = checked_region(rings);
    ASSERT_EQ(checked.size(), rings.size());
    for (std::size_t i = 0; i < rings.size(); ++i)
        EXPECT_EQ(checked[i], rings[i].corners);
}

/// All cells of a chess board that are chosen at random, each a polygon: their union.
TEST(RegionCheck, NeighborsDissolve) {
    std::mt19937 random(1);
    for (int round = 0; round < 60; ++round) {
        std::vector<RegionRing> rings;
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 6; ++j) {
                if (random() % 2 == 0) continue;
                Ring ring = box(i, j, 1);
                if (random() % 2 == 0) std::reverse(ring.begin(), ring.end());
                if (random() % 2 == 0) ring.insert(ring.begin() + 1, {ring[0][0], ring[0][1]});
                rings.push_back({ring, static_cast<std::int32_t>(rings.size()), false});
            }
        }
        if (rings.empty()) continue;
        const std::vector<Ring> checked = checked_region(rings);
        EXPECT_NEAR(area_of(checked), static_cast<double>(rings.size()), 1e-12);
        EXPECT_NO_THROW(triangulate_region(checked));  // they touch in points at most
    }
}

TEST(RegionCheck, NeighborsWithCornersOnEachOthersEdges) {
    const std::vector<Ring> checked = checked_region(std::vector<RegionRing>{
        {box(0, 0, 4), 0, false}, {box(4, 1, 2), 1, false}, {{{1, 4}, {3, 4}, {2, 6}}, 2, false}});
    EXPECT_EQ(checked.size(), 1u);
    EXPECT_NEAR(area_of(checked), 16 + 4 + 2, 1e-12);
}

TEST(RegionCheck, Verdicts) {
    const Ring outline = box(0, 0, 9);
    EXPECT_EQ(verdict({{outline, 0, false}, {box(1, 1, 3), 0, true}, {box(2, 2, 1), 0, true}}),
              "accepted");
    EXPECT_EQ(verdict({{box(2, 2, 1), 0, true}, {outline, 0, false}}), "accepted");
    EXPECT_EQ(verdict({{outline, 0, false}, {box(10, 0, 1), 0, true}}), "hole_outside");
    EXPECT_EQ(verdict({{outline, 0, false}, {box(9, 9, 1), 0, true}}), "hole_outside");
    EXPECT_EQ(verdict({{box(1, 1, 1), 0, false}, {outline, 0, true}}), "hole_outside");
    EXPECT_EQ(verdict({{outline, 0, false}, {box(20, 0, 5), 1, false}, {box(21, 1, 1), 0, true}}),
              "hole_outside");
    EXPECT_EQ(verdict({{outline, 0, false}, {box(8, 8, 3), 0, true}}), "outline_crosses");
    EXPECT_EQ(verdict({{outline, 0, false}, {box(8, 8, 3), 1, false}}), "outline_crosses");
    EXPECT_EQ(verdict({{outline, 0, false}, {box(0, 0, 2), 0, true}}), "outline_overlaps");
    EXPECT_EQ(verdict({{outline, 0, false}, {outline, 1, false}}), "no_area");
    EXPECT_EQ(verdict({{outline, 0, false}, {{{1, 1}, {2, 2}, {3, 3}}, 0, true}}),
              "outline_degenerate");
    EXPECT_EQ(verdict({{outline, 0, false}, {{{1, 1}, {2, NAN}, {3, 3}}, 0, true}}), "not_finite");
    EXPECT_EQ(verdict({}), "no_outline");
}

}  // namespace
}  // namespace realmodel::meshing
