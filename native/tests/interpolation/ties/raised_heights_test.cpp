// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "realmodel/interpolation/surface_heights.hpp"
#include "realmodel/interpolation/ties.hpp"

namespace realmodel::interpolation {
namespace {

using Places = std::vector<std::array<double, 2>>;

constexpr double kMost = HUGE_VAL;

/// Two triangles of a square, and a third one beside it.
struct Mesh {
    Places nodes{{0, 0}, {4, 0}, {0, 4}, {4, 4}, {8, 0}};
    std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {1, 3, 2}, {1, 4, 3}};
    std::vector<double> least{1, 1, 1, 1, 1};

    std::vector<double> raised(const std::vector<double>& z, const Places& places,
                               const std::vector<double>& lower,
                               const std::vector<double>& upper) const {
        const std::vector<double> margins(places.size(), 0.0);
        return raised_heights({nodes, triangles, z, least}, {places, lower, upper, {}}, margins,
                              1e-12);
    }
    double at(const std::vector<double>& z, const std::array<double, 2>& place) const {
        std::vector<std::array<double, 3>> vertices;
        for (std::size_t n = 0; n < nodes.size(); ++n)
            vertices.push_back({nodes[n][0], nodes[n][1], z[n]});
        return heights_on_surface(vertices, triangles, Places{place})[0];
    }
};

TEST(RaisedHeights, AreWithinTheBoundsOfTriangles) {
    const Mesh mesh;
    const std::vector<double> z{1, 3, 3, 1, 2};
    const auto found = mesh.raised(z, {{1, 1}, {3, 3}}, {1.5, 2.5}, {1.5, kMost});
    EXPECT_NEAR(mesh.at(found, {1, 1}), 1.5, 1e-11);
    EXPECT_GE(mesh.at(found, {3, 3}), 2.5 - 1e-11);
    for (const double height : found)
        EXPECT_GE(height, 1);
    EXPECT_EQ(found[4], z[4]);  // no corner of a triangle with data
}

TEST(RaisedHeights, AreTheLeastOnesAroundAPlaceWithoutRoom) {
    const Mesh mesh;
    const auto found = mesh.raised({1, 3, 3, 1, 2}, {{1, 1}}, {-kMost}, {0.5});
    for (const std::size_t n : {0, 1, 2})
        EXPECT_EQ(found[n], 1);
    EXPECT_EQ(found[3], 1);
}

TEST(RaisedHeights, StayWhereDataHold) {
    const Mesh mesh;
    const std::vector<double> z{1, 3, 3, 1, 2};
    EXPECT_EQ(mesh.raised(z, {{1, 1}, {9, 9}}, {1, 0}, {3, 0}), z);
}

TEST(RaisedHeights, EndWhereDataContradictOneAnother) {
    const Mesh mesh;
    const auto found = mesh.raised({1, 2, 2, 1, 1}, {{1, 1}, {1.1, 1}}, {3, -kMost}, {kMost, 1.5});
    for (const double height : found)
        EXPECT_TRUE(height >= 1 && height < 10);
}

TEST(RaisedHeights, AreNotFarAboveAllDataForOneOfThem) {
    const Mesh
        mesh;  // the first place holds two nodes down; the second is almost on the edge between
    const std::vector<double> z{1, 1, 1, 1, 1};
    const Places places{{1.99, 1.99}, {2.05, 2.05}, {5, 0.5}};
    const auto found = mesh.raised(z, places, {1.1, 3, 1.5}, {1.1, 3, 1.5});
    for (const double height : found)
        EXPECT_LE(height, 3);
    EXPECT_NEAR(mesh.at(found, {1.99, 1.99}), 1.1, 1e-11);
    EXPECT_NEAR(mesh.at(found, {5, 0.5}), 1.5, 1e-11);
}

TEST(RaisedHeights, AreNotAskedForWhereThereIsNothingBeneath) {
    Mesh mesh;
    mesh.least[0] = NAN;
    const std::vector<double> z{1, 3, 3, 1, 2};
    EXPECT_EQ(mesh.raised(z, {{1, 1}}, {0}, {0}), z);
}

}  // namespace
}  // namespace realmodel::interpolation
