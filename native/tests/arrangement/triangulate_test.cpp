// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "small_polygons.hpp"

namespace realmodel::arrangement {
namespace {

class Corners {
public:
    Loop loop(const std::vector<PlanePosition>& positions) {
        Loop result;
        for (const PlanePosition& p : positions) {
            auto found = std::find(known_.begin(), known_.end(), p);
            if (found == known_.end()) found = known_.insert(known_.end(), p);
            result.push_back({static_cast<NodeId>(found - known_.begin()), p});
        }
        return result;
    }
    const PlanePosition& at(NodeId node) const { return known_[index(node)]; }

private:
    std::vector<PlanePosition> known_;
};

double signed_area(const std::vector<PlanePosition>& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const auto &a = p[i], &b = p[(i + 1) % p.size()];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return sum / 2;
}

/// The polygons tile the region: areas, convexity, and every loop edge once, others twice.
void expect_tiles(const Corners& corners, const std::vector<Loop>& loops, double expected,
                  std::span<const std::array<NodeId, 2>> slits = {}) {
    Polygons polygons;
    divide_convex(loops, {1e-12, 1e-12}, slits, polygons);
    double total = 0;
    std::map<std::array<NodeId, 2>, int> edges;
    for (const Loop& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i)
            --edges[std::array{loop[i].node, loop[(i + 1) % loop.size()].node}];
    }
    for (std::size_t k = 0; k < polygons.size(); ++k) {
        Loop loop;
        std::vector<PlanePosition> positions;
        for (const NodeId node : polygons[k]) {
            loop.push_back({node, corners.at(node)});
            positions.push_back(corners.at(node));
        }
        EXPECT_TRUE(is_convex(loop, {1e-12, 1e-12}));
        EXPECT_GT(signed_area(positions), 0);
        total += signed_area(positions);
        for (std::size_t i = 0; i < loop.size(); ++i)
            ++edges[std::array{loop[i].node, loop[(i + 1) % loop.size()].node}];
    }
    EXPECT_NEAR(total, expected, 1e-12 * std::abs(expected));
    for (const auto& [edge, count] : edges)
        EXPECT_EQ(count, (edges[std::array{edge[1], edge[0]}])) << edge[0] << "-" << edge[1];
}

TEST(Triangulate, AConvexLoopStaysWhole) {
    Corners corners;
    Polygons polygons;
    const std::vector<Loop> loops{corners.loop({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}})};
    divide_convex(loops, {1e-12, 1e-12}, {}, polygons);
    EXPECT_EQ(polygons.size(), 1u);
    EXPECT_EQ(polygons[0].size(), 5u);
}

TEST(Triangulate, AnLShape) {
    Corners corners;
    expect_tiles(corners, {corners.loop({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})}, 3);
}

TEST(Triangulate, HolesAndAnotherOutline) {
    Corners corners;
    const std::vector<Loop> loops{corners.loop({{0, 0}, {9, 0}, {9, 9}, {0, 9}}),
                                  corners.loop({{1, 1}, {1, 2}, {2, 2}, {2, 1}}),
                                  corners.loop({{4, 1}, {4, 8}, {8, 8}, {8, 1}}),
                                  corners.loop({{5, 2}, {7, 2}, {7, 7}, {5, 7}}),
                                  corners.loop({{6, 3}, {6, 4}, {6.5, 4}})};
    expect_tiles(corners, loops, 81 - 1 - 28 + 10 - 0.25);
}

TEST(Triangulate, ASlitStays) {
    Corners corners;
    const std::vector<Loop> loops{corners.loop({{0, 0}, {4, 0}, {4, 4}, {0, 4}}),
                                  corners.loop({{1, 2}, {3, 2}})};
    const std::array<NodeId, 2> slit{loops[1][0].node, loops[1][1].node};
    expect_tiles(corners, loops, 16, std::span(&slit, 1));
    Polygons polygons;
    divide_convex(loops, {1e-12, 1e-12}, std::span(&slit, 1), polygons);
    int ahead = 0, back = 0;
    for (std::size_t k = 0; k < polygons.size(); ++k) {
        for (std::size_t i = 0; i < polygons[k].size(); ++i) {
            const NodeId a = polygons[k][i], b = polygons[k][(i + 1) % polygons[k].size()];
            ahead += a == slit[0] && b == slit[1];
            back += a == slit[1] && b == slit[0];
        }
    }
    EXPECT_EQ(ahead, 1);
    EXPECT_EQ(back, 1);
}

TEST(Triangulate, AHoleThatTouchesTheOutline) {
    Corners corners;
    // one walk that passes (2, 0) twice
    expect_tiles(corners,
                 {corners.loop({{0, 0}, {2, 0}, {1, 1}, {3, 1}, {2, 0}, {4, 0}, {4, 4}, {0, 4}})},
                 15);
}

TEST(Triangulate, ALongCombOfManyTeeth) {
    Corners corners;
    std::vector<PlanePosition> comb{{0, -1}, {1000, -1}};
    for (int i = 1000; i > 0; --i) {
        comb.push_back({static_cast<double>(i), 0});
        comb.push_back({i - 0.5, 5.0 + i % 7});
    }
    comb.push_back({0, 0});
    expect_tiles(corners, {corners.loop(comb)}, signed_area(comb));
}

TEST(Triangulate, WhatRoundingHasFoldedOverStaysClosedAndTurnsNothingOver) {
    Corners corners;
    const double p = 4 + 1e-9, q = 4 + 2e-9;
    // dents that poke through: from within, and one whose edge ends where it pokes; a border that
    // runs back along itself
    for (const Loop& loop :
         {corners.loop({{0, 0}, {4, 0}, {4, 4}, {2, -1e-9}, {0, 4}}),
          corners.loop({{0, 0}, {4, 0}, {3, 1}, {2, -1e-9}}),
          corners.loop({{0, 0}, {4, 0}, {4, 1}, {p, 1}, {p, 0}, {q, 0}, {q, 4}, {0, 4}})}) {
        Polygons polygons;
        divide_convex({&loop, 1}, {1e-8, 1e-8}, {}, polygons);
        std::map<std::array<NodeId, 2>, int> edges;
        for (std::size_t i = 0; i < loop.size(); ++i)
            --edges[std::array{loop[i].node, loop[(i + 1) % loop.size()].node}];
        for (std::size_t k = 0; k < polygons.size(); ++k) {
            const auto nodes = polygons[k];
            std::vector<PlanePosition> positions;
            Loop own;
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                own.push_back({nodes[i], corners.at(nodes[i])});
                ++edges[std::array{nodes[i], nodes[(i + 1) % nodes.size()]}];
                positions.push_back(corners.at(nodes[i]));
            }
            EXPECT_GT(signed_area(positions), -1e-7);
            EXPECT_TRUE(is_convex(own, {1e-8, 1e-8}));
        }
        for (const auto& [edge, count] : edges)
            EXPECT_EQ(count, (edges[std::array{edge[1], edge[0]}]));
    }
}

constexpr PlanePosition kNoRounding{0, 0}, kTenth{0.1, 0.1};

/// Nodes from 0 on at some positions.
Loop numbered(const std::vector<PlanePosition>& positions) {
    Loop loop;
    for (std::size_t i = 0; i < positions.size(); ++i)
        loop.push_back({NodeId{static_cast<int>(i)}, positions[i]});
    return loop;
}

std::vector<NodeLoop> divided(const Loop& loop, const PlanePosition& rounding,
                              std::vector<std::array<NodeId, 2>> slits = {}) {
    Polygons polygons;
    EXPECT_TRUE(divide_convex({&loop, 1}, rounding, slits, polygons));
    return loops_of(polygons);
}

TEST(ConvexDivision, ALoopThatTurnsLeftOrGoesStraightOnIsConvex) {
    EXPECT_TRUE(is_convex(numbered({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}), kNoRounding));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {0, 2}, {2, 2}, {2, 0}}), kNoRounding));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {2, 0}}), kNoRounding));
}

TEST(ConvexDivision, ADentCountsWhereItIsDeeperThanRounding) {
    // 2 x depth against 0.1 x the way along either axis, which is 3 in all
    EXPECT_TRUE(is_convex(numbered({{0, 0}, {1, 0.64}, {2, 1}, {0, 3}}), kTenth));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {1, 0.66}, {2, 1}, {0, 3}}), kTenth));
    EXPECT_FALSE(is_convex(numbered({{0, 0}, {1, 0.51}, {2, 1}, {0, 3}}), kNoRounding));
}

TEST(ConvexDivision, AShortEdgeHidesNoTurn) {
    // a strip with a bend, on the inner side of which an edge is hardly longer than rounding
    const Loop strip =
        numbered({{0, 0}, {0.5, -3.4}, {1.5e-5, 0}, {1e-5, 0}, {-0.099, 1.9}, {-0.8, 15.2}});
    constexpr PlanePosition kRounding{1e-6, 4e-3};
    EXPECT_FALSE(is_convex(strip, kRounding));
    EXPECT_EQ(divided(strip, kRounding).size(), 2U);
}

TEST(ConvexDivision, WhatWindsRoundTwiceIsNotConvex) {
    // a pentagram turns left at each of its points
    EXPECT_FALSE(is_convex(numbered({{0, 3}, {-2, -3}, {3, 1}, {-3, 1}, {2, -3}}), kNoRounding));
}

TEST(ConvexDivision, WhatPassesANodeTwiceIsNotConvex) {
    Loop loop = numbered({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
    EXPECT_TRUE(is_convex(loop, kNoRounding));
    loop.push_back(loop.back());
    EXPECT_FALSE(is_convex(loop, kNoRounding));
}

TEST(ConvexDivision, AnArrowFallsInTwoAtItsDent) {
    const auto polygons = divided(numbered({{0, 0}, {4, -2}, {3, 0}, {4, 2}}), kNoRounding);
    EXPECT_EQ(polygons, (std::vector<NodeLoop>{node_loop({0, 1, 2}), node_loop({0, 2, 3})}));
}

TEST(ConvexDivision, ADentOfRoundingIsLeftInItsPolygon) {
    const Loop loop = numbered({{0, 0}, {1, 0.09}, {2, 0}, {2, 2}, {0, 2}});
    EXPECT_EQ(divided(loop, kTenth).size(), 1U);
    EXPECT_GT(divided(loop, kNoRounding).size(), 1U);
}

TEST(ConvexDivision, TrianglesAreNotMergedAcrossASlit) {
    // beside the dent at 3 the quadrangle 0-1-2-3, whichever of its diagonals divides it first
    const Loop loop = numbered({{0, 0}, {2, -2}, {4, -2}, {3, 0}, {4, 2}});
    EXPECT_EQ(divided(loop, kNoRounding),
              (std::vector<NodeLoop>{node_loop({0, 1, 2, 3}), node_loop({0, 3, 4})}));
    EXPECT_EQ(divided(loop, kNoRounding, {{NodeId{0}, NodeId{2}}, {NodeId{1}, NodeId{3}}}).size(),
              3U);
}

}  // namespace
}  // namespace realmodel::arrangement
