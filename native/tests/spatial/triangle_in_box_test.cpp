// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/triangle_in_box.hpp"

#include <gtest/gtest.h>

#include <random>

namespace realmodel::spatial {
namespace {

using Triangle = std::array<std::array<double, 3>, 3>;

Box unit_box() {
    Box box;
    box.include(Box::Position{0, 0, 0});
    box.include(Box::Position{1, 1, 1});
    return box;
}

TEST(TriangleInBox, APlaneThroughTheBoxPassesThoughNoCornerIsInIt) {
    EXPECT_TRUE(passes(unit_box(), Triangle{{{-1, -1, 0.5}, {3, -1, 0.5}, {-1, 3, 0.5}}}));
    EXPECT_FALSE(passes(unit_box(), Triangle{{{-1, -1, 1.5}, {3, -1, 1.5}, {-1, 3, 1.5}}}));
}

TEST(TriangleInBox, OneWhoseBoxMeetsTheOtherMayPassBesideIt) {
    EXPECT_FALSE(passes(unit_box(), Triangle{{{2.5, 0, 0}, {0, 2.5, 0}, {2.5, 2.5, 1}}}));
    EXPECT_TRUE(passes(unit_box(), Triangle{{{1.9, 0, 0}, {0, 1.9, 0}, {2.5, 2.5, 1}}}));
}

TEST(TriangleInBox, HasEachTriangleThatAPointOfTheBoxLiesIn) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-2, 3), share(0, 1);
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        Triangle t;
        for (auto& corner : t) {
            for (double& x : corner)
                x = anywhere(random);
        }
        const double a = share(random), b = share(random) * (1 - a);
        std::array<double, 3> p{};
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = t[0][k] + a * (t[1][k] - t[0][k]) + b * (t[2][k] - t[0][k]);
            inside = inside && p[k] > 1e-9 && p[k] < 1 - 1e-9;
        }
        if (!inside) continue;
        ++met;
        EXPECT_TRUE(passes(unit_box(), t));
    }
    EXPECT_GT(met, 50);
}

}  // namespace
}  // namespace realmodel::spatial
