// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/nearest_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace realmodel::spatial {
namespace {

using Points = std::vector<std::array<double, 2>>;

std::vector<Neighbor> by_sorting(const Points& points, const std::array<double, 2>& place,
                                 std::size_t count) {
    std::vector<Neighbor> all;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double dx = place[0] - points[i][0], dy = place[1] - points[i][1];
        all.push_back({dx * dx + dy * dy, static_cast<std::int32_t>(i)});
    }
    std::sort(all.begin(), all.end());
    all.resize(std::min(count, all.size()));
    return all;
}

std::vector<Neighbor> found(const Points& points, const std::array<double, 2>& place,
                            std::size_t count) {
    std::vector<Neighbor> neighbors;
    NearestPoints(points).find(place, count, neighbors);
    return neighbors;
}

TEST(NearestPoints, NearestFirst) {
    const Points points{{0, 0}, {3, 0}, {1, 0}, {0, 2}};
    EXPECT_EQ(found(points, {0, 0}, 3), (std::vector<Neighbor>{{0, 0}, {1, 2}, {4, 3}}));
}

TEST(NearestPoints, FewerThanAskedFor) {
    EXPECT_EQ(found({{1, 1}}, {0, 0}, 5), (std::vector<Neighbor>{{2, 0}}));
    EXPECT_TRUE(found({{1, 1}}, {0, 0}, 0).empty());
    EXPECT_TRUE(found({}, {0, 0}, 5).empty());
}

TEST(NearestPoints, TiesGoByNumber) {
    // On a shuffled lattice nearly every distance is a tie, and most limits cut through one.
    Points points;
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 30; ++x)
            points.push_back({4.5e5 + 25 * x, 5.2e6 + 25 * y});
    }
    std::mt19937 random(3);
    std::shuffle(points.begin(), points.end(), random);
    const NearestPoints tree(points);
    std::vector<Neighbor> neighbors;
    for (int i = 0; i < 500; ++i) {
        const double half = static_cast<double>(i % 3) * 0.5;
        const std::array<double, 2> place{4.5e5 + 25 * (static_cast<double>(random() % 30) + half),
                                          5.2e6 + 25 * static_cast<double>(random() % 30)};
        for (const std::size_t count : {1U, 2U, 3U, 7U, 16U, 33U}) {
            tree.find(place, count, neighbors);
            ASSERT_EQ(neighbors, by_sorting(points, place, count));
        }
    }
}

TEST(NearestPoints, ScatteredAsBySorting) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Points points;
    for (int i = 0; i < 2000; ++i)
        points.push_back({uniform(random), 1e-3 * uniform(random)});
    const NearestPoints tree(points);
    std::vector<Neighbor> neighbors;
    for (int i = 0; i < 200; ++i) {
        const std::array<double, 2> place{2 * uniform(random), uniform(random)};
        tree.find(place, 16, neighbors);
        ASSERT_EQ(neighbors, by_sorting(points, place, 16));
    }
}

}  // namespace
}  // namespace realmodel::spatial
