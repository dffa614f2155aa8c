// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/corner_grid.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "exact/orientation.hpp"

namespace realmodel::spatial {
namespace {

/// Evenly spread places, and a cluster a millionth as wide, some of them equal.
std::vector<PlanPosition> places() {
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<PlanPosition> made;
    for (int i = 0; i < 3000; ++i) {
        const double width = i % 2 == 0 ? 1000 : 1e-3;
        made.push_back({300 + width * uniform(), 5e6 + width * uniform()});
    }
    made.insert(made.end(), 100, made[1]);
    return made;
}

std::vector<CornerGrid::Member> numbered(const std::vector<PlanPosition>& points) {
    std::vector<CornerGrid::Member> members;
    for (const PlanPosition& p : points)
        members.push_back({p, static_cast<std::int32_t>(members.size())});
    return members;
}

CornerGrid grid_of(const std::vector<PlanPosition>& points) {
    return {numbered(points), points.size()};
}

TEST(CornerGrid, FindsWhatLiesInATriangleUntilItIsRemoved) {
    const std::vector<PlanPosition> points = places();
    CornerGrid grid = grid_of(points);
    std::set<std::int32_t> left;
    for (const CornerGrid::Member& member : numbered(points))
        left.insert(member.number);
    std::mt19937 random(6);
    for (int round = 0; round < 300; ++round) {
        // Of all sizes, also of the cluster alone (odd numbers): a search begins where the last
        // one was, which may be far too small for it, or elsewhere.
        const std::size_t among = round % 3 == 0 ? 1 : 0;
        const auto any = [&] { return points[(random() % (points.size() / 2)) * 2 + among]; };
        const PlanPosition a = any(), b = round % 7 == 0 ? points[random() % points.size()] : any(),
                           c = any();
        if (exact::orient2d(a, b, c) <= 0) continue;
        std::set<std::int32_t> found, wanted;
        grid.any_in_triangle(a, b, c, [&](const CornerGrid::Member& member) {
            EXPECT_TRUE(found.insert(member.number).second) << "twice";
            EXPECT_EQ(member.position, points[member.number]);
            return false;
        });
        for (const std::int32_t n : left) {
            if (exact::orient2d(a, b, points[n]) > 0 && exact::orient2d(b, c, points[n]) > 0 &&
                exact::orient2d(c, a, points[n]) > 0) {
                wanted.insert(n);
            }
        }
        EXPECT_TRUE(std::includes(found.begin(), found.end(), wanted.begin(), wanted.end()));
        EXPECT_TRUE(std::includes(left.begin(), left.end(), found.begin(), found.end()));
        for (int i = 0; i < 10; ++i) {
            const auto gone = static_cast<std::int32_t>(random() % points.size());
            grid.remove(gone);  // at times a second time, which does nothing
            left.erase(gone);
        }
    }
    EXPECT_LT(left.size(), 2 * points.size() / 3);
}

TEST(CornerGrid, ClustersAreNotSearchedAsAWhole) {
    const std::vector<PlanPosition> points = places();
    CornerGrid grid = grid_of(points);
    int asked = 0;
    const PlanPosition a{300, 5e6}, b{300 + 1e-5, 5e6}, c{300, 5e6 + 1e-5};
    grid.any_in_triangle(a, b, c, [&](const CornerGrid::Member&) { return ++asked < 0; });
    EXPECT_LT(asked, 100);
}

TEST(CornerGrid, StopsAtTheFirstThatIsWanted) {
    const std::vector<PlanPosition> points = places();
    CornerGrid grid = grid_of(points);
    int asked = 0;
    EXPECT_TRUE(grid.any_in_triangle({0, 0}, {1e7, 0}, {0, 1e8},
                                     [&](const CornerGrid::Member&) { return ++asked == 7; }));
    EXPECT_EQ(asked, 7);
    EXPECT_FALSE(grid_of({}).any_in_triangle({0, 0}, {1e7, 0}, {0, 1e8},
                                             [](const CornerGrid::Member&) { return true; }));
}

}  // namespace
}  // namespace realmodel::spatial
