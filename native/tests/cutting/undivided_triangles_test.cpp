// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "cutting/cutter_overlay.hpp"

namespace realmodel::cutting {
namespace {

/// Whether a triangle is surely apart from that of the first three vertices.
bool is_apart(const std::vector<Position>& more, const std::array<std::int32_t, 3>& other) {
    Cutter surface;
    surface.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    surface.vertices.insert(surface.vertices.end(), more.begin(), more.end());
    const bool found = are_surely_apart(surface, {0, 1, 2}, other);
    EXPECT_EQ(are_surely_apart(surface, other, {0, 1, 2}), found);
    return found;
}

TEST(UndividedTriangles, ThatShareAnEdgeAreApartUnlessTheyFoldBack) {
    EXPECT_TRUE(is_apart({{1, 1, 0}}, {2, 1, 3}));
    EXPECT_TRUE(is_apart({{0.2, 0.2, 1e-3}}, {2, 1, 3}));
    EXPECT_FALSE(is_apart({{0.2, 0.2, 0}}, {2, 1, 3}));
    EXPECT_FALSE(is_apart({}, {1, 0, 2}));
}

TEST(UndividedTriangles, ThatShareACornerAreApartWhereAPlaneThroughItPartsThem) {
    EXPECT_TRUE(is_apart({{-1, 0, 0}, {0, -1, 0}}, {0, 3, 4}));
    EXPECT_TRUE(is_apart({{-1, 0.1, 0}, {-1, -3, 0}}, {0, 3, 4}));
    EXPECT_TRUE(is_apart({{0.3, 0.3, 1}, {0.2, 0.5, 2}}, {0, 3, 4}));
    EXPECT_TRUE(is_apart({{-0.3, -0.3, 1}, {0.2, -0.5, -1}}, {0, 3, 4}));
    EXPECT_FALSE(is_apart({{0.3, 0.3, 1}, {0.3, 0.3, -1}}, {0, 3, 4}));
    EXPECT_FALSE(is_apart({{2, 1, 0}, {1, 2, 0}}, {0, 3, 4}));
    EXPECT_FALSE(is_apart({{0.5, 0, 0}, {0.5, -1, 1}}, {0, 3, 4}));  // touches an edge
}

TEST(UndividedTriangles, ThatShareNothingAreApartWhereAPlanePartsThem) {
    EXPECT_TRUE(is_apart({{0, 0, 1}, {1, 0, 1}, {0, 1, 2}}, {3, 4, 5}));
    EXPECT_TRUE(is_apart({{0.6, 0.6, 0}, {2, 0, 0}, {2, 2, 0}}, {3, 4, 5}));
    EXPECT_TRUE(is_apart({{0.6, 0.6, -1}, {0.6, 0.6, 1}, {2, 2, 0}}, {3, 4, 5}));
    EXPECT_FALSE(is_apart({{0.2, 0.2, -1}, {0.2, 0.2, 1}, {2, 2, 0}}, {3, 4, 5}));
    EXPECT_FALSE(is_apart({{0.5, 0.5, 0}, {2, 0, 0}, {2, 2, 0}}, {3, 4, 5}));  // at a point
    EXPECT_FALSE(is_apart({{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}}, {3, 4, 5}));    // not by name
}

}  // namespace
}  // namespace realmodel::cutting
