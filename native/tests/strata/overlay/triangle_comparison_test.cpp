// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {
namespace {

/// Triangles over the plan, made of positions.
struct Triangles {
    exact::PlanArrangement geometry;

    PlaneId add(const std::array<std::array<double, 3>, 3>& position) {
        std::array<exact::SpaceId, 3> corner;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [x, y, z] = position[i];
            corner[i] = geometry.add_space_vertex(geometry.add_vertex(x, y), z);
        }
        return geometry.add_plane(corner);
    }
    /// The lower left half of the unit square at z = height + slope x.
    PlaneId add_half(double height, double slope = 0) {
        return add({{{0, 0, height}, {1, 0, height + slope}, {0, 1, height}}});
    }
    Comparison compare(PlaneId lower, PlaneId upper) const {
        return compare_over(geometry, lower, upper, bounds_of(geometry, lower).box,
                            bounds_of(geometry, upper).box, 1e-9);
    }
};

TEST(TriangleComparison, BoundsAreThoseOfTheCorners) {
    Triangles t;
    const PlaneId plane = t.add({{{0, 1, 5}, {3, 2, -1}, {1, 7, 4}}});
    t.geometry.freeze_vertices();
    const TriangleBounds found = bounds_of(t.geometry, plane);
    EXPECT_EQ(found.box.low_x, 0);
    EXPECT_EQ(found.box.low_y, 1);
    EXPECT_EQ(found.box.high_x, 3);
    EXPECT_EQ(found.box.high_y, 7);
    EXPECT_EQ(found.low, -1);
    EXPECT_EQ(found.high, 5);
}

TEST(TriangleComparison, SortsWhatIsHigherAllOver) {
    Triangles t;
    // heights overlap, but not over one position
    const PlaneId low = t.add_half(0, 2), high = t.add_half(1, 2);
    t.geometry.freeze_vertices();
    EXPECT_EQ(t.compare(low, high), Comparison::kBelow);
    EXPECT_EQ(t.compare(high, low), Comparison::kAbove);
}

TEST(TriangleComparison, LeavesOpenWhatCrossesOrTouches) {
    Triangles t;
    const PlaneId flat = t.add_half(0), crossing = t.add_half(-0.5, 1), touching = t.add_half(0, 1);
    t.geometry.freeze_vertices();
    EXPECT_EQ(t.compare(flat, crossing), Comparison::kUnclear);
    EXPECT_EQ(t.compare(flat, touching), Comparison::kUnclear);
}

TEST(TriangleComparison, ComparesNothingThatLiesApart) {
    Triangles t;
    const PlaneId lower_left = t.add_half(0);
    const PlaneId upper_right = t.add({{{1, 1, 0}, {0.3, 1, 0}, {1, 0.3, 0}}});
    const PlaneId corner = t.add({{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}}});
    t.geometry.freeze_vertices();
    EXPECT_EQ(t.compare(lower_left, upper_right), Comparison::kApart);
    EXPECT_TRUE(are_apart(t.geometry, lower_left, upper_right));
    EXPECT_FALSE(are_apart(t.geometry, lower_left, corner));  // they share a corner
}

TEST(TriangleComparison, TellsPositionsInsideFromThoseOutside) {
    Triangles t;
    const PlaneId plane = t.add_half(0);
    t.geometry.freeze_vertices();
    const PlanTriangle& plan = t.geometry.plane(plane).plan;
    EXPECT_EQ(side_of_border(t.geometry, plan, {0.25, 0.25}), 1);
    EXPECT_EQ(side_of_border(t.geometry, plan, {0.75, 0.75}), -1);
    EXPECT_EQ(side_of_border(t.geometry, plan, {0.5, 0.5}), 0);
    EXPECT_EQ(side_of_border(t.geometry, plan, {0.0, 0.0}), 0);
}

}  // namespace
}  // namespace realmodel::strata
