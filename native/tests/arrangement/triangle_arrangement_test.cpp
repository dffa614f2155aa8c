// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangle_arrangement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "../sanitized.hpp"

namespace realmodel::arrangement {
namespace {

class Arrangement {
public:
    std::int32_t add(const std::array<Position, 3>& corners) {
        return triangles.add(
            {points.add(corners[0]), points.add(corners[1]), points.add(corners[2])});
    }
    /// Intersects all pairs of the first `count` triangles and divides all.
    void divide(std::int32_t count) {
        for (std::int32_t i = 0; i < count; ++i) {
            for (std::int32_t j = i + 1; j < count; ++j) {
                if (const auto found = triangles.intersection(i, j)) triangles.insert(*found);
            }
        }
        triangles.divide({1, nullptr});
    }
    std::vector<Region> regions_of(std::int32_t triangle) const {
        std::vector<Region> found;
        for (std::size_t r = 0; r < triangles.regions().size(); ++r) {
            const Region region = triangles.regions()[r];
            if (region.triangle == triangle) found.push_back(region);
        }
        return found;
    }
    /// The nodes of a triangle's regions.
    std::set<Position> nodes_of(std::int32_t triangle) const {
        std::set<Position> found;
        for (const Region& region : regions_of(triangle)) {
            for (const auto loop : region.loops) {
                for (const SpacePointId p : loop)
                    found.insert(points.rounded(p));
            }
        }
        return found;
    }

    exact::SpacePoints points;
    TriangleArrangement triangles{points};
};

const std::array<Position, 3> kFloor{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

TEST(TriangleArrangement, TrianglesThatCrossShareASegment) {
    Arrangement a;
    const auto level = a.add(kFloor);
    const auto upright = a.add({{{1, 1, -1}, {1, 2, 1}, {1, 0.5, 1}}});  // x = 1, passes z = 0
    const auto found = a.triangles.intersection(level, upright);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->in_one_plane);
    a.divide(2);
    const Position p{1, 1.5, 0}, q{1, 0.75, 0};
    for (const std::int32_t t : {level, upright}) {
        EXPECT_TRUE(a.nodes_of(t).contains(p));
        EXPECT_TRUE(a.nodes_of(t).contains(q));
    }
    EXPECT_EQ(a.regions_of(level).size(), 1U);  // the segment is a slit in it
    EXPECT_EQ(a.regions_of(upright).size(), 2U);
}

TEST(TriangleArrangement, WhatIsApartOrSharesAnEdgeDoesNotIntersect) {
    Arrangement a;
    const auto level = a.add(kFloor);
    EXPECT_FALSE(a.triangles.intersection(level, a.add({{{1, 1, 1}, {1, 2, 2}, {2, 1, 3}}})));
    EXPECT_FALSE(a.triangles.intersection(level, a.add({{{0, 0, 0}, {4, 0, 0}, {1, 1, 3}}})));
    EXPECT_FALSE(a.triangles.intersection(level, a.add({{{4, 0, 0}, {0, 4, 0}, {4, 4, 0}}})));
    EXPECT_FALSE(a.triangles.intersection(level, a.add({{{5, 5, -1}, {6, 5, 1}, {5, 6, 1}}})));
}

TEST(TriangleArrangement, ACornerOnATriangleIsANodeOfBoth) {
    Arrangement a;
    const auto level = a.add(kFloor), above = a.add({{{1, 1, 0}, {1, 2, 1}, {2, 1, 1}}});
    const auto found = a.triangles.intersection(level, above);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->ends[0].from, found->ends[1].from);
    a.divide(2);
    EXPECT_EQ(a.regions_of(above).size(), 1U);
}

TEST(TriangleArrangement, TrianglesInOnePlaneDivideEachOther) {
    Arrangement a;
    const auto one = a.add(kFloor), other = a.add({{{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}});
    ASSERT_TRUE(a.triangles.intersection(one, other)->in_one_plane);
    a.divide(2);
    // both have the triangle (1, 1), (3, 1), (1, 3) and the rest of their own
    const std::set<Position> common{{1, 1, 0}, {3, 1, 0}, {1, 3, 0}};
    for (const std::int32_t t : {one, other}) {
        EXPECT_EQ(a.regions_of(t).size(), 2U);
        const auto nodes = a.nodes_of(t);
        EXPECT_TRUE(std::includes(nodes.begin(), nodes.end(), common.begin(), common.end()));
    }
}

TEST(TriangleArrangement, SegmentsThatCrossOnATriangleMeetInANodeOfAllThree) {
    Arrangement a;
    const auto level = a.add(kFloor);
    const auto along_x = a.add({{{-1, 1, -1}, {9, 1, -1}, {1, 1, 9}}});
    const auto along_y = a.add({{{1, -1, -1}, {1, 9, -1}, {1, 1, 9}}});
    a.divide(3);
    for (const std::int32_t t : {level, along_x, along_y})
        EXPECT_TRUE(a.nodes_of(t).contains(Position{1, 1, 0}));
    EXPECT_EQ(a.regions_of(level).size(), 4U);
}

TEST(TriangleArrangement, ALineInATriangleHasTheNodesOfWhatCrossesIt) {
    Arrangement a;
    const auto level = a.add(kFloor);
    const auto at = [&a](double x) { return a.points.add(Position{x, 0.5, 0}); };
    const auto begin = at(0.5), middle = at(1), end = at(3);  // numbered in this order
    const std::int32_t line = a.triangles.add_line(level, begin, end);
    EXPECT_EQ(a.triangles.add_line(level, begin, middle), line + 1);
    a.add({{{2, -1, -1}, {2, 9, -1}, {2, 1, 9}}});
    a.divide(2);
    const auto within = a.triangles.within_line(line);
    EXPECT_EQ(std::vector(within.begin(), within.end()), (std::vector{middle, at(2)}));
    EXPECT_TRUE(a.triangles.within_line(line + 1).empty());
    EXPECT_EQ(a.regions_of(level).size(), 2U);  // the lines end within these
}

TEST(TriangleArrangement, ANodeOnAnEdgeIsOneOfTheTriangleBeyond) {
    Arrangement a;
    const auto one = a.add(kFloor);
    const auto cutter = a.add({{{2, 2, -1}, {2, 2, 1}, {0, 0.5, 0}}});  // ends on the long edge
    const auto beyond = a.add({{{4, 0, 0}, {0, 4, 0}, {9, 9, 9}}});     // not asked for
    a.divide(2);
    EXPECT_TRUE(a.nodes_of(one).contains(Position{2, 2, 0}));
    EXPECT_TRUE(a.nodes_of(cutter).contains(Position{2, 2, 0}));
    EXPECT_TRUE(a.nodes_of(beyond).contains(Position{2, 2, 0}));
    EXPECT_EQ(a.regions_of(beyond)[0].loops[0].size(), 4U);
}

TEST(TriangleArrangement, EdgesOfRegionsAreUsedOnceEitherWayWithinATriangle) {
    Arrangement a;
    const auto level = a.add({{{0, 0, 0}, {16, 0, 0}, {0, 16, 0}}});
    for (int i = 1; i < 8; ++i)
        a.add({{{1.0 * i, -1, -1}, {1.0 * i, 20, -1}, {1.0 * i + 0.5, 3, 7.0 + i}}});
    for (int i = 1; i < 8; ++i)
        a.add({{{-1, 1.0 * i, -1}, {20, 1.0 * i, -1}, {3, 1.0 * i + 0.25, 9.0 - i}}});
    a.divide(15);
    std::map<std::array<SpacePointId, 2>, int> uses;
    for (const Region& region : a.regions_of(level)) {
        for (const auto loop : region.loops) {
            for (std::size_t i = 0; i < loop.size(); ++i)
                ++uses[{loop[i], loop[(i + 1) % loop.size()]}];
        }
    }
    const auto& corners = a.triangles.corners(level);
    for (const auto& [edge, times] : uses) {
        EXPECT_EQ(times, 1);
        const int back = uses.contains({edge[1], edge[0]}) ? 1 : 0;
        bool on_border = false;
        for (std::size_t i = 0; i < 3; ++i) {
            on_border =
                on_border ||
                (exact::orient2d(a.points, 2, corners[i], corners[(i + 1) % 3], edge[0]) == 0 &&
                 exact::orient2d(a.points, 2, corners[i], corners[(i + 1) % 3], edge[1]) == 0);
        }
        EXPECT_EQ(back, on_border ? 0 : 1);
    }
}

TEST(TriangleArrangement, ALargeTriangleIsDividedAsSmallOnesAreOnAnyNumberOfThreads) {
    constexpr int kAcross = 8, kAlong = 560;  // upright triangles, of which each two cross on it
    std::vector<std::vector<SpacePointId>> first;
    for (const int threads : {1, 2, 5}) {
        if (kSanitized && threads == 2) continue;
        Arrangement a;
        const auto level = a.add({{{-2000, -100, 0}, {2000, -100, 0}, {0, 2000, 0}}});
        for (int i = 1; i <= kAlong; ++i)
            a.add({{{1.0 * i, -9, -1}, {1.0 * i, 30, -1}, {1.0 * i + 0.3, 4, 99}}});
        for (int i = 1; i <= kAcross; ++i)
            a.add({{{-99, 1.0 * i, -1}, {700, 1.0 * i, -1}, {300, 1.0 * i - 0.4, 99}}});
        for (std::int32_t other = 1; other <= kAlong + kAcross; ++other)
            a.triangles.insert(a.triangles.intersection(level, other).value());
        a.triangles.divide({threads, nullptr});
        const auto regions = a.regions_of(level);
        ASSERT_EQ(regions.size(), 1U + (kAlong - 1) * (kAcross - 1));
        std::vector<std::vector<SpacePointId>> loops;
        for (const Region& region : regions) {
            for (const auto loop : region.loops)
                loops.emplace_back(loop.begin(), loop.end());
        }
        EXPECT_EQ(std::ranges::count_if(loops, [](const auto& loop) { return loop.size() == 4; }),
                  (kAlong - 1) * (kAcross - 1));
        // those that cross it know the nodes on their segments
        EXPECT_EQ(a.nodes_of(1).size(), 3U + 2 + kAcross);
        EXPECT_EQ(a.nodes_of(kAlong + 1).size(), 3U + 2 + kAlong);
        if (first.empty()) first = loops;
        EXPECT_EQ(loops, first);
    }
}

}  // namespace
}  // namespace realmodel::arrangement
