// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangle_regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace realmodel::arrangement {
namespace {

/// A plane graph in z = 0.
class Graph {
public:
    SpacePointId at(double x, double y) { return points.add(Position{x, y, 0}); }
    void ring(const std::vector<std::array<double, 2>>& corners) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto &p = corners[i], &q = corners[(i + 1) % corners.size()];
            edge(p[0], p[1], q[0], q[1]);
        }
    }
    void square(double x, double y, double size) {
        ring({{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}});
    }
    void edge(double x, double y, double to_x, double to_y) {
        edges.push_back(unordered(at(x, y), at(to_x, to_y)));
    }
    LoopTable<SpacePointId> regions(int facing = 1) {
        std::sort(edges.begin(), edges.end());
        LoopTable<SpacePointId> found;
        PlaneGraph(points).add_regions({2, facing}, edges, found);
        return found;
    }
    double twice_area(std::span<const SpacePointId> loop) const {
        double sum = 0;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Position &p = points.rounded(loop[i]),
                           &q = points.rounded(loop[(i + 1) % loop.size()]);
            sum += p[0] * q[1] - p[1] * q[0];
        }
        return sum;
    }
    /// Twice the areas of the regions, holes taken away, in order of size.
    std::vector<double> areas() {
        std::vector<double> result;
        const auto found = regions();
        for (std::size_t r = 0; r < found.size(); ++r) {
            double sum = 0;
            for (const auto loop : found[r])
                sum += twice_area(loop);
            result.push_back(sum);
        }
        std::sort(result.begin(), result.end());
        return result;
    }

    exact::SpacePoints points;
    std::vector<std::array<SpacePointId, 2>> edges;
};

TEST(TriangleRegions, ALineDividesATriangle) {
    Graph g;
    g.ring({{0, 0}, {4, 0}, {4, 2}, {0, 4}});
    g.edge(0, 0, 4, 2);
    EXPECT_EQ(g.areas(), (std::vector<double>{8, 16}));
}

TEST(TriangleRegions, LoopsTurnAsTheTriangleIsSeen) {
    Graph g;
    g.square(0, 0, 4);
    const auto ahead = g.regions(1), reversed = g.regions(-1);
    ASSERT_EQ(ahead.size(), 1U);
    ASSERT_EQ(reversed.size(), 1U);
    EXPECT_EQ(g.twice_area(ahead[0][0]), 32);
    EXPECT_EQ(g.twice_area(reversed[0][0]), -32);
}

TEST(TriangleRegions, AHoleIsARegionAndTakenFromTheOneAround) {
    Graph g;
    g.square(0, 0, 10);
    g.square(1, 1, 2);
    g.square(5, 1, 3);
    EXPECT_EQ(g.areas(), (std::vector<double>{8, 18, 200 - 26}));
    const auto regions = g.regions();
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const auto loops = regions[r];
        EXPECT_GT(g.twice_area(loops[0]), 0);
        for (std::size_t i = 1; i < loops.size(); ++i)
            EXPECT_LT(g.twice_area(loops[i]), 0);
    }
}

TEST(TriangleRegions, HolesNest) {
    Graph g;
    g.square(0, 0, 10);
    g.square(1, 1, 8);
    g.square(2, 2, 6);
    g.square(3, 3, 1);
    g.square(5, 3, 1);
    EXPECT_EQ(g.areas(), (std::vector<double>{2, 2, 56, 68, 72}));
}

TEST(TriangleRegions, AHoleRightAboveAnotherIsNotInIt) {
    // the leftmost node of the upper one is above an upright edge, and above a corner
    Graph g;
    g.square(0, 0, 10);
    g.square(1, 1, 2);
    g.square(1, 5, 2);
    g.ring({{3, 4}, {4, 4}, {4, 4.5}});
    EXPECT_EQ(g.areas(), (std::vector<double>{0.5, 8, 8, 200 - 16.5}));
}

TEST(TriangleRegions, ASlitAndALooseEdgeMakeNoRegion) {
    Graph g;
    g.square(0, 0, 4);
    g.edge(0, 0, 1, 1);  // into the region from its corner
    g.edge(2, 1, 3, 1);  // within it
    const auto regions = g.regions();
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_EQ(regions[0].size(), 2U);
    EXPECT_EQ(regions[0][0].size(), 6U);
    EXPECT_EQ(regions[0][1].size(), 2U);
}

TEST(TriangleRegions, GraphsOneAfterAnotherAddTheirRegions) {
    Graph g;
    g.square(0, 0, 10);
    g.square(1, 1, 2);
    std::sort(g.edges.begin(), g.edges.end());
    const auto holes = g.edges;
    g.edges.clear();
    g.square(20, 0, 3);
    const LoopTable<SpacePointId> square = g.regions();
    LoopTable<SpacePointId> found;
    PlaneGraph graph(g.points);
    graph.add_regions({2, 1}, holes, found);
    graph.add_regions({2, 1}, g.edges, found);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].size() + found[1].size(), 3U);
    EXPECT_TRUE(std::ranges::equal(found[2][0], square[0][0]));
    EXPECT_EQ(found[2].size(), 1U);
}

TEST(TriangleRegions, ManyHolesInManyRegions) {
    Graph g;
    constexpr int kSide = 12;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            for (const auto& [x, y] : {std::pair(1, 0), std::pair(0, 1)})
                g.edge(4 * i, 4 * j, 4 * (i + x), 4 * (j + y));
            g.square(4 * i + 1, 4 * j + 1, 2);
        }
        g.edge(4 * kSide, 4 * i, 4 * kSide, 4 * i + 4);
        g.edge(4 * i, 4 * kSide, 4 * i + 4, 4 * kSide);
    }
    std::vector<double> expected(kSide * kSide, 8.0);
    expected.resize(2 * kSide * kSide, 24.0);
    EXPECT_EQ(g.areas(), expected);
}

}  // namespace
}  // namespace realmodel::arrangement
