// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces made ready to cut. The triangles that were given come first; a seam follows.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "cutting/cutter.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {
namespace {

using Triangles = std::vector<std::array<std::int32_t, 3>>;

Cutter ready(const std::vector<Position>& vertices, const Triangles& triangles) {
    std::vector<double> coordinates;
    std::vector<std::int32_t> corners;
    for (const Position& p : vertices)
        coordinates.insert(coordinates.end(), p.begin(), p.end());
    for (const auto& t : triangles)
        corners.insert(corners.end(), t.begin(), t.end());
    return oriented_cutter({coordinates, corners});
}

Position normal(const Cutter& surface, std::size_t triangle) {
    std::vector<Position> corners;
    for (const std::int32_t v : surface.triangles[triangle])
        corners.push_back(surface.vertices[index(v)]);
    return polygon_normal(corners);
}

/// How many edges have one triangle, and whether none has more than two.
std::pair<int, bool> border_edges(const Cutter& surface) {
    std::map<std::array<NodeId, 2>, int> users;
    for (const auto& t : surface.triangles) {
        for (std::size_t i = 0; i < 3; ++i)
            ++users[unordered(NodeId{t[i]}, NodeId{t[(i + 1) % 3]})];
    }
    std::pair<int, bool> found{0, true};
    for (const auto& [edge, count] : users) {
        found.first += count == 1;
        found.second = found.second && count <= 2;
    }
    return found;
}

const std::vector<Position> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST(CutterInput, AnOpenSurfaceIsTurnedUpward) {
    EXPECT_EQ(normal(ready(kSquare, {{0, 2, 1}}), 0), (Position{0, 0, 1}));
    EXPECT_EQ(normal(ready(kSquare, {{0, 1, 2}}), 0), (Position{0, 0, 1}));
    // as the larger part of its area is, which then looks up: the second hangs over
    const std::vector<Position> overhang{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 1, 1}};
    const Cutter surface = ready(overhang, {{0, 2, 1}, {2, 1, 3}});
    EXPECT_GT(normal(surface, 0)[2], 0);
    EXPECT_LT(normal(surface, 1)[2], 0);
}

TEST(CutterInput, NeighborsGetOneOrientation) {
    const Cutter surface = ready(kSquare, {{0, 1, 2}, {0, 3, 2}});
    EXPECT_EQ(normal(surface, 0), normal(surface, 1));
}

TEST(CutterInput, ASeamWiderThanRoundingGoesRoundTheBorder) {
    const Cutter surface = ready(kSquare, {{0, 1, 2}, {0, 2, 3}});
    EXPECT_FALSE(surface.is_closed);
    EXPECT_EQ(surface.vertices.size(), 8U);
    EXPECT_EQ(surface.triangles.size(), 2U + 8U);
    EXPECT_EQ(border_edges(surface), std::pair(4, true));
    for (std::size_t v = 4; v < 8; ++v) {  // beyond a corner, along the diagonal
        const Position& p = surface.vertices[v];
        for (std::size_t k = 0; k < 2; ++k)
            EXPECT_NEAR(std::max(-p[k], p[k] - 1), 0x1p-42 / std::sqrt(2), 0x1p-50);
        EXPECT_EQ(p[2], 0);
    }
    for (std::size_t t = 2; t < surface.triangles.size(); ++t)
        EXPECT_GT(normal(surface, t)[2], 0);
}

TEST(CutterInput, ASeamGoesRoundANeedleTipAndNotIntoASlit) {
    for (const double half : {0.2, 0.05, 0x1p-20, 0x1p-40, 0x1p-52}) {  // of its width
        const std::vector<Position> needle{
            {0, 0, 1}, {1, -half, 1}, {1, half, 1}, {1, half / 4, 1}};
        for (const Triangles& triangles : {Triangles{{0, 1, 2}}, Triangles{{0, 1, 3}, {0, 3, 2}}}) {
            const Cutter surface = ready(needle, triangles);
            const bool is_one = triangles.size() == 1;
            const std::size_t corners = is_one ? 3 : 4;
            EXPECT_EQ(surface.vertices.size(), 4 + corners);
            EXPECT_EQ(border_edges(surface), std::pair(static_cast<int>(corners), true));
            const Position& tip = surface.vertices[4];
            EXPECT_NEAR(tip[0], -0x1p-42, 0x1p-50);
            EXPECT_NEAR(tip[1], 0, 0x1p-50);
            EXPECT_EQ(tip[2], 1);
        }
    }
    for (const double half : {0.04, 0x1p-20, 0x1p-40}) {
        const std::vector<Position> slit{{0, 0, 1},  {1, -half, 1}, {1, -1, 1},  {-1, -1, 1},
                                         {-1, 1, 1}, {1, 1, 1},     {1, half, 1}};
        const Cutter surface = ready(slit, {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 5, 4}, {0, 6, 5}});
        EXPECT_EQ(surface.vertices.size(), 7U + 6U);
    }
}

TEST(CutterInput, VerticesInOnePlaceAreOneAndFlatTrianglesAreNone) {
    std::vector<Position> vertices = kSquare;
    vertices.insert(vertices.end(), {{-0.0, 0, 0}, {1, 1, 0}, {0.5, 0.5, 0}});
    const Cutter surface = ready(vertices, {{0, 1, 2}, {4, 5, 3}, {0, 6, 2}});
    EXPECT_EQ(border_edges(surface).first, 4);
    EXPECT_EQ(surface.triangles.size(), 2U + 8U);
}

TEST(CutterInput, ABorderIsDividedWhereAnotherOneHasACorner) {
    // below y = 0 one triangle, above it three along the same edge
    const Cutter surface = ready({{0, 0, 0},
                                  {3, 0, 0},
                                  {1, -1, 0},
                                  {1, 0, 0},
                                  {2, 0, 0},
                                  {0.5, 1, 0},
                                  {1.5, 1, 0},
                                  {2.5, 1, 0}},
                                 {{2, 1, 0}, {0, 3, 5}, {3, 4, 6}, {4, 1, 7}});
    std::size_t seam = surface.triangles.size();
    while (normal(surface, seam - 1)[2] < 1e-9)
        --seam;
    EXPECT_EQ(seam, 6U);
    double area = 0;
    for (std::size_t t = 0; t < seam; ++t) {
        EXPECT_GT(normal(surface, t)[2], 0);
        area += normal(surface, t)[2] / 2;
    }
    EXPECT_EQ(area, 3);
    EXPECT_EQ(
        border_edges(
            {surface.vertices, {surface.triangles.begin(), surface.triangles.begin() + 6}, false}),
        std::pair(8, true));
}

const std::vector<Position> kTwoTips{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};

TEST(CutterInput, AClosedSurfaceIsTakenAsItIs) {
    const Triangles tetrahedron{{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 3, 0}};
    const Cutter surface = ready(kTwoTips, tetrahedron);
    EXPECT_TRUE(surface.is_closed);
    EXPECT_EQ(surface.triangles, tetrahedron);
    EXPECT_EQ(surface.vertices.size(), 5U);
}

TEST(CutterInput, AWallBetweenTwoClosedSurfacesIsLeftOut) {
    const Cutter surface = ready(
        kTwoTips,
        {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 0, 4}});
    EXPECT_TRUE(surface.is_closed);
    EXPECT_EQ(surface.triangles.size(), 6U);
    EXPECT_EQ(border_edges(surface), std::pair(0, true));
}

TEST(CutterInput, OfAnOpenSurfaceThatIsThereTwiceOneStays) {
    EXPECT_EQ(ready(kSquare, {{0, 1, 2}, {0, 2, 3}, {2, 0, 1}, {3, 2, 0}}).triangles.size(),
              2U + 8U);
}

struct Refusal {
    std::string kind;
    std::vector<std::int64_t> items;
    bool operator==(const Refusal&) const = default;
};

Refusal refusal(const std::vector<Position>& vertices, const Triangles& triangles) {
    try {
        ready(vertices, triangles);
    } catch (const InputError& error) {
        return {error.kind, error.items};
    }
    return {};
}

TEST(CutterInput, RefusesWhatIsNoSurfaceAndSaysWhere) {
    std::vector<Position> vertices = kSquare;
    EXPECT_EQ(refusal(vertices, {{0, 1, 2}, {0, 2, 4}}), (Refusal{"bad_index", {1}}));
    EXPECT_EQ(refusal(vertices, {{0, 1, -1}}), (Refusal{"bad_index", {0}}));
    EXPECT_EQ(refusal(vertices, {}).kind, "no_triangles");
    EXPECT_EQ(refusal(vertices, {{0, 1, 1}}).kind, "no_triangles");
    vertices[3][2] = HUGE_VAL;
    EXPECT_EQ(refusal(vertices, {{0, 1, 2}}), (Refusal{"not_finite", {3}}));
}

TEST(CutterInput, RefusesABranchUnderTheNumbersThatWereGiven) {
    // the first triangle is flat and not counted
    EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                      {{0, 0, 1}, {0, 1, 2}, {1, 0, 3}, {0, 1, 4}}),
              (Refusal{"branching", {1, 2, 3}}));
}

TEST(CutterInput, RefusesASurfaceOfOneSide) {
    std::vector<Position> strip;  // Moebius'
    for (int i = 0; i < 5; ++i)
        strip.push_back({std::cos(i * 1.2566), std::sin(i * 1.2566), i % 2 + 0.1 * i});
    EXPECT_EQ(refusal(strip, {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}}).kind,
              "one_sided");
}

}  // namespace
}  // namespace realmodel::cutting
