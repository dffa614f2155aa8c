// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "meshing/improvement.hpp"

namespace realmodel::meshing {
namespace {

constexpr std::int32_t kWidth = 16;

std::int32_t node(std::int32_t i, std::int32_t j) {
    return i + kWidth * j;
}

/// A rhombus of equilateral triangles, each square of nodes divided from its lower right corner to
/// its upper left one; its border is fixed.
FlatMesh lattice() {
    FlatMesh mesh;
    for (std::int32_t j = 0; j < kWidth; ++j)
        for (std::int32_t i = 0; i < kWidth; ++i)
            mesh.points.push_back({i + 0.5 * j, std::numbers::sqrt3 / 2 * j});
    for (std::int32_t j = 0; j + 1 < kWidth; ++j) {
        for (std::int32_t i = 0; i + 1 < kWidth; ++i) {
            mesh.add_triangle({node(i, j), node(i + 1, j), node(i, j + 1)});
            mesh.add_triangle({node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
        }
    }
    std::map<std::array<std::int32_t, 2>, HalfEdge> edges;
    const auto count = static_cast<std::int32_t>(mesh.corners.size());
    for (std::int32_t t = 0; t < count; ++t)
        for (int i = 0; i < 3; ++i)
            edges[{mesh.from({t, i}), mesh.to({t, i})}] = {t, i};
    for (const auto& [ends, edge] : edges) {
        const auto other = edges.find({ends[1], ends[0]});
        if (other != edges.end()) {
            mesh.join(edge, other->second);
        } else {
            mesh.fix(edge);
        }
    }
    return mesh;
}

/// A lattice in which `flips` neighboring diagonals between two rows were flipped: a vertex with
/// five neighbors beside one with seven at either end, so many rows apart.
struct TornLattice {
    explicit TornLattice(int flips)
        : mesh(lattice()), size(1), valences(mesh, size), moves(valences) {
        for (std::int32_t v = 0; v < kWidth * kWidth; ++v)
            if (!valences.is_fixed(v)) moves.free(v);
        for (int k = 0; k < flips; ++k)
            valences.flip(edge(node(begin + k + 1, row), node(begin + k, row + 1)));
    }

    HalfEdge edge(std::int32_t from, std::int32_t to) const {
        HalfEdge found = HalfEdge::none();
        valences.around(from, [&](HalfEdge s) {
            if (mesh.to(s) == to) found = s;
        });
        return found;
    }

    int irregular() const {
        int count = 0;
        for (std::int32_t v = 0; v < kWidth * kWidth; ++v)
            count += !valences.is_fixed(v) && !valences.is_regular(v);
        return count;
    }

    static constexpr std::int32_t begin = 4, row = 7;
    FlatMesh mesh;
    SizeField size;
    Valences valences;
    StarMoves moves;
};

TEST(JudgedFlips, DislocationsAreGoneWhereTheyMeet) {
    TornLattice torn(6);
    ASSERT_EQ(torn.irregular(), 4);
    ASSERT_EQ(torn.valences.triangles(node(4, 7)), 7);
    const FlatMesh whole = lattice();
    JudgedFlips flips(torn.valences, torn.moves);
    EXPECT_TRUE(flips.glide(node(4, 7), 6));
    EXPECT_EQ(torn.irregular(), 0);
    EXPECT_FALSE(flips.glide(node(4, 7), 6)) << "nothing is left to gain";
    for (std::int32_t v = 0; v < kWidth * kWidth; ++v) {
        EXPECT_NEAR(torn.mesh.points[v][0], whole.points[v][0], 1e-9);
        EXPECT_NEAR(torn.mesh.points[v][1], whole.points[v][1], 1e-9);
    }
}

TEST(JudgedFlips, DislocationsStayWhereNoWayIsShortEnough) {
    TornLattice torn(6);
    const auto corners = torn.mesh.corners;
    const auto points = torn.mesh.points;
    EXPECT_FALSE(JudgedFlips(torn.valences, torn.moves).glide(node(4, 7), 5));
    EXPECT_EQ(torn.irregular(), 4);
    EXPECT_EQ(torn.mesh.points, points);
    // The same edges, though their triangles may have other numbers.
    for (const auto& t : corners)
        for (int i = 0; i < 3; ++i)
            EXPECT_FALSE(torn.edge(t[i], t[(i + 1) % 3]).is_none());
}

TEST(JudgedFlips, DislocationsDoNotPassVerticesThatStay) {
    TornLattice torn(6);
    StarMoves moves(torn.valences);
    for (std::int32_t v = 0; v < kWidth * kWidth; ++v)
        if (!torn.valences.is_fixed(v) && v != node(7, 7)) moves.free(v);
    EXPECT_FALSE(JudgedFlips(torn.valences, moves).glide(node(4, 7), 6));
    EXPECT_EQ(torn.irregular(), 4);
}

/// A flip that brings thin triangles is taken back, whatever strain it costs; one that would is not
/// made.
TEST(JudgedFlips, MendWhatIsBad) {
    TornLattice torn(0);
    const HalfEdge diagonal = torn.edge(node(5, 7), node(4, 8));
    torn.valences.flip(diagonal);
    ASSERT_EQ(torn.irregular(), 4);
    JudgedFlips flips(torn.valences, torn.moves);
    EXPECT_TRUE(flips.mend(node(4, 7)));
    EXPECT_EQ(torn.irregular(), 0);
    const auto corners = torn.mesh.corners;
    for (std::int32_t v = 0; v < kWidth * kWidth; ++v)
        EXPECT_FALSE(!torn.valences.is_fixed(v) && flips.mend(v));
    EXPECT_EQ(torn.mesh.corners, corners);
}

}  // namespace
}  // namespace realmodel::meshing
