// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/critical_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/vectors.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {
namespace {

const Lattice kLattice{{-1, -1, -1}, {0.13, 0.17, 0.19}, {16, 12, 11}};

std::vector<double> values_of(const std::function<double(const Vec3&)>& function) {
    std::vector<double> values;
    for (int k = 0; k < kLattice.counts[2]; ++k) {
        for (int j = 0; j < kLattice.counts[1]; ++j) {
            for (int i = 0; i < kLattice.counts[0]; ++i)
                values.push_back(function(kLattice.position(i, j, k)));
        }
    }
    return values;
}

std::vector<CriticalPoint> found_in(const std::function<double(const Vec3&)>& function) {
    return critical_points(kLattice, values_of(function));
}

TEST(CriticalPoints, AFieldThatRisesEverywhereHasNone) {
    EXPECT_TRUE(found_in([](const Vec3& p) { return p[0] - 0.3 * p[1] + 2 * p[2]; }).empty());
    EXPECT_TRUE(found_in([](const Vec3& p) { return p[2] + 0.2 * std::sin(4 * p[0]); }).empty());
    EXPECT_TRUE(found_in([](const Vec3&) { return 1.0; }).empty());  // the nodes' numbers decide
}

TEST(CriticalPoints, TheEndsAndSaddlesOfQuadrics) {
    const auto bowl = [](const Vec3& p) { return dot(p, p); };
    const std::vector<CriticalPoint> low = found_in(bowl);
    ASSERT_EQ(low.size(), 1U);
    EXPECT_EQ(low[0].kind, CriticalKind::kMinimum);
    const std::vector<double> values = values_of(bowl);
    for (const double value : values)
        EXPECT_GE(value, values[low[0].node]);
    const std::vector<CriticalPoint> high = found_in([](const Vec3& p) { return -dot(p, p); });
    ASSERT_EQ(high.size(), 1U);
    EXPECT_EQ(high[0].kind, CriticalKind::kMaximum);
    EXPECT_EQ(high[0].node, low[0].node);
    for (const double sign : {1.0, -1.0}) {
        const std::vector<CriticalPoint> saddle = found_in([&](const Vec3& p) {
            return sign * (p[0] * p[0] + p[1] * p[1] - p[2] * p[2] + 0.01 * p[0]);
        });
        ASSERT_EQ(saddle.size(), 1U);
        EXPECT_EQ(saddle[0].kind, CriticalKind::kSaddle);
    }
}

TEST(CriticalPoints, TheSameForAnyNumberOfThreads) {
    const std::vector<double> values = values_of(
        [](const Vec3& p) { return std::sin(7 * p[0]) * std::sin(5 * p[1]) + std::sin(6 * p[2]); });
    const std::vector<CriticalPoint> one = critical_points(kLattice, values, {1, nullptr});
    const std::vector<CriticalPoint> five = critical_points(kLattice, values, {5, nullptr});
    ASSERT_GT(one.size(), 10U);
    ASSERT_EQ(one.size(), five.size());
    for (std::size_t n = 0; n < one.size(); ++n)
        EXPECT_EQ(one[n].node, five[n].node);
}

TEST(CriticalPoints, AsManyValuesAsNodes) {
    EXPECT_THROW(critical_points(kLattice, std::vector<double>(3)), InputError);
}

}  // namespace
}  // namespace realmodel::fields
