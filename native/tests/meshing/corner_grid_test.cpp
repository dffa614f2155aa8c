// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/corner_grid.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {
namespace {

/// Evenly spread places, and a cluster a millionth as wide, some of them equal.
std::vector<PlanPoint> places() {
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<PlanPoint> made;
    for (int i = 0; i < 3000; ++i) {
        const double width = i % 2 == 0 ? 1000 : 1e-3;
        made.push_back({300 + width * uniform(), 5e6 + width * uniform()});
    }
    made.insert(made.end(), 100, made[1]);
    return made;
}

std::vector<std::int32_t> all_of(const std::vector<PlanPoint>& points) {
    std::vector<std::int32_t> numbers(points.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

TEST(CornerGrid, FindsWhatLiesInATriangleUntilItIsRemoved) {
    const std::vector<PlanPoint> points = places();
    CornerGrid grid(points, all_of(points));
    std::set<std::int32_t> left;
    for (const std::int32_t n : all_of(points))
        left.insert(n);
    std::mt19937 random(6);
    for (int round = 0; round < 300; ++round) {
        const auto any = [&] { return points[random() % points.size()]; };
        const PlanPoint a = any(), b = any(), c = any();
        if (side_of_line(a, b, c) <= 0) continue;
        std::set<std::int32_t> found, wanted;
        grid.any_in_triangle(a, b, c, [&](std::int32_t n) {
            EXPECT_TRUE(found.insert(n).second) << "twice";
            return false;
        });
        for (const std::int32_t n : left) {
            if (side_of_line(a, b, points[n]) > 0 && side_of_line(b, c, points[n]) > 0 &&
                side_of_line(c, a, points[n]) > 0) {
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
    const std::vector<PlanPoint> points = places();
    const CornerGrid grid(points, all_of(points));
    int asked = 0;
    const PlanPoint a{300, 5e6}, b{300 + 1e-5, 5e6}, c{300, 5e6 + 1e-5};
    grid.any_in_triangle(a, b, c, [&](std::int32_t) { return ++asked < 0; });
    EXPECT_LT(asked, 100);
}

TEST(CornerGrid, StopsAtTheFirstThatIsWanted) {
    const std::vector<PlanPoint> points = places();
    const CornerGrid grid(points, all_of(points));
    int asked = 0;
    EXPECT_TRUE(grid.any_in_triangle({0, 0}, {1e7, 0}, {0, 1e8},
                                     [&](std::int32_t) { return ++asked == 7; }));
    EXPECT_EQ(asked, 7);
    EXPECT_FALSE(
        CornerGrid(points, {}).any_in_triangle({0, 0}, {1e7, 0}, {0, 1e8}, [](std::int32_t) {
            return true;
        }));
}

TEST(CornerGrid, LooksBesideAPlace) {
    const std::vector<PlanPoint> points = places();
    const CornerGrid grid(points, all_of(points));
    for (std::size_t n = 0; n < points.size(); n += 17) {
        bool is_found = false;
        int asked = 0;
        grid.any_beside(points[n], [&](std::int32_t m) {
            is_found |= m == static_cast<std::int32_t>(n);
            return ++asked < 0;
        });
        EXPECT_TRUE(is_found);
        EXPECT_LT(asked, 400);
    }
}

}  // namespace
}  // namespace realmodel::meshing
