// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "interpolation/dsi/smooth_system.hpp"

namespace realmodel::interpolation {
namespace {

using Relation = Constraint::Relation;

TEST(Constraint, ValuesAndViolations) {
    const Vector z{1, 2, 4};
    const Constraint inside{{0, 1, 2}, {0.5, 0.25, 0.25}, 2, Relation::kEqual, 3};
    EXPECT_EQ(inside.value(z), 2);
    EXPECT_EQ(inside.violation(z), 1);
    EXPECT_EQ(inside.next_multiplier(z), 2);
    EXPECT_EQ(inside.corners(), 3U);
    const std::vector<PlanPosition> nodes{{0, 0}, {4, 0}, {0, 8}};
    EXPECT_EQ(inside.position(nodes), (PlanPosition{1, 2}));

    const Constraint low = Constraint::at_node(1, 2, Relation::kLeast, 1.5);
    EXPECT_EQ(low.value(z), 2);
    EXPECT_EQ(low.violation(z), 0);
    EXPECT_EQ(low.next_multiplier(z), 0);
    EXPECT_EQ(low.position(nodes), (PlanPosition{4, 0}));
    EXPECT_TRUE(low.of_node);
    const Constraint high = Constraint::at_node(2, 2, Relation::kMost, 3);
    EXPECT_EQ(high.violation(z), 1);
    EXPECT_EQ(high.next_multiplier(z), -2);
    Constraint met = Constraint::at_node(2, 2, Relation::kMost, 5);
    met.multiplier = -1.5;
    EXPECT_EQ(met.next_multiplier(z), 0);  // -1.5 + 2 is not below 0
}

TEST(Constraint, ARiseIsTheDifferenceAlongAVector) {
    const Vector z{1, 2, 4};
    // Of the triangle (0, 0), (4, 0), (0, 8) along (1, 0), whose first weight may be anything.
    Constraint rise{{0, 1, 2}, {-0.25, 0.25, 0}, 2, Relation::kEqual, 1};
    EXPECT_FALSE(rise.is_rise());
    rise.along = {1, 0};
    EXPECT_TRUE(rise.is_rise());
    EXPECT_EQ(rise.value(z), 0.25);
    EXPECT_EQ(rise.violation(z), 0.75);
    EXPECT_EQ(rise.position(std::vector<PlanPosition>{{0, 0}, {6, 0}, {0, 9}}),
              (PlanPosition{2, 3}));
    rise.weights = {1, -1, 0};
    EXPECT_EQ(rise.corners(), 3U);
    EXPECT_EQ(rise.value(z), -1);
}

}  // namespace
}  // namespace realmodel::interpolation
