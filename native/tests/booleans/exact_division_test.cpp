// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/exact_division.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

/// Two surfaces, and where all of their triangles meet.
struct Divided {
    Divided(const Mesh& p, const Mesh& q)
        : pieces({p.view(), q.view()}, {1}), division(pieces, all(), {1}) {}
    std::vector<PieceId> all() const {
        std::vector<PieceId> found;
        for (std::size_t i = 0; i < pieces.input_count(); ++i)
            found.push_back({static_cast<std::int32_t>(i), 0});
        return found;
    }
    std::vector<std::size_t> counts() const {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < pieces.input_count(); ++i)
            found.push_back(pieces.of(static_cast<std::int32_t>(i)).size());
        return found;
    }
    TrianglePieces pieces;
    ExactDivision division;
};

TEST(ExactDivision, WhatSharesAnEdgeOrACornerMeetsInOrder) {
    EXPECT_TRUE(Divided(square({0, 0, 0}, 2), square({2, 2, 0}, 2)).division.meetings().empty());
    EXPECT_TRUE(Divided(square({0, 0, 0}, 2), upright({0, 0, 0}, 2)).division.meetings().empty());
    EXPECT_TRUE(Divided(square({0, 0, 0}, 2), square({0, 0, 0}, 2)).division.meetings().empty());
}

/// Ten triangles around a point, which go round it so often, seen along an axis, to the left or
/// (-1) right. Twice around it, two of them cross.
Mesh fan(int rounds, std::size_t axis, int turn_of_all) {
    Mesh mesh{{0, 0, 0}, {}};
    for (int i = 0; i < 10; ++i) {
        const double turn = (i + 0.5) / 10 * rounds * 2 * std::numbers::pi;
        std::array<double, 3> at{};
        at[(axis + 1) % 3] = std::cos(turn);
        at[(axis + 2) % 3] = turn_of_all * std::sin(turn);
        at[axis] = 0.3 * std::sin(turn / rounds);
        mesh.vertices.insert(mesh.vertices.end(), at.begin(), at.end());
        mesh.triangles.insert(mesh.triangles.end(), {0, 1 + i, 1 + (i + 1) % 10});
    }
    return mesh;
}

TEST(ExactDivision, NeighborsThatOverlapMeet) {
    const Mesh far = square({9, 9, 9}, 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int turn : {1, -1}) {
            EXPECT_TRUE(Divided(fan(1, axis, turn), far).division.meetings().empty());
            EXPECT_EQ(Divided(fan(2, axis, turn), far).division.meetings().size(), 1U);
        }
        // a triangle that ends beyond where the next one begins
        Mesh torn = fan(1, axis, 1);
        torn.triangles[2] = 11;
        torn.vertices.insert(torn.vertices.end(), torn.vertices.begin() + 9,
                             torn.vertices.begin() + 12);
        torn.vertices[33 + axis] = -1;
        torn.vertices[3 + axis] = 2;
        EXPECT_EQ(Divided(torn, far).division.meetings().size(), 1U);
    }
}

TEST(ExactDivision, PiecesAreDividedWhereTheyCross) {
    Divided found(square({0, 0, 0}, 2), upright({0.5, -1, -1}, 4));
    EXPECT_FALSE(found.division.meetings().empty());
    found.division.divide(found.division.meetings());
    for (std::int32_t input = 0; input < 2; ++input) {
        for (const TrianglePiece& piece : found.pieces.of(input)) {
            double low = 9, high = -9;
            for (const SpacePointId p : piece.corners) {
                low = std::min(low, found.pieces.points.rounded(p)[0]);
                high = std::max(high, found.pieces.points.rounded(p)[0]);
            }
            EXPECT_TRUE(high <= 0.5 || low >= 0.5);
        }
    }
}

TEST(ExactDivision, OverlapsInOnePlaneAreDividedAlike) {
    Divided found(square({0, 0, 0}, 2), square({1, 0, 0}, 2));
    ASSERT_FALSE(found.division.meetings().empty());
    for (const auto& met : found.division.meetings()) {
        EXPECT_TRUE(met.in_one_plane);
        EXPECT_TRUE(found.division.is_in_doubles(met));
    }
    found.division.divide(found.division.meetings());
    std::vector<std::array<TriangleCorners, 1>> of_p, of_q;
    for (std::int32_t input = 0; input < 4; ++input) {
        for (const TrianglePiece& piece : found.pieces.of(input))
            (input < 2 ? of_p : of_q).push_back({in_order(piece.corners).first});
    }
    std::sort(of_p.begin(), of_p.end());
    std::sort(of_q.begin(), of_q.end());
    std::vector<std::array<TriangleCorners, 1>> both;
    std::ranges::set_intersection(of_p, of_q, std::back_inserter(both));
    EXPECT_FALSE(both.empty());
}

TEST(ExactDivision, AHoleIsJoinedWithItsOutline) {
    // a corner of the cube comes through the middle of one triangle of the square
    Mesh tip = cube({0, 0, 0}, 1);
    for (std::size_t v = 0; v < tip.vertices.size(); v += 3) {
        const double x = tip.vertices[v], y = tip.vertices[v + 1], z = tip.vertices[v + 2];
        tip.vertices[v] = 2 + x - y;
        tip.vertices[v + 1] = 2 + x + y - 2 * z;
        tip.vertices[v + 2] = x + y + z - 0.5;
    }
    Divided found(square({0, 0, 0}, 9), tip);
    found.division.divide(found.division.meetings());
    // the outline has three corners, the hole three: 3 + 3 + 2 - 2 triangles, and one in the hole
    EXPECT_EQ(found.counts()[0], 7U);
    EXPECT_EQ(found.counts()[1], 1U);
}

TEST(ExactDivision, APointThatNoDoubleIsIsRoundedAndItsPiecesAreFresh) {
    Mesh steep{{0, -1, -1, 3, 4, -1, 1, 1, 2}, {0, 1, 2}};
    Divided found(square({0, 0, 0}, 2), steep);
    found.division.divide(found.division.meetings());
    for (std::size_t i = 0; i < found.pieces.input_count(); ++i) {
        for (const TrianglePiece& piece : found.pieces.of(static_cast<std::int32_t>(i))) {
            for (const SpacePointId p : piece.corners)
                EXPECT_TRUE(found.pieces.points.is_double(p));
        }
    }
}

}  // namespace
}  // namespace realmodel::booleans
