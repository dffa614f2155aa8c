// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {
namespace {

/// Corners from the one with the least number on.
std::vector<PointId> corners_of(PolygonView polygon) {
    std::vector<PointId> result;
    for (const Corner& corner : polygon)
        result.push_back(corner.point);
    if (!result.empty())
        std::rotate(result.begin(), std::min_element(result.begin(), result.end()), result.end());
    return result;
}

/// Triangles with corners drawn from a lattice of `steps` positions a side (where much coincides)
/// or, with 0, anywhere.
std::vector<Polygon> draw_triangles(exact::PlanArrangement& geometry, int count, int steps,
                                    std::mt19937_64& random) {
    const auto coordinate = [&] {
        if (steps > 0)
            return static_cast<double>(std::uniform_int_distribution<int>(0, steps)(random));
        return std::uniform_real_distribution<double>(0, 1)(random);
    };
    std::vector<PlanTriangle> triangles;
    while (static_cast<int>(triangles.size()) < count) {
        std::array<std::array<double, 2>, 3> p;
        for (auto& corner : p)
            corner = {coordinate(), coordinate()};
        const double turn =
            (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        if (std::abs(turn) < 1e-6) continue;
        if (turn < 0) std::swap(p[1], p[2]);
        PlanTriangle v;
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = geometry.add_vertex(p[i][0], p[i][1]);
        triangles.push_back(v);
    }
    geometry.freeze_vertices();
    std::vector<Polygon> polygons;
    for (const PlanTriangle& v : triangles) {
        const auto outline = triangle_outline(geometry, v);
        polygons.emplace_back(outline.begin(), outline.end());
    }
    return polygons;
}

/// What is left of a polygon by all lines of another one, one after another.
Polygon cut_line_by_line(LocalArrangement& scope, Polygon polygon, PolygonView window) {
    for (const Corner& edge : window) {
        std::vector<std::int8_t> sides;
        for (const Corner& corner : polygon)
            sides.push_back(static_cast<std::int8_t>(scope.side(edge.line, corner.point)));
        if (std::ranges::none_of(sides, [](int side) { return side > 0; })) return {};
        Polygon left;
        keep_left(scope, polygon, edge.line, sides, left);
        polygon = left;
    }
    return polygon;
}

class ClipperTest : public testing::TestWithParam<int> {};

TEST_P(ClipperTest, TakesWhatIsLeftByAllLines) {
    std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 7);
    exact::PlanArrangement geometry;
    const auto triangles = draw_triangles(geometry, 120, GetParam(), random);
    LocalArrangement scope(geometry);
    Clipper clipper(scope);
    int common = 0, apart = 0;
    for (std::size_t i = 0; i < 60; ++i) {
        // polygons of four to six corners too, where the first two have enough in common
        Polygon facet = triangles[i];
        const Polygon part = cut_line_by_line(scope, facet, triangles[(i + 60) % 120]);
        if (i % 2 == 0 && !part.empty()) facet = part;
        clipper.begin(facet);
        for (std::size_t j = 60; j < triangles.size(); ++j) {
            const PolygonView found = clipper.intersect(triangles[j]);
            const std::vector<Corner> result(found.begin(), found.end());
            const Polygon expected = cut_line_by_line(scope, facet, triangles[j]);
            ASSERT_EQ(corners_of(result), corners_of(expected)) << i << ", " << j;
            ASSERT_EQ(clipper.overlaps(triangles[j]), !expected.empty()) << i << ", " << j;
            for (std::size_t k = 0; k < result.size(); ++k) {
                // each edge runs along its line
                const PointId next = result[k + 1 < result.size() ? k + 1 : 0].point;
                EXPECT_EQ(scope.side(result[k].line, result[k].point), 0);
                EXPECT_EQ(scope.side(result[k].line, next), 0);
            }
            ++(result.empty() ? apart : common);
        }
    }
    EXPECT_GT(common, 200);
    EXPECT_GT(apart, 200);
}

INSTANTIATE_TEST_SUITE_P(AnywhereAndOnLattices, ClipperTest, testing::Values(0, 3, 12));

TEST(Clipper, WindowInsideFacetAndFacetInsideWindow) {
    exact::PlanArrangement geometry;
    const auto triangle = [&](double size) {
        return PlanTriangle{geometry.add_vertex(-size, -size), geometry.add_vertex(size, -size),
                            geometry.add_vertex(0, size)};
    };
    const PlanTriangle large = triangle(8), small = triangle(1);
    geometry.freeze_vertices();
    const auto outer = triangle_outline(geometry, large), inner = triangle_outline(geometry, small);
    LocalArrangement scope(geometry);
    Clipper clipper(scope);
    clipper.begin(outer);
    EXPECT_EQ(corners_of(clipper.intersect(inner)), corners_of(inner));
    clipper.begin(inner);
    EXPECT_EQ(corners_of(clipper.intersect(outer)), corners_of(inner));
}

}  // namespace
}  // namespace realmodel::strata
