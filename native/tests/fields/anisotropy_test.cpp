// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fields/likely_field.hpp"

namespace realmodel::fields {
namespace {

/// Slopes of an upright fold about the y axis, z + 0.2 sin(4 x), along the bed and up, and
/// differences of values.
std::vector<Functional> upright_fold(double error_of_slopes) {
    std::mt19937 random(3);
    const auto drawn = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    const auto value = [](const Vec3& p) { return p[2] + 0.2 * std::sin(4 * p[0]); };
    std::vector<Functional> known;
    const Vec3 from{0.1, 0.2, -0.3};
    for (int n = 0; n < 25; ++n) {
        const Vec3 at{drawn(), drawn(), drawn()}, other{drawn(), drawn(), drawn()};
        const Vec3 slope{0.8 * std::cos(4 * at[0]), 0, 1};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Vec3 along{};
            along[axis] = 1;
            known.push_back(Functional::slope(at, along, true));
            known.back().right = slope[axis] + error_of_slopes * drawn();
        }
        known.push_back(Functional::difference(other, from));
        known.back().right = value(other) - value(from);
    }
    return known;
}

Likely smooth(const std::vector<Functional>& known) {
    const Likely third = most_likely(known, {}, {}, 0, {});
    return most_likely_smooth(known, most_likely_anywhere(known, third, 0, {}), 0, {});
}

TEST(Anisotropy, ASmoothFoldIsOfTheFifthOrderAndHasNoErrors) {
    const Likely found = smooth(upright_fold(0));
    EXPECT_EQ(found.order, 5);
    EXPECT_LT(found.errors.slope, 1e-5);
    EXPECT_GT(std::abs(found.anisotropy.axes[2][0]), 0.95);  // the range is shortest across it
}

TEST(Anisotropy, ErrorsOfSlopesAreNotTakenForShortFolds) {
    const Likely found = smooth(upright_fold(0.2));
    EXPECT_EQ(found.order, 5);
    EXPECT_GT(found.errors.slope, 1e-4);
    for (const double ratio : found.anisotropy.ratios)
        EXPECT_LT(ratio, 8);
}

TEST(Anisotropy, TheSearchEndsWhereSlopesAreNothingButErrors) {
    EXPECT_LE(smooth(upright_fold(50)).errors.slope, 1);
}

TEST(Anisotropy, TheMapShrinksAlongTheAxes) {
    const Map3 map = map_of({{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}, {0.5, 2, 1}});
    EXPECT_EQ(mapped(map, {1, 1, 1}), (Vec3{2, 1, 0.5}));
}

}  // namespace
}  // namespace realmodel::fields
