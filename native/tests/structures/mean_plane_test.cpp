// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "structures/structure_cutter.hpp"

namespace realmodel::structures {
namespace {

using cutting::Cutter;
using cutting::NodeId;
using cutting::Position;
using Border = std::vector<std::array<NodeId, 2>>;

/// The unit square in the plane z = 0, one corner raised.
Cutter square(double raised) {
    return {{{0, 0, 0}, {1, 0, 0}, {1, 1, raised}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, false};
}
const Border kAround{{0, 1}, {1, 2}, {2, 3}, {3, 0}};

double area(const std::vector<std::array<Position, 3>>& triangles) {
    double sum = 0;
    for (const auto& t : triangles)
        sum += ((t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) -
                (t[1][1] - t[0][1]) * (t[2][0] - t[0][0])) /
               2;
    return sum;
}

TEST(MeanPlane, AFlatFaultIsContinuedInItsPlane) {
    const std::vector<double> lengths{10};
    const auto found = continued_in_mean_plane(square(0), kAround, lengths);
    ASSERT_TRUE(found);
    double farthest = 0;
    for (const auto& t : *found) {
        for (const Position& p : t) {
            EXPECT_EQ(p[2], 0);
            farthest = std::max({farthest, std::abs(p[0]), std::abs(p[1])});
        }
    }
    EXPECT_GE(farthest, 10);
    // all of a rectangle but the fault, each position once
    std::array<double, 2> low{0, 0}, high{0, 0};
    for (const auto& t : *found) {
        for (const Position& p : t) {
            for (std::size_t k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
        }
    }
    EXPECT_NEAR(std::abs(area(*found)), (high[0] - low[0]) * (high[1] - low[1]) - 1, 1e-9);
}

TEST(MeanPlane, ARaggedBorderIsKept) {
    const std::vector<double> lengths{10};
    const auto found = continued_in_mean_plane(square(0.1), kAround, lengths);
    ASSERT_TRUE(found);
    for (const Position& corner : square(0.1).vertices) {
        bool is_there = false;
        for (const auto& t : *found)
            is_there |= std::ranges::find(t, corner) != t.end();
        EXPECT_TRUE(is_there);
    }
}

TEST(MeanPlane, ABorderThatCrossesItselfHasNoContinuation) {
    const Border crossing{{0, 1}, {1, 3}, {3, 2}, {2, 0}};
    EXPECT_FALSE(continued_in_mean_plane(square(0), crossing, std::vector<double>{10}));
}

TEST(MeanPlane, ABorderThatGapesHasNoContinuation) {
    const Border open{{0, 1}, {1, 2}, {2, 3}};
    EXPECT_FALSE(continued_in_mean_plane(square(0), open, std::vector<double>{10}));
    Cutter passed = square(0);  // a side through a vertex of another part
    passed.vertices.insert(passed.vertices.end(), {{0.5, 0, 0}, {0.4, -1, 0}, {0.6, -1, 0}});
    passed.triangles.push_back({5, 6, 4});
    Border through = kAround;
    through.insert(through.end(), {{5, 6}, {6, 4}, {4, 5}});
    EXPECT_FALSE(continued_in_mean_plane(passed, through, std::vector<double>{10}));
}

TEST(MeanPlane, ABorderTheWrongWayHasNoContinuation) {
    const Border backward{{1, 0}, {2, 1}, {3, 2}, {0, 3}};
    EXPECT_FALSE(continued_in_mean_plane(square(0), backward, std::vector<double>{10}));
}

}  // namespace
}  // namespace realmodel::structures
