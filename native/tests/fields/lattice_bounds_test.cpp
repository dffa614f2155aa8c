// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include "fields/lattice_values.hpp"

namespace realmodel::fields {
namespace {

const Lattice kSmallLattice{{0, 0, 0}, {1, 1, 1}, {4, 4, 4}};

/// z at all nodes, and bounds of the level 1.5.
class LatticeBounds : public testing::Test {
protected:
    LatticeBounds() {
        for (int n = 0; n < 64; ++n)
            values.push_back(n / 16);
    }

    void add(const Vec3& at, bool is_above) {
        places.push_back(at);
        below.push_back(is_above ? 0 : -1);
        above.push_back(is_above ? -1 : 0);
    }

    void keep(std::vector<char> kept) {
        FieldData data;
        data.surfaces = 1;
        data.bounds = places;
        data.bound_below = below;
        data.bound_above = above;
        keep_bounds(kSmallLattice, data, kept, levels, values);
    }

    double at(const Vec3& p) const {
        double sum = 0;
        for (const auto& [node, weight] : corners_at(kSmallLattice, p))
            sum += weight * values[node];
        return sum;
    }

    std::vector<double> values, levels{1.5};
    std::vector<Vec3> places;
    std::vector<std::int32_t> below, above;
};

TEST_F(LatticeBounds, ValuesMoveOnlyBesideBoundsThatDoNotHold) {
    add({0.3, 0.4, 1.2}, true);
    add({2.5, 2.4, 1.9}, false);
    add({0.3, 2.4, 2.2}, true);  // holds
    const std::vector<double> before = values;
    keep({1, 1, 1});
    EXPECT_GE(at(places[0]), 1.5);
    EXPECT_LE(at(places[1]), 1.5);
    EXPECT_NEAR(at(places[0]), 1.5, 1e-6);
    EXPECT_NEAR(at(places[1]), 1.5, 1e-6);
    std::size_t moved = 0;
    for (std::size_t n = 0; n < values.size(); ++n)
        moved += values[n] != before[n] ? 1 : 0;
    EXPECT_EQ(moved, 8U);
}

TEST_F(LatticeBounds, ThoseOfOneTetrahedronHoldTogether) {
    add({0.6, 0.4, 1.2}, true);
    add({0.7, 0.4, 1.3}, false);
    add({0.6, 0.5, 1.3}, true);
    keep({1, 1, 1});
    EXPECT_GE(at(places[0]), 1.5);
    EXPECT_LE(at(places[1]), 1.5);
    EXPECT_GE(at(places[2]), 1.5);
}

TEST_F(LatticeBounds, ThoseThatAreLeftOutMoveNothing) {
    add({0.3, 0.4, 0.2}, true);
    const std::vector<double> before = values;
    keep({0});
    EXPECT_EQ(values, before);
}

}  // namespace
}  // namespace realmodel::fields
