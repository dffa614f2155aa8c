// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/sheets.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "../dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/interpolation/kriging.hpp"

namespace realmodel::interpolation {
namespace {

const Variogram kShared{VariogramModel::kCubic, 60, 4, 0, {}};
const Variogram kThickness{VariogramModel::kSpherical, 40, 1, 0, {}};
const std::vector<double> kVariances{0, 0.2};
const Points kPoints{{0, 0, 1}, {30, 5, 3}, {0, 0, 6}, {12, 20, 4}};
const std::vector<std::int32_t> kOf{0, 0, 1, 1};
const Nodes kNodes{{0, 0}, {12, 20}, {30, 5}, {7, 9}, {200, 3}};

KrigingOptions asked(std::int32_t sheet, int neighbors) {
    return {{neighbors}, Drift::kConstant, {}, {kOf, {}, kVariances, kThickness, sheet}};
}

TEST(Sheets, EachHasItsOwnHeightAtOnePosition) {
    for (const int neighbors : {0, 3}) {
        EXPECT_EQ(krige(kPoints, kNodes, kShared, asked(0, neighbors)).z[0], 1);
        EXPECT_EQ(krige(kPoints, kNodes, kShared, asked(1, neighbors)).z[0], 6);
        EXPECT_EQ(krige(kPoints, kNodes, kShared, asked(1, neighbors)).variance[1], 0);
        EXPECT_GT(krige(kPoints, kNodes, kShared, asked(1, neighbors)).variance[2], 0);
    }
}

TEST(Sheets, TheVarianceFarFromPointsIsThatOfTheSheet) {
    const double lower = krige(kPoints, kNodes, kShared, asked(0, 0)).variance[4];
    const double upper = krige(kPoints, kNodes, kShared, asked(1, 0)).variance[4];
    EXPECT_GE(lower, 4);
    EXPECT_GT(upper, lower);
}

TEST(Sheets, WithoutThicknessesTheyAreOneSurface) {
    const Points points{{0, 0, 1}, {30, 5, 3}, {9, 8, 6}, {12, 20, 4}};
    const std::vector<double> none{0, 0};
    const KrigingOptions options{{0}, Drift::kLinear, {}, {kOf, {}, none, kThickness, 1}};
    const Kriged joint = krige(points, kNodes, kShared, options);
    const Kriged one = krige(points, kNodes, kShared, {{0}, Drift::kLinear});
    for (std::size_t i = 3; i < kNodes.size(); ++i) {
        EXPECT_NEAR(joint.z[i], one.z[i], 1e-9);
        EXPECT_NEAR(joint.variance[i], one.variance[i], 1e-9);
    }
}

TEST(Sheets, TheSameBytesForAnyNumberOfThreads) {
    Points points = hills(300, 100, {4e5, 5e6});
    std::vector<std::int32_t> of(points.size());
    for (std::size_t i = 0; i < of.size(); ++i)
        of[i] = static_cast<std::int32_t>(i % 2);
    Nodes nodes;
    for (int i = 0; i < 500; ++i)
        nodes.push_back({4e5 + 0.2 * i, 5e6 + 100 - 0.17 * i});
    const KrigingOptions options{{24}, Drift::kConstant, {}, {of, {}, kVariances, kThickness, 1}};
    const Kriged one = krige(points, nodes, kShared, options, {1});
    const Kriged four = krige(points, nodes, kShared, options, {4});
    EXPECT_EQ(std::memcmp(one.z.data(), four.z.data(), one.z.size() * sizeof(double)), 0);
}

TEST(Sheets, WhatMakesNoSenseIsRefused) {
    KrigingOptions options = asked(2, 0);
    EXPECT_THROW(krige(kPoints, kNodes, kShared, options), InputError);
    options = asked(0, 0);
    options.sheets.of_points = std::span(kOf).first(3);
    EXPECT_THROW(krige(kPoints, kNodes, kShared, options), InputError);
    const std::vector<double> falling{0.2, 0.1};
    options = asked(0, 0);
    options.sheets.variances = falling;
    EXPECT_THROW(krige(kPoints, kNodes, kShared, options), InputError);
}

}  // namespace
}  // namespace realmodel::interpolation
