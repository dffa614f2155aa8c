// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/values_through.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "realmodel/base/errors.hpp"

namespace realmodel::fields {
namespace {

using Corners = std::vector<std::array<std::int64_t, 4>>;
using Weights = std::vector<std::array<double, 4>>;

ValuesThrough through(const std::vector<double>& given, const Corners& corners,
                      const Weights& weights, const std::vector<double>& levels, int rounds) {
    return values_through(given, {corners, weights, levels}, rounds, {});
}

const Weights kMiddle{{0.25, 0.25, 0.25, 0.25}};

TEST(ValuesThrough, OneContactMovesItsCornersAlike) {
    const auto found = through({0, 0, 9, 0, 0}, {{0, 1, 3, 4}}, kMiddle, {2}, 10);
    for (const std::size_t n : {0, 1, 3, 4})
        EXPECT_NEAR(found.values[n], 2, 1e-12);
    EXPECT_EQ(found.values[2], 9);
    EXPECT_NEAR(found.missed[0], 0, 1e-12);
}

TEST(ValuesThrough, EachRoundLeavesLess) {
    const std::vector<double> given{0, 1, 2, 3, 4};
    const Corners corners{{0, 1, 2, 3}, {1, 2, 3, 4}};
    const Weights weights{{0.1, 0.2, 0.3, 0.4}, {0.7, 0.1, 0.1, 0.1}};
    double before = HUGE_VAL;
    for (const int rounds : {0, 1, 3, 10}) {
        const auto found = through(given, corners, weights, {5, -1}, rounds);
        const double left = std::hypot(found.missed[0], found.missed[1]);
        EXPECT_LT(left, before);
        before = left;
        if (rounds == 0) {
            EXPECT_EQ(found.values, given);
            EXPECT_NEAR(found.missed[0], 3, 1e-12);
        }
    }
    EXPECT_LT(before, 1e-9);
}

TEST(ValuesThrough, ContactsThatContradictOneAnotherShareWhatIsMissed) {
    const auto found =
        through({0, 0, 0, 0}, {{0, 1, 2, 3}, {0, 1, 2, 3}}, {kMiddle[0], kMiddle[0]}, {1, 3}, 10);
    for (const double value : found.values)
        EXPECT_NEAR(value, 2, 1e-6);
    EXPECT_NEAR(found.missed[0], -1, 1e-6);
    EXPECT_NEAR(found.missed[1], 1, 1e-6);
}

TEST(ValuesThrough, WithoutContactsNothingMoves) {
    EXPECT_EQ(through({1, 2}, {}, {}, {}, 3).values, (std::vector<double>{1, 2}));
}

TEST(ValuesThrough, CornersThatAreNoValuesAreRefused) {
    EXPECT_THROW(through({0, 0, 0, 0}, {{0, 1, 2, 4}}, kMiddle, {1}, 1), InputError);
    EXPECT_THROW(through({0, 0, 0, 0}, {{-1, 1, 2, 3}}, kMiddle, {1}, 1), InputError);
}

}  // namespace
}  // namespace realmodel::fields
