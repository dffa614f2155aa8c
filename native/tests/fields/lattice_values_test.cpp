// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/lattice_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

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

/// The mean over random points of what a function linear on the tetrahedra lies above another.
TEST(LatticeValues, BalancedOnesErrToNeitherSide) {
    const auto bowl = [](const Vec3& p) {
        return p[0] * p[0] + 0.5 * p[1] * p[1] - p[0] * p[2] + 2 * p[2] * p[2] + p[1];
    };
    std::vector<double> values;
    for (int k = 0; k < kSmall.counts[2]; ++k) {
        for (int j = 0; j < kSmall.counts[1]; ++j) {
            for (int i = 0; i < kSmall.counts[0]; ++i)
                values.push_back(bowl(kSmall.position(i, j, k)));
        }
    }
    const auto mean_above = [&](const std::vector<double>& of) {
        std::mt19937_64 random(1);
        double sum = 0;
        constexpr int kPoints = 20000;
        for (int n = 0; n < kPoints; ++n) {
            Vec3 p{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double share = static_cast<double>(random() >> 11) * 0x1p-53;
                p[axis] =
                    kSmall.origin[axis] + share * kSmall.spacing[axis] * (kSmall.counts[axis] - 1);
            }
            for (const auto& [node, weight] : corners_at(kSmall, p))
                sum += weight * of[node];
            sum -= bowl(p);
        }
        return sum / kPoints;
    };
    const double plain = mean_above(values);
    EXPECT_GT(plain, 0.01);
    EXPECT_LT(std::abs(mean_above(balanced(values, kSmall, {}))), 0.01 * plain);
    EXPECT_EQ(balanced(values, kSmall, {1, nullptr}), balanced(values, kSmall, {5, nullptr}));
}

TEST(LatticeValues, BalancedLinearOnesStay) {
    const std::vector<double> level(kSmall.nodes(), 3.5);
    EXPECT_EQ(balanced(level, kSmall, {}), level);
    const Lattice least{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    const std::vector<double> few{0, 1, 2, 3, 4, 5, 6, 9};
    EXPECT_EQ(balanced(few, least, {}), few);
}

TEST(LatticeValues, WhatBendsMoreThanItRisesIsBalancedLess) {
    // one node of a plane that rises by 1 a node is off by 40
    const Lattice lattice{{0, 0, 0}, {1, 1, 1}, {7, 7, 7}};
    std::vector<double> values;
    for (std::size_t n = 0; n < lattice.nodes(); ++n)
        values.push_back(static_cast<double>(n / 49));
    const std::size_t middle = 3 * 49 + 3 * 7 + 3;
    values[middle] -= 40;
    const auto found = balanced(values, lattice, {});
    EXPECT_NEAR(found[middle], values[middle] - 3.0 / 24, 1e-12);
}

TEST(LatticeValues, TheSameForAnyNumberOfThreads) {
    EXPECT_EQ(lattice_values(kOdd, cubic_at, {1, nullptr}),
              lattice_values(kOdd, cubic_at, {5, nullptr}));
}

}  // namespace
}  // namespace realmodel::fields
