// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/plan_links.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace realmodel::strata {
namespace {

using exact::VertexId;

std::map<std::pair<VertexId, VertexId>, std::int32_t> nets(const PlanLinks& links) {
    std::map<std::pair<VertexId, VertexId>, std::int32_t> found;
    for (const BorderEdge& edge : links.border)
        found[{edge.low, edge.high}] = edge.net;
    return found;
}

TEST(PlanLinks, NeighborsAreWhereTwoTrianglesPassAnEdgeBothWays) {
    const std::vector<PlanTriangle> square{{VertexId{0}, VertexId{1}, VertexId{2}},
                                           {VertexId{0}, VertexId{2}, VertexId{3}}};
    const PlanLinks links = link_triangles(square, nullptr);
    ASSERT_EQ(links.neighbor.size(), 2u);
    EXPECT_EQ(links.neighbor[0], (std::array<std::int32_t, 3>{-1, -1, 1}));
    EXPECT_EQ(links.neighbor[1], (std::array<std::int32_t, 3>{0, -1, -1}));
}

TEST(PlanLinks, TheBorderIsWhatIsPassedInOneDirectionMoreOften) {
    const std::vector<PlanTriangle> square{{VertexId{0}, VertexId{1}, VertexId{2}},
                                           {VertexId{0}, VertexId{2}, VertexId{3}}};
    const auto found = nets(link_triangles(square, nullptr));
    ASSERT_EQ(found.size(), 4u);  // not the diagonal
    EXPECT_EQ((found.at({VertexId{0}, VertexId{1}})), 1);
    EXPECT_EQ((found.at({VertexId{1}, VertexId{2}})), 1);
    EXPECT_EQ((found.at({VertexId{2}, VertexId{3}})), 1);
    EXPECT_EQ((found.at({VertexId{0}, VertexId{3}})), -1);
}

TEST(PlanLinks, ATriangleGivenTwiceCountsTwiceAndHasNoNeighbor) {
    const std::vector<PlanTriangle> twice(2, {VertexId{0}, VertexId{1}, VertexId{2}});
    const PlanLinks links = link_triangles(twice, nullptr);
    for (const auto& neighbors : links.neighbor)
        EXPECT_EQ(neighbors, (std::array<std::int32_t, 3>{-1, -1, -1}));
    const auto found = nets(links);
    EXPECT_EQ((found.at({VertexId{0}, VertexId{1}})), 2);
    EXPECT_EQ((found.at({VertexId{0}, VertexId{2}})), -2);
}

TEST(PlanLinks, ThreeTrianglesAtAnEdgeAreNoNeighbors) {
    const std::vector<PlanTriangle> fan{{VertexId{0}, VertexId{1}, VertexId{2}},
                                        {VertexId{1}, VertexId{0}, VertexId{3}},
                                        {VertexId{1}, VertexId{0}, VertexId{4}}};
    const PlanLinks links = link_triangles(fan, nullptr);
    for (const auto& neighbors : links.neighbor)
        EXPECT_EQ(neighbors[0], -1);
    EXPECT_EQ((nets(links).at({VertexId{0}, VertexId{1}})), -1);
}

/// A frame of 4 x 4 about the origin and the vertices of smaller squares.
struct Framed {
    exact::PlanArrangement geometry;
    Frame frame;

    std::vector<VertexId> square(double half) {
        std::vector<VertexId> corners;
        for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
            corners.push_back(geometry.add_vertex(half * x, half * y));
        return corners;
    }
    static void add_border(const std::vector<VertexId>& ring, std::int32_t times,
                           std::vector<BorderEdge>& border) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const VertexId a = ring[i], b = ring[(i + 1) % ring.size()];
            border.push_back({std::min(a, b), std::max(a, b), a < b ? times : -times});
        }
    }
    double area_covered(const FrameTriangles& found, std::int32_t times) const {
        double area = 0;
        for (std::size_t t = 0; t < found.triangles.size(); ++t) {
            if (found.covered[t] != times) continue;
            const auto& [a, b, c] = found.triangles[t];
            const auto &p = geometry.point(a), &q = geometry.point(b), &r = geometry.point(c);
            area += ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / 2;
        }
        return area;
    }
};

TEST(FillFrame, CountsHowOftenEachPartIsCovered) {
    Framed f;
    f.frame = f.square(2);
    const auto outer = f.square(1), inner = f.square(0.5);
    f.geometry.freeze_vertices();
    std::vector<BorderEdge> border;
    Framed::add_border(outer, 1, border);
    Framed::add_border(inner, 1, border);  // covered once more
    const auto found = fill_frame(f.geometry, border, f.frame);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(f.area_covered(*found, 0), 16 - 4);
    EXPECT_DOUBLE_EQ(f.area_covered(*found, 1), 4 - 1);
    EXPECT_DOUBLE_EQ(f.area_covered(*found, 2), 1);
}

TEST(FillFrame, AHoleIsCoveredByNothing) {
    Framed f;
    f.frame = f.square(2);
    const auto outer = f.square(1), inner = f.square(0.5);
    f.geometry.freeze_vertices();
    std::vector<BorderEdge> border;
    Framed::add_border(outer, 1, border);
    Framed::add_border(inner, -1, border);
    const auto found = fill_frame(f.geometry, border, f.frame);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(f.area_covered(*found, 0), 16 - 3);
    EXPECT_DOUBLE_EQ(f.area_covered(*found, 1), 3);
}

TEST(FillFrame, BordersThatCrossHaveNone) {
    Framed f;
    f.frame = f.square(2);
    const auto v = f.square(1);
    f.geometry.freeze_vertices();
    const std::vector<BorderEdge> bow_tie{{v[0], v[2], 1}, {v[1], v[3], 1}};
    EXPECT_FALSE(fill_frame(f.geometry, bow_tie, f.frame));
}

}  // namespace
}  // namespace realmodel::strata
