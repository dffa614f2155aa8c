// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "meshing/winding.hpp"
#include "plan_mesh_checks.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {
namespace {

using Segments = std::vector<std::array<std::int32_t, 2>>;

/// Edges of the result that it calls constrained, lower number first.
std::set<std::pair<int, int>> constrained_edges(const ConstrainedTriangulation& mesh) {
    std::set<std::pair<int, int>> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
            const int a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
            if (mesh.constrained[t][i]) edges.insert(std::minmax(a, b));
        }
    }
    return edges;
}

void expect_consistent(const ConstrainedTriangulation& mesh) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
            const int across = mesh.neighbors[t][i];
            if (across < 0) continue;
            const auto& back = mesh.neighbors[across];
            const auto at = std::find(back.begin(), back.end(), static_cast<int>(t));
            ASSERT_NE(at, back.end());
            const auto j = static_cast<std::size_t>(at - back.begin());
            EXPECT_EQ(mesh.triangles[across][j], mesh.triangles[t][(i + 1) % 3]);
            EXPECT_EQ(mesh.triangles[across][(j + 1) % 3], mesh.triangles[t][i]);
            EXPECT_EQ(mesh.constrained[across][j], mesh.constrained[t][i]);
        }
    }
}

TEST(ConstrainedDelaunay, KeepsTheDiagonalAskedFor) {
    // Without the segment the short diagonal 1-3 would be Delaunay.
    const std::vector<PlanPoint> kite{{0, 0}, {5, -1}, {10, 0}, {5, 1}};
    const auto free = constrained_delaunay(kite, {});
    EXPECT_EQ(free.triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 1, 3}, {1, 2, 3}}));
    const auto forced = constrained_delaunay(kite, Segments{{2, 0}});
    EXPECT_EQ(forced.triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(forced.neighbors,
              (std::vector<std::array<std::int32_t, 3>>{{-1, -1, 1}, {0, -1, -1}}));
    EXPECT_EQ(constrained_edges(forced), (std::set<std::pair<int, int>>{{0, 2}}));
}

TEST(ConstrainedDelaunay, SegmentsMayTouchAndOverlap) {
    // 0-4 passes through 2; 1-3 overlaps it; 5-2 touches it in the middle.
    const std::vector<PlanPoint> points{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {2, 3}, {2, -3}};
    const auto mesh = constrained_delaunay(points, Segments{{0, 4}, {3, 1}, {5, 2}, {0, 4}});
    expect_consistent(mesh);
    EXPECT_EQ(constrained_edges(mesh),
              (std::set<std::pair<int, int>>{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {2, 5}}));
}

TEST(ConstrainedDelaunay, TellsWhichEdgesASegmentHas) {
    const std::vector<PlanPoint> points{{4, 0}, {2, 0}, {0, 0}, {2, 3}};
    const auto mesh = constrained_delaunay(points, Segments{{0, 2}, {1, 2}});
    EXPECT_EQ(mesh.covered, (std::vector<CoveredEdge>{{0, 1, 0}, {1, 2, 0}, {1, 2, 1}}));
}

TEST(WindingNumbers, ChainsCountByTheirWeights) {
    // a square within a square, one side of which passes through a point, and around both a frame
    const std::vector<PlanPoint> points{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}, {0, 0}, {4, 0}, {4, 4},
                                        {0, 4},   {2, 0},  {1, 1}, {1, 3},  {3, 3}, {3, 1}};
    const Segments segments{{4, 5}, {5, 6}, {6, 7}, {7, 4}, {9, 10}, {10, 11}, {11, 12}, {12, 9}};
    const std::vector<std::int32_t> weights{2, 2, 2, 2, 3, 3, 3, 3};
    const auto mesh = constrained_delaunay(points, segments);
    const auto winding = winding_numbers(mesh, points, segments, weights);
    std::map<std::int32_t, double> areas;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        areas[winding[t]] += 0.5 * twice_area(points[a], points[b], points[c]);
    }
    EXPECT_EQ(areas, (std::map<std::int32_t, double>{{0, 324 - 16}, {2, 16 - 4}, {2 - 3, 4}}));
}

TEST(ConstrainedDelaunay, RefusesACrossingWithItsPlace) {
    const std::vector<PlanPoint> points{{0, 0}, {4, 4}, {0, 4}, {4, 0}, {9, 9}, {8, 9}};
    const InputError error = refusal([&] {
        constrained_delaunay(points, Segments{{4, 5}, {0, 1}, {2, 3}});
    });
    EXPECT_EQ(error.kind, "crossing");
    EXPECT_EQ(error.items, (std::vector<std::int64_t>{1, 2}));
    EXPECT_EQ(*error.place, (std::array<double, 3>{2, 2, 0}));
}

TEST(ConstrainedDelaunay, RefusesWhatIsNoInput) {
    const double nan = std::nan("");
    const std::vector<PlanPoint> repeated{{0, 0}, {1, 0}, {0, 0}};
    EXPECT_EQ(refusal([&] { constrained_delaunay(repeated, {}); }).items,
              (std::vector<std::int64_t>{0, 2}));
    const std::vector<PlanPoint> broken{{0, 0}, {1, nan}};
    EXPECT_EQ(refusal([&] { constrained_delaunay(broken, {}); }).kind, "not_finite");
    const std::vector<PlanPoint> two{{0, 0}, {1, 0}};
    EXPECT_EQ(refusal([&] { constrained_delaunay(two, Segments{{0, 2}}); }).kind, "bad_index");
    EXPECT_EQ(refusal([&] { constrained_delaunay(two, Segments{{1, 1}}); }).kind, "bad_index");
}

TEST(ConstrainedDelaunay, PointsInOneLineHaveNoTriangles) {
    const std::vector<PlanPoint> line{{0, 0}, {1, 1}, {2, 2}, {5, 5}};
    EXPECT_TRUE(constrained_delaunay(line, Segments{{0, 3}}).triangles.empty());
    EXPECT_TRUE(constrained_delaunay({}, {}).triangles.empty());
}

TEST(ConstrainedDelaunay, ALatticeWhereEveryCircleIsATieRepeats) {
    std::vector<PlanPoint> points;
    Segments segments;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x)
            points.push_back({x + 4.5e5, y + 5.2e6});
    }
    for (std::int32_t x = 0; x < 39; ++x)
        segments.push_back({x * 40, x * 40 + 39});
    const auto first = constrained_delaunay(points, segments);
    EXPECT_EQ(first.triangles.size(), 2U * 39 * 39);
    expect_consistent(first);
    const std::vector<std::string> elsewhere(100, "moves the heap about");
    const auto second = constrained_delaunay(points, segments);
    EXPECT_EQ(first.triangles, second.triangles);
    EXPECT_EQ(first.neighbors, second.neighbors);
}

TEST(ConstrainedDelaunay, NoPointLiesInTheCircleOfAFreeEdge) {
    std::mt19937 random(7);
    std::vector<PlanPoint> points;
    for (int i = 0; i < 200; ++i) {
        points.push_back(
            {static_cast<double>(random() % 1000), static_cast<double>(random() % 1000)});
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    const auto mesh = constrained_delaunay(points, {});
    expect_consistent(mesh);
    for (const auto& t : mesh.triangles) {
        const PlanPoint &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
        ASSERT_EQ(orient2d(a, b, c), 1);
        for (const PlanPoint& p : points) {
            // Integers below 1000: this determinant is exact in double.
            const double ax = a[0] - p[0], ay = a[1] - p[1], bx = b[0] - p[0], by = b[1] - p[1],
                         cx = c[0] - p[0], cy = c[1] - p[1];
            const double in_circle = (ax * ax + ay * ay) * (bx * cy - cx * by) -
                                     (bx * bx + by * by) * (ax * cy - cx * ay) +
                                     (cx * cx + cy * cy) * (ax * by - bx * ay);
            ASSERT_LE(in_circle, 0);
        }
    }
}

}  // namespace
}  // namespace realmodel::meshing
