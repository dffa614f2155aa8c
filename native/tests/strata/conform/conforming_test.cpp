// SPDX-License-Identifier: GPL-3.0-or-later
// The stages of conforming, one after another, on faces that can be counted by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "small_faces.hpp"
#include "strata/conform/conformed_faces.hpp"
#include "strata/conform/plan_vertices.hpp"
#include "strata/conform/walls.hpp"

namespace realmodel::strata {
namespace {

/// All stages up to the curves.
struct Conformed {
    explicit Conformed(SmallFaces& small, const std::vector<ExtraPoint>& extra = {},
                       const Array<std::uint8_t>* cell_is_thick = nullptr)
        : vertices(find_plan_vertices(small.geometry, small.faces, extra, {1, nullptr})),
          lines(find_collinear_edges(small.geometry, small.faces, vertices, extra, cell_is_thick,
                                     {1, nullptr})) {
        set_plan_positions(small.geometry, vertices, {1, nullptr});
    }

    /// Which of the lines this is.
    std::size_t number_of(LineId representative) const {
        const auto& all = lines.representative;
        return static_cast<std::size_t>(std::find(all.begin(), all.end(), representative) -
                                        all.begin());
    }

    PlanVertices vertices;
    CollinearEdges lines;
};

TEST(PlanVertices, AreInOrderOfXThenY) {
    SmallFaces small({0});
    small.add_t_junction();
    const PlanVertices found = Conformed(small).vertices;
    ASSERT_EQ(found.size(), 5u);
    const std::array<PlanVertexId, 5> expected{1, 2, 3, 0, 4};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(found.of_point[i], expected[i]);
        const auto v = static_cast<std::size_t>(expected[i]);
        EXPECT_EQ(found.position[v], SmallFaces::kPosition[i]);
        EXPECT_EQ(found.representative[v], small.vertex[i]);
        EXPECT_EQ(found.has_same_x_next(expected[i]), i == 0 || i == 1);
    }
    EXPECT_TRUE(found.coincident.empty());
}

TEST(PlanVertices, WhatNoFaceUsesIsNone) {
    SmallFaces small({0});
    small.add(0, {3, 0, 2}, 0, kOutsideCell);
    const PlanVertices found = Conformed(small).vertices;
    EXPECT_EQ(found.size(), 3u);
    EXPECT_EQ(found.of_point[1], -1);
    EXPECT_EQ(found.of_point[4], -1);
}

TEST(PlanVertices, ManyPositionsMayRoundToOne) {
    // lines that cross one another within a thousandth of a corner, where doubles are whole numbers
    constexpr double kCorner = 0x1p52;
    constexpr int kLines = 6;
    exact::PlanArrangement geometry;
    std::vector<std::array<exact::VertexId, 2>> ends;
    for (const bool steep : {false, true}) {
        for (int i = 1; i <= kLines; ++i) {
            const auto vertex = [&](double along, double across) {
                return steep ? geometry.add_vertex(kCorner + across, kCorner + along)
                             : geometry.add_vertex(kCorner + along, kCorner + across);
            };
            ends.push_back({vertex(-1000, -i), vertex(3001, 3 * i)});
        }
    }
    geometry.freeze_vertices();
    std::vector<LineId> lines;
    for (const auto& [from, to] : ends)
        lines.push_back(geometry.add_edge(from, to).id());
    std::vector<ExtraPoint> extra;
    for (int name = 0; name < 2; ++name) {
        LocalArrangement local(geometry);
        std::vector<PointId> crossings;
        for (std::size_t i = 0; i < kLines; ++i) {
            for (std::size_t j = kLines; j < 2 * kLines; ++j) {
                crossings.push_back(local.crossing(lines[i], lines[j]));
                local.mark_point_used(crossings.back());
            }
        }
        local.commit(geometry);
        for (const PointId at : crossings)
            extra.push_back({lines[0], local.shared_point(at)});
    }
    const PlanVertices found = find_plan_vertices(geometry, {}, extra, {1, nullptr});
    constexpr std::size_t kCrossings = kLines * kLines;
    ASSERT_EQ(found.size(), kCrossings);
    EXPECT_EQ(found.coincident.size(), kCrossings - 1);
    for (std::size_t c = 0; c < kCrossings; ++c) {
        const PlanVertexId vertex = found.of_point[index(extra[c].point)];
        EXPECT_EQ(found.of_point[index(extra[kCrossings + c].point)], vertex);
        EXPECT_EQ(found.representative[index(vertex)], extra[c].point);
    }
}

TEST(PlanVertices, OnePositionIsOneVertexHoweverOftenItWasFound) {
    SmallFaces small({0});
    small.add_t_junction();
    // two chunks find where the same two lines cross
    const LineId across = small.line(3, 2), other = small.line(0, 4);
    std::vector<ExtraPoint> extra;
    for (int i = 0; i < 2; ++i) {
        LocalArrangement local(small.geometry);
        const PointId at = local.crossing(across, other);
        local.mark_point_used(at);
        local.commit(small.geometry);
        extra.push_back({other, local.shared_point(at)});
    }
    ASSERT_NE(extra[0].point, extra[1].point);
    const PlanVertices found = Conformed(small, extra).vertices;
    EXPECT_EQ(found.size(), small.geometry.point_count() - 1);
    const auto vertex = found.of_point[index(extra[0].point)];
    EXPECT_EQ(found.of_point[index(extra[1].point)], vertex);
    EXPECT_EQ(found.representative[static_cast<std::size_t>(vertex)], extra[0].point);
    EXPECT_TRUE(found.coincident.empty());
}

TEST(CollinearLines, LinesThroughTheSamePointsAreOne) {
    SmallFaces small({0});
    small.add_t_junction();
    const CollinearLines found = join_lines(small.geometry, small.faces, {1, nullptr});
    const auto of = [&](std::size_t from, std::size_t to) {
        return found.of_line[index(small.line(from, to))];
    };
    EXPECT_EQ(of(0, 1), of(0, 2));
    EXPECT_EQ(of(1, 2), of(0, 2));
    EXPECT_EQ(of(1, 4), of(4, 1));
    EXPECT_NE(of(0, 4), of(0, 2));
    EXPECT_EQ(found.representative.size(), 6u);  // x = 0, two sides of 3, three sides of 4
    const LineId lowest = std::min({small.line(0, 1), small.line(1, 2), small.line(0, 2)});
    EXPECT_EQ(found.representative[static_cast<std::size_t>(of(0, 2))], lowest);
}

TEST(CollinearEdges, ALongEdgePassesWhatLiesBetweenItsEnds) {
    SmallFaces small({0});
    small.add_t_junction();
    const Conformed conformed(small);
    const CollinearEdges& lines = conformed.lines;
    const std::size_t line = conformed.number_of(small.line(0, 2));
    ASSERT_LT(line, lines.size());
    std::vector<std::array<std::int32_t, 3>> edges;
    for (auto e = lines.edge_offsets[line]; e < lines.edge_offsets[line + 1]; ++e)
        edges.push_back({lines.edges[e].face, lines.edges[e].from, lines.edges[e].to});
    std::sort(edges.begin(), edges.end());
    // counted to rising y; faces left of the line run that way
    EXPECT_EQ(edges, (std::vector<std::array<std::int32_t, 3>>{{0, 0, 2}, {1, 1, 0}, {2, 2, 1}}));
    std::size_t passing = 0;
    for (const PassedVertices& some : lines.passed) {
        for (const PassedVertices::PassingEdge& edge : some.edges) {
            ++passing;
            EXPECT_EQ(edge.corner, 1u);  // the second corner of the first face
            EXPECT_EQ(edge.count, 1u);
            EXPECT_EQ(edge.is_tentative, 0u);
            EXPECT_EQ(some.vertices, (std::vector<std::int32_t>{2}));
        }
    }
    EXPECT_EQ(passing, 1u);
}

TEST(ConformedFaces, HaveTheTVerticesOfTheirNeighbors) {
    SmallFaces small({0});
    small.add_t_junction();
    Conformed conformed(small);
    const ConformedFaces found = conform_faces(small.geometry, small.faces, conformed.vertices,
                                               conformed.lines, {1, nullptr});
    const auto face = [&](std::size_t f) {
        return std::vector<std::int32_t>(found.vertices.begin() + found.face_offsets[f],
                                         found.vertices.begin() + found.face_offsets[f + 1]);
    };
    EXPECT_EQ(face(0), (std::vector<std::int32_t>{0, 1, 2, 3}));
    EXPECT_EQ(face(1), (std::vector<std::int32_t>{1, 4, 2}));
    EXPECT_EQ(face(2), (std::vector<std::int32_t>{2, 4, 3}));
    EXPECT_TRUE(found.inserted.empty());
}

TEST(ConformedFaces, HaveOneVertexForEachHeight) {
    SmallFaces small({1, 5});
    small.add(0, {3, 0, 2}, 0, kOutsideCell);
    small.add(1, {0, 4, 2}, kOutsideCell, 0);
    Conformed conformed(small);
    ConformedFaces found = conform_faces(small.geometry, small.faces, conformed.vertices,
                                         conformed.lines, {1, nullptr});
    set_vertex_positions(conformed.vertices, found, {1, nullptr});
    ASSERT_EQ(found.positions.size(), 6u);  // two over each end of the line
    const std::vector<double> z{1, 1, 5, 1, 5, 5};
    for (std::size_t v = 0; v < z.size(); ++v)
        EXPECT_EQ(found.positions[v][2], z[v]) << v;
    EXPECT_EQ(found.vertices[found.face_offsets[1]], 2);
}

TEST(IntervalCurves, AreTheEdgesOverEachInterval) {
    SmallFaces small({0});
    small.add_t_junction();
    Conformed conformed(small);
    const ConformedFaces found = conform_faces(small.geometry, small.faces, conformed.vertices,
                                               conformed.lines, {1, nullptr});
    IntervalCurves curves(small.faces, conformed.lines, found);
    curves.collect(conformed.number_of(small.line(0, 2)));
    ASSERT_EQ(curves.intervals(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto pair = curves.of_interval(i);
        ASSERT_EQ(pair.size(), 2u);
        EXPECT_TRUE(pair[0].as_high_as(pair[1]));
        EXPECT_NE(pair[0].left, pair[1].left);
        EXPECT_EQ(pair[0].start, static_cast<std::int32_t>(i) + 1);
        EXPECT_EQ(pair[0].end, static_cast<std::int32_t>(i) + 2);
        for (const IntervalCurve& curve : pair) {
            EXPECT_EQ(curve.above, curve.left ? 0 : 1);
            EXPECT_EQ(curve.left, curve.face == 0);
        }
        EXPECT_EQ(below_all(pair, true), kOutsideCell);
    }
}

using Gap = std::array<std::int32_t, 4>;  // the vertices at the start, the cells left and right

std::vector<Gap> gaps_of(const std::vector<IntervalCurve>& curves) {
    std::vector<Gap> gaps;
    for_each_gap(curves, true,
                 [&](const IntervalCurve& low, const IntervalCurve& high, std::int32_t left,
                     std::int32_t right) {
                     gaps.push_back({low.start, high.start, left, right});
                 });
    return gaps;
}

TEST(IntervalCurves, GapsLieBetweenTheCellsOfTheTwoSides) {
    // on the left two columns, on the right one that is as high
    const std::vector<IntervalCurve> curves{{0, 0, 0, 7, -1, false},
                                            {0, 0, 1, 5, -1, true},
                                            {1, 1, 2, 6, 5, true},
                                            {2, 2, 3, -1, 7, false},
                                            {2, 2, 4, -1, 6, true}};
    EXPECT_EQ(gaps_of(curves), (std::vector<Gap>{{0, 1, 5, 7}, {1, 2, 6, 7}}));
}

TEST(IntervalCurves, AFaceThatGoesOnAcrossTheLineEndsCellsOnBothSides) {
    // from 0 to 1 a column on the left; then one on both sides, whose bottom goes on across the
    // line
    const std::vector<IntervalCurve> curves{
        {0, 0, 0, 5, -1, true},
        {1, 1, 1, -1, 5, true},
        {2, 2, 2, -1, 6, false},
        {2, 2, 3, -1, 6, true},
        // and where the next one ends on the left alone, outside is beside it
        {3, 3, 4, 8, -1, true},
        {4, 4, 5, -1, 8, true}};
    EXPECT_EQ(gaps_of(curves),
              (std::vector<Gap>{{0, 1, 5, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 4, 8, -1}}));
    // a column on both sides whose top goes on across the line, and a later one on the left
    const std::vector<IntervalCurve> later{{0, 0, 0, 5, -1, false},
                                           {0, 0, 1, 5, -1, true},
                                           {2, 2, 2, 8, -1, true},
                                           {3, 3, 3, -1, 8, true}};
    EXPECT_EQ(gaps_of(later), (std::vector<Gap>{{0, 2, 5, 5}, {2, 3, 8, -1}}));
}

TEST(MatchedEdges, WallsFollowFromTheCellsAlone) {
    SmallFaces small({0, 1});
    small.add_two_columns();
    Array<std::uint8_t> is_thick(2, 1);
    const Conformed conformed(small, {}, &is_thick);
    std::size_t walls = 0;
    for (const MatchedEdges& matched : conformed.lines.matched) {
        EXPECT_TRUE(matched.passing.empty());
        for (const MatchedEdges::Wall& wall : matched.walls) {
            ++walls;
            EXPECT_EQ(wall.cells, (std::array<std::int32_t, 2>{0, 1}));
            EXPECT_EQ(wall.above, 1u);
            EXPECT_EQ(wall.beneath, 1u);
            // of the faces left of the line, on either level
            const std::vector<std::uint32_t> corners(matched.corners.begin(),
                                                     matched.corners.end());
            EXPECT_EQ(corners, (std::vector<std::uint32_t>{1, 2, 7, 8}));
        }
    }
    EXPECT_EQ(walls, 1u);
    EXPECT_EQ(conformed.number_of(small.line(0, 2)), conformed.lines.size());  // left out
    for (const PassedVertices& some : conformed.lines.passed)
        EXPECT_TRUE(some.edges.empty());
}

TEST(Walls, StandBetweenTwoColumnsWhetherTheirEdgesMatchOrNot) {
    for (const bool matched : {true, false}) {
        SmallFaces small({0, 1});
        small.add_two_columns();
        const Array<std::uint8_t> is_thick(2, 1);
        Conformed conformed(small, {}, matched ? &is_thick : nullptr);
        const ConformedFaces faces = conform_faces(small.geometry, small.faces, conformed.vertices,
                                                   conformed.lines, {1, nullptr});
        const WallLists found =
            find_walls(small.geometry, small.faces, conformed.lines, faces, nullptr, {1, nullptr});
        EXPECT_TRUE(found.missing.empty());
        std::vector<std::array<std::int32_t, 2>> inner;
        std::size_t outer = 0;
        for (const WallBatch& batch : found.walls) {
            for (std::size_t w = 0, first = 0; w < batch.sizes.size(); ++w) {
                const auto end = first + static_cast<std::size_t>(batch.sizes[w]);
                EXPECT_EQ(batch.sizes[w], 4);
                if (batch.cells[w][0] == kOutsideCell || batch.cells[w][1] == kOutsideCell) {
                    ++outer;
                } else {
                    inner.push_back(batch.cells[w]);
                    // vertices 2 and 3 over the first end of the line, 4 and 5 over the second
                    const std::vector<std::int32_t> loop(
                        batch.vertices.begin() + static_cast<std::ptrdiff_t>(first),
                        batch.vertices.begin() + static_cast<std::ptrdiff_t>(end));
                    EXPECT_EQ(loop, (std::vector<std::int32_t>{2, 4, 5, 3}));
                }
                first = end;
            }
        }
        EXPECT_EQ(inner, (std::vector<std::array<std::int32_t, 2>>{{0, 1}}));
        EXPECT_EQ(outer, 4u);  // two sides of each column
    }
}

TEST(MatchedEdges, EdgesThatDoNotMatchStay) {
    SmallFaces small({0});
    small.add_t_junction();
    Array<std::uint8_t> is_thick(2, 1);
    const Conformed conformed(small, {}, &is_thick);
    EXPECT_LT(conformed.number_of(small.line(0, 2)), conformed.lines.size());
}

}  // namespace
}  // namespace realmodel::strata
