// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "strata/conform/conformed_faces.hpp"

namespace realmodel::strata {
namespace {

using exact::PlanArrangement;
using exact::SpaceId;
using exact::VertexId;

/// Triangles over a lattice of 4 x 4 vertices, whose heights come from a source.
template <class Height>
std::vector<PlaneId> random_planes(PlanArrangement& geometry, std::mt19937& random, int count,
                                   const Height& height) {
    std::vector<std::array<SpaceId, 3>> corners;
    while (corners.size() < static_cast<std::size_t>(count)) {
        std::array<std::array<int, 2>, 3> p;
        for (auto& c : p)
            c = {static_cast<int>(random() % 4), static_cast<int>(random() % 4)};
        const int turn =
            (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        if (turn == 0) continue;
        if (turn < 0) std::swap(p[1], p[2]);
        std::array<SpaceId, 3> corner;
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = geometry.add_space_vertex(geometry.add_vertex(p[i][0], p[i][1]), height());
        corners.push_back(corner);
    }
    geometry.freeze_vertices();
    std::vector<PlaneId> planes;
    for (const auto& corner : corners)
        planes.push_back(geometry.add_plane(corner));
    return planes;
}

std::vector<std::int32_t> codes_of(const std::vector<PlaneId>& planes) {
    std::vector<std::int32_t> codes;
    for (const PlaneId plane : planes)
        codes.push_back(code_of(plane, false));
    return codes;
}

/// Compares ranks and heights with what LocalArrangement says of each pair of planes.
void check(const PlanArrangement& geometry, LocalArrangement& scope, PointId point,
           const std::vector<PlaneId>& planes) {
    VertexHeights heights_there(geometry);
    std::vector<std::int32_t> ranks = codes_of(planes);
    heights_there.find(point, ranks);
    const auto& heights = heights_there.heights();
    EXPECT_TRUE(std::is_sorted(heights.begin(), heights.end()));
    EXPECT_EQ(static_cast<std::size_t>(*std::max_element(ranks.begin(), ranks.end())) + 1,
              heights.size());
    for (std::size_t i = 0; i < planes.size(); ++i) {
        EXPECT_EQ(heights[static_cast<std::size_t>(ranks[i])],
                  scope.rounded_height(planes[i], point));
        for (std::size_t j = 0; j < planes.size(); ++j) {
            const int sign = ranks[i] < ranks[j] ? -1 : ranks[i] > ranks[j];
            EXPECT_EQ(sign, scope.compare_heights(planes[i], planes[j], point));
        }
    }
}

/// The same with every other plane tentative: those take up heights that are there.
void check_tentative(const PlanArrangement& geometry, LocalArrangement& scope, PointId point,
                     const std::vector<PlaneId>& planes) {
    VertexHeights heights_there(geometry);
    std::vector<std::int32_t> ranks = codes_of(planes);
    for (std::size_t i = 1; i < ranks.size(); i += 2)
        ranks[i] = code_of(planes[i], true);
    heights_there.find(point, ranks);
    const auto& heights = heights_there.heights();
    EXPECT_TRUE(std::is_sorted(heights.begin(), heights.end()));
    for (std::size_t i = 0; i < planes.size(); ++i) {
        bool is_taken = i % 2 == 0;
        for (std::size_t j = 0; j < planes.size(); j += 2)
            is_taken |= scope.compare_heights(planes[i], planes[j], point) == 0;
        ASSERT_EQ(is_taken, ranks[i] >= 0);
        if (!is_taken) continue;
        EXPECT_EQ(heights[static_cast<std::size_t>(ranks[i])],
                  scope.rounded_height(planes[i], point));
    }
}

class VertexHeightsOf : public testing::TestWithParam<int> {};

// Few planes are looked through, many are sorted; whole heights make ties, others hardly any.
TEST_P(VertexHeightsOf, AgreesWithEachPairOfPlanes) {
    for (const bool whole : {true, false}) {
        std::mt19937 random(7);
        PlanArrangement geometry;
        auto planes = random_planes(geometry, random, GetParam(), [&]() -> double {
            return whole ? static_cast<double>(random() % 3) : std::ldexp(random(), -32);
        });
        planes.insert(planes.end(), planes.begin(), planes.begin() + GetParam() / 2);  // again
        std::shuffle(planes.begin(), planes.end(), random);
        std::vector<LineId> edges;
        for (int i = 0; i < 8; ++i) {
            const auto a = static_cast<VertexId>(random() % 4),
                       b = static_cast<VertexId>(random() % 4);
            if (a != b) edges.push_back(geometry.add_edge(a, b).id());
        }
        LocalArrangement scope(geometry);
        for (VertexId v{0}; index(v) < geometry.vertex_count(); ++v) {
            check(geometry, scope, v, planes);
            check_tentative(geometry, scope, v, planes);
        }
        // crossings belong to the geometry before others may ask for them
        LocalArrangement maker(geometry);
        std::vector<PointId> points;
        for (const PlaneId a : {planes[0], planes[1]}) {
            for (const PlaneId b : {planes[2], planes[3]}) {
                if (a == b) continue;
                const auto& p = geometry.plane_filter(a);
                const auto& q = geometry.plane_filter(b);
                for (const LineId edge : edges) {
                    const auto& f = geometry.filter(edge);
                    // clearly not parallel
                    const double turn = f.a * (p.gy - q.gy) - f.b * (p.gx - q.gx);
                    if (std::abs(turn) < 1e-9) continue;
                    points.push_back(maker.crossing(edge, maker.trace(a, b).id()));
                }
            }
        }
        maker.commit(geometry);
        ASSERT_FALSE(points.empty());
        for (const PointId point : points) {
            check(geometry, scope, maker.shared_point(point), planes);
            check_tentative(geometry, scope, maker.shared_point(point), planes);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Numbers, VertexHeightsOf, testing::Values(4, 12, 60));

// Where rounding could make a difference a tentative plane counts like the others, and then what is
// near to it does, too.
TEST(VertexHeights, WhatIsNearCounts) {
    PlanArrangement geometry;
    const auto level = [&](double z) {
        std::array<SpaceId, 3> corner;
        const std::array<std::array<double, 2>, 3> plan{{{0, 0}, {1, 0}, {0, 1}}};
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = geometry.add_space_vertex(geometry.add_vertex(plan[i][0], plan[i][1]), z);
        return corner;
    };
    const std::vector<std::array<SpaceId, 3>> corners{level(0), level(0x1p-30), level(0x1.8p-29),
                                                      level(0x1p-20)};
    geometry.freeze_vertices();
    std::vector<std::int32_t> ranks;
    for (const auto& corner : corners)
        ranks.push_back(code_of(geometry.add_plane(corner), !ranks.empty()));
    ASSERT_LT(0x1p-30, geometry.clear_height(0));
    ASSERT_GT(0x1.8p-29, geometry.clear_height(1));
    VertexHeights heights_there(geometry);
    heights_there.find(PointId(0), ranks);
    EXPECT_EQ(ranks, (std::vector<std::int32_t>{0, 1, 2, -1}));
    EXPECT_EQ(heights_there.heights(), (std::vector<double>{0, 0x1p-30, 0x1.8p-29}));
}

// Heights that round to that of a flat base leave it where it is.
TEST(VertexHeights, LevelPlanesKeepTheirHeight) {
    PlanArrangement geometry;
    const VertexId o = geometry.add_vertex(0, 0), x = geometry.add_vertex(3, 0),
                   y = geometry.add_vertex(0, 3), at = geometry.add_vertex(1, 1);
    const double up = std::nextafter(1.0, 2), down = std::nextafter(1.0, 0);
    const auto corners = [&](double z) {
        return std::array{geometry.add_space_vertex(o, 1), geometry.add_space_vertex(x, z),
                          geometry.add_space_vertex(y, 1)};
    };
    const auto level = corners(1), rising = corners(up), falling = corners(down);
    geometry.freeze_vertices();
    std::vector<std::int32_t> planes = codes_of(
        {geometry.add_plane(level), geometry.add_plane(rising), geometry.add_plane(falling)});
    VertexHeights heights_there(geometry);
    heights_there.find(at, planes);
    EXPECT_EQ(planes, (std::vector<std::int32_t>{1, 2, 0}));
    EXPECT_EQ(heights_there.heights(), (std::vector<double>{down, 1, up}));
}

}  // namespace
}  // namespace realmodel::strata
