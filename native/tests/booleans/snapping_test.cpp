// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/snapping.hpp"

#include <gtest/gtest.h>

#include "base/floating_point.hpp"
#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

constexpr Snapping::Radius kRadius{64, 64};

/// A level square of P, and one triangle of Q.
struct Snapped {
    explicit Snapped(const std::vector<double>& triangle)
        : q{triangle, {0, 1, 2}}, pieces({p.view(), q.view()}, {1}) {
        for (std::int32_t input = 0; input < 2; ++input)
            pairs.push_back(pair_of(pieces.of(input)[0].corners, pieces.of(2)[0].corners));
    }
    std::vector<std::int32_t> apply() { return Snapping(pieces, pairs, kRadius, {1}).apply(); }
    bool has(std::int32_t input, SpacePointId vertex) const {
        return std::ranges::any_of(pieces.of(input), [vertex](const TrianglePiece& piece) {
            return std::ranges::count(piece.corners, vertex) != 0;
        });
    }

    const Mesh p = square({0, 0, 0}, 4);
    const Mesh q;
    TrianglePieces pieces;
    std::vector<FacetPair> pairs;
};

const double kLittle = ulp(4.0);

TEST(Snapping, OfTwoVerticesThatAreNearTheFirstRemains) {
    Snapped found({4, 0, kLittle, 9, 0, 3, 9, 9, 3});
    const SpacePointId kept = found.pieces.of(0)[0].corners[1],
                       gone = found.pieces.of(2)[0].corners[0];
    const Snapping snapping(found.pieces, found.pairs, kRadius, {1});
    EXPECT_TRUE(snapping.merges());
    EXPECT_EQ(snapping.merged(gone), kept);
    EXPECT_EQ(snapping.merged(kept), kept);
    EXPECT_EQ(found.apply(), std::vector<std::int32_t>{2});
    EXPECT_EQ(found.pieces.of(2)[0].corners[0], kept);
}

TEST(Snapping, AVertexOnAnEdgeDividesAllThatHaveTheEdge) {
    Snapped found({2, 2, kLittle, 2, 3, 9, 3, 2, 9});  // on the diagonal
    const SpacePointId tip = found.pieces.of(2)[0].corners[0];
    EXPECT_EQ(found.apply(), (std::vector<std::int32_t>{0, 1}));
    for (std::int32_t input = 0; input < 2; ++input) {
        EXPECT_EQ(found.pieces.of(input).size(), 2U);
        EXPECT_TRUE(found.has(input, tip));
    }
}

TEST(Snapping, AVertexOverATriangleDividesItInThree) {
    Snapped found({1, 1, -kLittle, 1, 2, -9, 2, 1, -9});
    EXPECT_EQ(found.apply(), std::vector<std::int32_t>{0});
    EXPECT_EQ(found.pieces.of(0).size(), 3U);
    EXPECT_TRUE(found.has(0, found.pieces.of(2)[0].corners[0]));
}

TEST(Snapping, EdgesThatPassEachOtherGetACommonVertex) {
    Snapped found({2, -1, kLittle, 2, 1, kLittle, 2, 0, 9});
    const std::size_t before = found.pieces.points.size();
    EXPECT_EQ(found.apply(), (std::vector<std::int32_t>{0, 2}));
    EXPECT_EQ(found.pieces.points.size(), before + 1);
    EXPECT_TRUE(found.has(0, SpacePointId(before)));
    EXPECT_TRUE(found.has(2, SpacePointId(before)));
}

TEST(Snapping, ATriangleWithoutAreaIsFoldedOntoItsLongestEdge) {
    Snapped found({0, 0, 0, 4, 0, 0, 1, 0, 0});
    const TriangleCorners flat = in_order(found.pieces.of(2)[0].corners).first;
    const SpacePointId middle = found.pieces.of(2)[0].corners[2];
    const auto changed = Snapping(found.pieces, std::span(&flat, 1), {1}).apply();
    EXPECT_EQ(changed, (std::vector<std::int32_t>{0, 2}));
    EXPECT_TRUE(found.has(0, middle));
    EXPECT_TRUE(found.pieces.of(2).empty());  // two parts, folded upon each other
}

TEST(KeyNumbers, NumbersKeysInTheOrderInWhichTheyCome) {
    KeyNumbers<std::array<std::int64_t, 3>> table;
    EXPECT_EQ(table.find({1, 2, 3}), -1);
    EXPECT_EQ(table.add({1, 2, 3}), 0);
    EXPECT_EQ(table.add({3, 2, 1}), 1);
    EXPECT_EQ(table.add({1, 2, 3}), 0);
    EXPECT_EQ(table.find({3, 2, 1}), 1);
    EXPECT_EQ(table.size(), 2U);
    EXPECT_EQ(table[1], (std::array<std::int64_t, 3>{3, 2, 1}));
}

}  // namespace
}  // namespace realmodel::booleans
