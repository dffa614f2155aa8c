// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "realmodel/base/errors.hpp"
#include "realmodel/fields/critical_points.hpp"

namespace realmodel::fields {
namespace {

using Points = std::vector<std::array<double, 3>>;

const Lattice kCube{{0, 0, 0}, {1, 1, 1}, {17, 17, 17}};

template <class Function>
std::vector<double> values_of(const Function& function) {
    std::vector<double> values;
    for (int k = 0; k < 17; ++k) {
        for (int j = 0; j < 17; ++j) {
            for (int i = 0; i < 17; ++i)
                values.push_back(function(i, j, k));
        }
    }
    return values;
}

/// It rises with z, but for a bubble.
double bubble(double x, double y, double z) {
    const double square = (x - 8) * (x - 8) + (y - 8) * (y - 8) + (z - 7) * (z - 7);
    return z + 3 * std::exp(-square / 4);
}

double dome(double x, double y, double z) {
    return -std::hypot(x - 8, y - 8, z - 7.3);
}

struct Fields {
    std::vector<double> values;
    Points points;
    std::vector<double> of_points;
    Points dips;
    Points normals;
    Points bounds{};
    std::vector<double> signs{};
    std::vector<double> levels{};

    RisingField rising(std::vector<std::uint8_t> fixed = {}) const {
        fixed.resize(values.size() + points.size());
        for (std::size_t p = 0; p < points.size(); ++p)
            fixed[values.size() + p] = 1;
        const std::span<const double> coordinates(points.empty() ? nullptr : points[0].data(),
                                                  3 * points.size());
        return without_critical_points({kCube, values, coordinates, of_points},
                                       {fixed, dips, normals, bounds, signs, levels});
    }
};

TEST(RisingField, OfABubbleNothingIsLeft) {
    const Fields given{values_of(bubble), {}, {}, {}, {}};
    ASSERT_FALSE(given.rising(std::vector<std::uint8_t>(given.values.size(), 1)).critical.empty());
    const RisingField found = given.rising();
    EXPECT_TRUE(found.critical.empty());
    for (std::size_t n = 0; n < given.values.size(); ++n) {
        const double moved = std::abs(found.values[n] - given.values[n]);
        EXPECT_LT(moved, 1) << n;
    }
    EXPECT_EQ(found.values[0], given.values[0]);
}

TEST(RisingField, ADomeStaysAsItIs) {
    const Fields given{values_of(dome), {}, {}, {}, {}};
    const RisingField found = given.rising();
    EXPECT_EQ(found.critical.size(), 1);
    EXPECT_EQ(found.values, given.values);
}

TEST(RisingField, ContactsKeepTheirLevels) {
    Fields given{values_of(bubble), {{8.4, 8.3, 9.1}, {7.2, 8.6, 7.3}}, {}, {}, {}};
    for (const auto& [x, y, z] : given.points)
        given.of_points.push_back(bubble(x, y, z));
    const RisingField found = given.rising();
    EXPECT_EQ(found.point_values, given.of_points);
    EXPECT_NE(found.values, given.values);
}

TEST(RisingField, OfABubbleThatADipAsksForSomeIsLeft) {
    Fields given{values_of(bubble), {}, {}, {{8.2, 8.3, 8.6}}, {{0, 0, -1}}};
    EXPECT_FALSE(given.rising().critical.empty());
    given.normals[0] = {0, 0, 1};  // against the field: it need not hold
    EXPECT_TRUE(given.rising().critical.empty());
}

TEST(RisingField, BoundsThatHeldHold) {
    Fields given{values_of(bubble), {}, {}, {}, {}};
    const std::size_t top = 8 + 17 * (8 + 17 * 8);
    ASSERT_GT(given.values[top], 10.2);
    given.bounds = {{8, 8, 8}};
    given.signs = {1};
    given.levels = {given.values[top]};
    EXPECT_GE(given.rising().values[top], given.values[top]);
    given.levels = {given.values[top] + 1};  // it does not hold: nothing is held
    EXPECT_LT(given.rising().values[top], given.values[top]);
}

TEST(RisingField, WhatIsHeldIsOneForEach) {
    const Fields given{values_of(bubble), {}, {}, {}, {}};
    EXPECT_THROW(without_critical_points({kCube, given.values, {}, {}}, {}), InputError);
}

}  // namespace
}  // namespace realmodel::fields
