// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/neighbors/neighbor_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../dense_kriging.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

struct Searched {
    std::vector<std::int32_t> points;
    bool within;
};

Searched search(const DataPoints& data, const PlanPosition& position,
                const Neighborhood& neighborhood, std::int32_t left_out = NeighborSearch::kNobody) {
    const spatial::NearestPoints tree(data.local);
    NeighborSearch finder(data, tree, neighborhood);
    std::vector<spatial::Neighbor> found;
    const bool within = finder.find(position, found, left_out);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    Searched out{{}, within};
    for (const auto& neighbor : found)
        out.points.push_back(neighbor.point);
    return out;
}

/// The same, by looking at every point.
std::vector<std::int32_t> expected(const DataPoints& data, const PlanPosition& position,
                                   const Neighborhood& n, std::int32_t left_out) {
    std::vector<spatial::Neighbor> all;
    for (std::size_t i = 0; i < data.local.size(); ++i) {
        const double dx = data.local[i][0] - position[0], dy = data.local[i][1] - position[1];
        all.push_back({dx * dx + dy * dy, static_cast<std::int32_t>(i)});
    }
    std::sort(all.begin(), all.end());
    std::vector<std::int32_t> out;
    std::array<int, 8> taken{};
    for (const auto& [squared, point] : all) {
        if (point == left_out || (n.radius > 0 && squared > n.radius * n.radius)) continue;
        const PlanPosition& p = data.local[static_cast<std::size_t>(point)];
        const double angle = std::atan2(p[1] - position[1], p[0] - position[0]) + std::numbers::pi;
        auto& count = taken[std::min(7U, static_cast<unsigned>(angle / std::numbers::pi * 4))];
        if (n.octants > 0 && count == n.octants) continue;
        ++count;
        out.push_back(point);
        if (n.neighbors > 0 && out.size() == static_cast<std::size_t>(n.neighbors)) break;
    }
    return out;
}

TEST(NeighborSearch, AsLookingAtEveryPoint) {
    const DataPoints data = prepare_points(hills(400, 100, {4e5, 5e6}));
    for (const Neighborhood& n : {Neighborhood{16, 0, 0},
                                  {16, 2, 0},
                                  {12, 0, 9},
                                  {0, 0, 15},
                                  {20, 1, 20},
                                  {0, 1, 0},
                                  {500, 0, 0},
                                  {3, 3, 3}}) {
        for (int i = 0; i < 30; ++i) {
            const PlanPosition position = data.local[static_cast<std::size_t>(13 * i)];
            for (const std::int32_t left_out : {NeighborSearch::kNobody, 13 * i}) {
                const auto want = expected(data, position, n, left_out);
                const Searched got = search(data, position, n, left_out);
                if (want.empty()) {
                    EXPECT_FALSE(got.within);
                    EXPECT_EQ(got.points.size(), 1U);
                } else {
                    EXPECT_EQ(got.points, want);
                }
            }
        }
    }
}

TEST(NeighborSearch, OctantsAlongMeasuredLinesAndFarOutside) {
    Points points;
    for (int i = 0; i < 600; ++i)  // six lines, points close together along them; ties
        points.push_back({4e5 + 200.0 * (i % 6), 5e6 + 2.0 * (i / 6), 0});
    const DataPoints data = prepare_points(points);
    for (const PlanPosition& position : {PlanPosition{4e5 + 301.37, 5e6 + 77.91},
                                         {4e5 + 200.13, 5e6 + 90.77},
                                         {4e5 - 700.29, 5e6 + 3.11},
                                         {4e5 + 5000.7, 5e6 - 9000.3},
                                         {4e5 + 1e7, 5e6 + 0.1}}) {
        for (const Neighborhood& n : {Neighborhood{16, 2, 0}, {8, 1, 0}, {32, 4, 500}, {0, 3, 0}}) {
            const PlanPosition local = data.to_local(position);
            const auto want = expected(data, local, n, NeighborSearch::kNobody);
            const Searched got = search(data, local, n);
            if (want.empty()) {
                EXPECT_FALSE(got.within);
            } else {
                EXPECT_EQ(got.points, want)
                    << position[0] << " " << position[1] << " " << n.octants;
            }
        }
    }
}

TEST(NeighborSearch, OctantsOfPointsInOneLineOrAtOnePlace) {
    Points line;
    for (int i = 0; i < 300; ++i)
        line.push_back({0, 3.0 * i, 0});
    for (const Points& points : {line, Points{{7, 7, 1}}}) {
        const DataPoints data = prepare_points(points);
        for (const PlanPosition& position :
             {PlanPosition{1.3, 100.7}, {-50.1, 900.4}, {3.2, -4.9}}) {
            const PlanPosition local = data.to_local(position);
            EXPECT_EQ(search(data, local, {8, 1, 0}).points,
                      expected(data, local, {8, 1, 0}, NeighborSearch::kNobody));
        }
    }
}

TEST(NeighborSearch, NoPointWithinTheRadiusGivesTheNearest) {
    const DataPoints data = prepare_points(Points{{0, 0, 1}, {10, 0, 2}});
    const Searched far = search(data, {6, 0}, {16, 0, 3});
    EXPECT_FALSE(far.within);
    EXPECT_EQ(far.points, (std::vector<std::int32_t>{1}));
    EXPECT_TRUE(search(data, {6, 0}, {16, 0, 4}).within);
    const Searched nothing = search(prepare_points(Points{{0, 0, 1}}), {0, 0}, {16, 0, 0}, 0);
    EXPECT_TRUE(nothing.points.empty());
}

TEST(NeighborSearch, OctantsLookBeyondACluster) {
    Points points;
    for (int i = 0; i < 100; ++i)
        points.push_back({1 + 0.001 * i, 0.5, 0});
    points.push_back({-50, 1, 0});
    const DataPoints data = prepare_points(points);
    const PlanPosition middle = data.to_local({0, 0});
    EXPECT_EQ(search(data, middle, {16, 0, 0}).points.back(), 15);
    EXPECT_EQ(search(data, middle, {16, 4, 0}).points,
              (std::vector<std::int32_t>{0, 1, 2, 3, 100}));
}

TEST(NeighborSearch, Refuses) {
    for (const Neighborhood& n :
         {Neighborhood{-1, 0, 0}, {1, -1, 0}, {1, 0, -1}, {1, 0, HUGE_VAL}, {1, 0, std::nan("")}}) {
        EXPECT_THROW(check_neighborhood(n), InputError);
    }
}

}  // namespace
}  // namespace realmodel::interpolation
