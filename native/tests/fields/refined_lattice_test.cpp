// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/refined_lattice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::fields {
namespace {

/// f = x + 2 y + 3 z on a lattice of two cells along each axis, with points in it.
struct Linear {
    std::vector<double> values, points, point_values;
    static constexpr Lattice kLattice{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};

    Linear() {
        for (int k = 0; k < 3; ++k) {
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i)
                    values.push_back(i + 2 * j + 3 * k);
            }
        }
    }
    void add(const Vec3& p, double value) {
        points.insert(points.end(), p.begin(), p.end());
        point_values.push_back(value);
    }
    RefinedLattice lattice() const {
        return {{kLattice, values, points, point_values}, std::vector<double>{5.0}};
    }
};

TEST(RefinedLattice, BetweenNodesTheFunctionIsLinear) {
    const RefinedLattice lattice = Linear().lattice();
    EXPECT_EQ(lattice.cells(0), 2);
    EXPECT_NEAR(lattice.at({0.3, 1.2, 0.7}), 0.3 + 2.4 + 2.1, 1e-12);
    EXPECT_TRUE(std::isnan(lattice.at({2.5, 1, 1})));
    const auto found = lattice.located({0.25, 0.5, 0.75});
    ASSERT_TRUE(found);
    double sum = 0;
    for (const double weight : found->weights)
        sum += weight;
    EXPECT_DOUBLE_EQ(sum, 1);
}

TEST(RefinedLattice, CornersLieInTheSidesOfTheBox) {
    Linear linear;
    linear.add({0.5, 2, 0.25}, 3);
    const RefinedLattice lattice = linear.lattice();
    EXPECT_EQ(lattice.box_faces(lattice.node({0, 2, 1})), 1U << 0 | 1U << 4);
    EXPECT_EQ(lattice.box_faces(lattice.node({1, 1, 1})), 0U);
    EXPECT_EQ(lattice.box_faces(27), 1U << 4);  // the point
    EXPECT_EQ(lattice.beyond(0), (Vec3{-1, 1, 1}));
    EXPECT_EQ(lattice.beyond(5), (Vec3{1, 1, 3}));
}

TEST(RefinedLattice, APointDividesTheCellsThatItLiesIn) {
    Linear linear;
    linear.add({0.5, 0.25, 0.125}, 5);  // inside a tetrahedron
    linear.add({1.5, 1.5, 1}, 4);       // on an edge between two cells
    const RefinedLattice lattice = linear.lattice();
    ASSERT_NE(lattice.divided({0, 0, 0}), nullptr);
    EXPECT_EQ(lattice.divided({0, 0, 0})->size(), 6U + 3U);
    EXPECT_NE(lattice.divided({1, 1, 0}), nullptr);
    EXPECT_NE(lattice.divided({1, 1, 1}), nullptr);
    EXPECT_EQ(lattice.divided({0, 1, 0}), nullptr);
    EXPECT_DOUBLE_EQ(lattice.at({0.5, 0.25, 0.125}), 5);
    EXPECT_DOUBLE_EQ(lattice.at({1.5, 1.5, 1}), 4);
}

TEST(RefinedLattice, APointInANodeGivesItItsValue) {
    Linear linear;
    linear.add({1, 1, 1}, 7);
    const RefinedLattice lattice = linear.lattice();
    EXPECT_DOUBLE_EQ(lattice.value(lattice.node({1, 1, 1})), 7);
    EXPECT_DOUBLE_EQ(lattice.at({1, 1, 1}), 7);
}

TEST(RefinedLattice, ALevelPassesThroughAPointBetweenLesserAndGreaterCorners) {
    Linear linear;
    linear.add({0.5, 0.5, 0.5}, 3);
    linear.add({1.5, 1.5, 1.5}, 100);  // above all around it
    const RefinedLattice lattice = linear.lattice();
    EXPECT_TRUE(lattice.is_between(0));
    EXPECT_FALSE(lattice.is_between(1));
}

TEST(RefinedLattice, RefusesPointsOutsideAndTwoValuesInOnePlace) {
    Linear outside, twice;
    outside.add({3, 1, 1}, 0);
    twice.add({0.5, 0.5, 0.5}, 1);
    twice.add({0.5, 0.5, 0.5}, 2);
    for (const auto& [linear, kind] :
         {std::pair(&outside, "outside"), std::pair(&twice, "two_values")}) {
        try {
            linear->lattice();
            FAIL();
        } catch (const InputError& e) {
            EXPECT_EQ(e.kind, kind);
        }
    }
}

}  // namespace
}  // namespace realmodel::fields
