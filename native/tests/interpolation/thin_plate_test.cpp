// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/thin_plate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {
namespace {

TEST(ThinPlate, PlanesComeOutAndPointsAreMet) {
    Points points = hills(60, 100, {4e5, 5e6});
    const Nodes nodes = scattered_nodes(200, 140, {4e5, 5e6});
    for (const int neighbors : {0, 12}) {
        const ThinPlateOptions options{0, {neighbors}};
        const std::vector<double> at_points =
            thin_plate(points, Nodes{{points[3][0], points[3][1]}}, options);
        EXPECT_EQ(at_points[0], points[3][2]);
        Points plane = points;
        for (auto& p : plane)
            p[2] = 7 + 0.2 * (p[0] - 4e5) - 0.1 * (p[1] - 5e6);
        const std::vector<double> z = thin_plate(plane, nodes, options);
        for (std::size_t i = 0; i < nodes.size(); ++i)
            EXPECT_NEAR(z[i], 7 + 0.2 * (nodes[i][0] - 4e5) - 0.1 * (nodes[i][1] - 5e6), 1e-8);
    }
}

TEST(ThinPlate, SlopesOverTheBaselineAreThoseOfTheDips) {
    const Points points = hills(40, 100, {4e5, 5e6});
    const Nodes positions{{4e5 + 20, 5e6 + 30}, {4e5 + 70, 5e6 + 55}};
    const Nodes slopes{{0.4, -0.3}, {0, 0.2}};
    ThinPlateOptions options{0, {0}};
    options.dips = {positions, slopes, 6, 0};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto [x, y] = positions[i];
        const Nodes ends{{x + 3, y}, {x - 3, y}, {x, y + 3}, {x, y - 3}};
        const std::vector<double> z = thin_plate(points, ends, options);
        EXPECT_NEAR((z[0] - z[1]) / 6, slopes[i][0], 1e-9);
        EXPECT_NEAR((z[2] - z[3]) / 6, slopes[i][1], 1e-9);
    }
}

TEST(ThinPlate, FourPointsByHand) {
    // A square with one corner lifted by 1: z = 1/4 + (x + y) / 4 + bump. By symmetry the bump is 0
    // in the middle, and the diagonal through the lifted corner keeps its sign.
    const Points corners{{-1, -1, 0}, {1, -1, 0}, {1, 1, 1}, {-1, 1, 0}};
    const std::vector<double> z =
        thin_plate(corners, Nodes{{0, 0}, {0.5, 0}, {0, 0.5}}, {0, {0}}, {1});
    EXPECT_NEAR(z[0], 0.25, 1e-12);
    EXPECT_NEAR(z[1], z[2], 1e-12);
    // Smoothed without end it is the plane of least squares.
    const std::vector<double> smooth =
        thin_plate(corners, Nodes{{1, 1}, {-1, -1}}, {1e12, {0}}, {1});
    EXPECT_NEAR(smooth[0], 0.75, 1e-9);
    EXPECT_NEAR(smooth[1], -0.25, 1e-9);
}

TEST(ThinPlate, APartOfThePointsGivesTheHeightsOfAll) {
    // The nodes lie in the lower left corner, their neighbors in the part about it.
    const Points all = hills(2000, 100, {4e5, 5e6});
    Points part{all[0]};
    for (std::size_t i = 1; i < all.size(); ++i)
        if (all[i][0] < 4e5 + 60 && all[i][1] < 5e6 + 60) part.push_back(all[i]);
    ASSERT_LT(part.size(), all.size() / 2);
    const Nodes nodes = scattered_nodes(200, 20, {4e5, 5e6});
    ThinPlateOptions options{0.2, {12}};
    const std::vector<double> z = thin_plate(all, nodes, options);
    EXPECT_NE(thin_plate(part, nodes, options), z);
    options.spacing = mean_spacing(all);
    EXPECT_EQ(thin_plate(part, nodes, options), z);
    EXPECT_EQ(thin_plate(all, nodes, options), z);
    options.spacing = -1;
    EXPECT_THROW(thin_plate(part, nodes, options), InputError);
}

TEST(ThinPlate, SameBytesForAnyNumberOfThreadsAndRefusals) {
    const Points points = hills(300, 100);
    const Nodes nodes = scattered_nodes(1000, 120);
    const std::vector<double> one = thin_plate(points, nodes, {0.1, {16, 2}}, {1});
    const std::vector<double> three = thin_plate(points, nodes, {0.1, {16, 2}}, {3});
    EXPECT_EQ(std::memcmp(one.data(), three.data(), 8 * one.size()), 0);
    EXPECT_THROW(thin_plate(points, nodes, {-1, {16}}, {1}), InputError);
    EXPECT_THROW(thin_plate(points, nodes, {0, {-1}}, {1}), InputError);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(thin_plate(points, nodes, {}, {0, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
