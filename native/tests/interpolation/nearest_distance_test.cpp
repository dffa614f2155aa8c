// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/distances.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {
namespace {

TEST(NearestDistances, AsByLookingAtAll) {
    const std::array origin{431250.37, 5398781.81};
    const Points points = hills(200, 100, origin);
    const Nodes nodes = scattered_nodes(3000, 140, origin);
    const std::vector<double> one = nearest_distances(points, nodes, {1});
    EXPECT_EQ(one, nearest_distances(points, nodes, {3}));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        double least = HUGE_VAL;
        for (const auto& p : points)
            least = std::min(least, std::hypot(p[0] - nodes[i][0], p[1] - nodes[i][1]));
        ASSERT_NEAR(one[i], least, 1e-8);
    }
    EXPECT_EQ(nearest_distances(points, Nodes{{points[7][0], points[7][1]}})[0], 0);
}

TEST(NearestDistances, Refuses) {
    const Nodes nodes{{1, 2}};
    EXPECT_THROW(nearest_distances({}, nodes), InputError);
    EXPECT_THROW(nearest_distances(Points{{0, 0, 0}, {std::nan(""), 0, 0}}, nodes), InputError);
    EXPECT_THROW(nearest_distances(Points{{0, 0, 0}}, Nodes{{std::nan(""), 0}}), InputError);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(nearest_distances(Points{{0, 0, 0}}, nodes, {0, &progress}), Cancelled);
}

TEST(NearestPoints, WithinADistanceAllOrNone) {
    const Nodes positions = scattered_nodes(500, 100);
    const spatial::NearestPoints tree(positions);
    std::vector<spatial::Neighbor> found;
    ASSERT_TRUE(tree.within({50, 50}, 20, 500, found));
    std::vector<bool> seen(positions.size(), false);
    for (const spatial::Neighbor& n : found) {
        ASSERT_FALSE(seen[static_cast<std::size_t>(n.point)]);
        seen[static_cast<std::size_t>(n.point)] = true;
    }
    for (std::size_t i = 0; i < positions.size(); ++i)
        EXPECT_EQ(seen[i], std::hypot(positions[i][0] - 50, positions[i][1] - 50) <= 20);
    EXPECT_FALSE(tree.within({50, 50}, 20, found.size() - 1, found));
}

}  // namespace
}  // namespace realmodel::interpolation
