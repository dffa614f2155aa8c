// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/linear_data.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "interpolation/kriging/covariance.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

const std::vector<std::array<double, 3>> kPoints{{1000, 2000, 5}, {1010, 2000, 7}};
const std::vector<PlanPosition> kPositions{{1004, 2003}, {1006, 1990}};
const std::vector<PlanPosition> kSlopes{{0.5, -0.25}, {0, 0.125}};

TEST(LinearData, SlopesAreDifferencesOverTheBaseline) {
    const DataPoints points = prepare_points(kPoints);
    const LinearData data(points, {kPositions, kSlopes, 2, 1}, {3, 5});
    EXPECT_EQ(data.size(), 6U);
    EXPECT_EQ(data.dips_at_node(), 1U);
    EXPECT_FALSE(data.uses_all_dips());
    EXPECT_EQ(data.value(1, 4), 3);
    EXPECT_EQ(data.value(2, 4), 3 * 2 * 0.5);
    EXPECT_EQ(data.value(3, 4), 5 * 2 * -0.25);
    EXPECT_EQ(data.position(5), (PlanPosition{6, -10}));
    // Of a kernel that is a product of polynomials they are products of differences.
    const auto f = [](const PlanPosition& p) { return p[0] * p[0] + 10 * p[1]; };
    const auto kernel = [&](const PlanPosition& a, const PlanPosition& b) { return f(a) * f(b); };
    const double along_x = 3 * (25 + 30 - (9 + 30)), along_y = 5 * (16 + 40 - (16 + 20));
    EXPECT_EQ(data.with_height({2, 1}, 2, kernel), 14 * along_x);
    EXPECT_EQ(data.between(2, 3, kernel), along_x * along_y);
    EXPECT_EQ(data.between(3, 2, kernel), along_x * along_y);
    EXPECT_EQ(data.between(1, 3, kernel), 100 * along_y);
    EXPECT_EQ(data.between(1, 0, kernel), 0);
}

TEST(LinearData, WithoutDipsItIsThePoints) {
    const DataPoints points = prepare_points(kPoints);
    const LinearData data(points);
    EXPECT_EQ(data.size(), 2U);
    EXPECT_EQ(data.dip_count(), 0U);
    EXPECT_TRUE(data.uses_all_dips());
}

TEST(LinearData, SlopesOfASurfaceHaveTheVarianceOne) {
    Variogram v{VariogramModel::kMatern52, 100, 9, 4, {3, 20}, {}};
    v.further.push_back({VariogramModel::kSpherical, 40, 2, {}});
    const Covariance covariance(v);
    const DataPoints points = prepare_points(kPoints);
    const LinearData data(points, {kPositions, kSlopes, 0.5, 0}, covariance.scales_over(0.5));
    for (std::int32_t i = 2; i < 6; ++i)
        EXPECT_NEAR(data.between(i, i, covariance), 1, 1e-10);
    EXPECT_EQ(covariance.scales_over(0), (std::array<double, 2>{0, 0}));
}

TEST(LinearData, WhatMakesNoSenseIsRefused) {
    const DataPoints points = prepare_points(kPoints);
    const auto make = [&](const Dips& dips) { const LinearData data(points, dips, {1, 1}); };
    EXPECT_THROW(make({kPositions, {}, 1, 0}), InputError);
    EXPECT_THROW(make({kPositions, kSlopes, 0, 0}), InputError);
    EXPECT_THROW(make({kPositions, kSlopes, 1, -1}), InputError);
    const std::vector<PlanPosition> wrong{{0, 0}, {0, std::numeric_limits<double>::quiet_NaN()}};
    try {
        make({kPositions, wrong, 1, 0});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "not_finite");
        EXPECT_EQ(error.items, (std::vector<std::int64_t>{1}));
    }
}

}  // namespace
}  // namespace realmodel::interpolation
