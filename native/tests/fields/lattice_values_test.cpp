// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/lattice_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace realmodel::fields {
namespace {

double cubic(const Vec3& p) {
    return 1 + p[0] * p[1] - 2 * p[2] * p[2] * p[2] + p[0] * p[2] * p[2] - p[1] * p[1] * p[1];
}

void cubic_at(std::span<const Vec3> positions, std::span<double> values) {
    std::transform(positions.begin(), positions.end(), values.begin(), cubic);
}

/// Small, and large with even, odd and few counts.
const Lattice kSmall{{-1, 0, 2}, {0.1, 0.2, 0.3}, {9, 8, 7}};
const Lattice kLarge{{-1, -1, -1}, {0.02, 0.03, 0.4}, {250, 201, 5}};
const Lattice kOdd{{-1, -1, -1}, {0.03, 0.03, 0.04}, {67, 64, 61}};

TEST(LatticeValues, CubicPolynomialsAreExact) {
    for (const Lattice& lattice : {kSmall, kLarge, kOdd}) {
        const std::vector<double> values = lattice_values(lattice, cubic_at, {});
        ASSERT_EQ(values.size(), lattice.nodes());
        std::size_t n = 0;
        for (int k = 0; k < lattice.counts[2]; ++k) {
            for (int j = 0; j < lattice.counts[1]; ++j) {
                for (int i = 0; i < lattice.counts[0]; ++i)
                    ASSERT_NEAR(values[n++], cubic(lattice.position(i, j, k)), 1e-10)
                        << i << " " << j << " " << k;
            }
        }
    }
}

TEST(LatticeValues, ALargeLatticeTakesAnEighthOfTheEvaluations) {
    std::size_t evaluated = 0;
    const auto count = [&](std::span<const Vec3> positions, std::span<double> values) {
        evaluated += positions.size();
        cubic_at(positions, values);
    };
    lattice_values(kOdd, count, {1, nullptr});
    EXPECT_LT(evaluated, kOdd.nodes() / 7);
    evaluated = 0;
    lattice_values(kSmall, count, {1, nullptr});
    EXPECT_EQ(evaluated, kSmall.nodes());
}

TEST(LatticeValues, TheSameForAnyNumberOfThreads) {
    EXPECT_EQ(lattice_values(kOdd, cubic_at, {1, nullptr}),
              lattice_values(kOdd, cubic_at, {5, nullptr}));
}

}  // namespace
}  // namespace realmodel::fields
