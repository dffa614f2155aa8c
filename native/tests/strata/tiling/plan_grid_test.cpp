// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/plan_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {
namespace {

/// Triangles over a plan, and the grid of them.
struct Triangles {
    exact::PlanArrangement geometry;
    std::vector<PlanTriangle> triangles;
    PolygonPool polygons;

    void add(const std::array<std::array<double, 2>, 3>& at) {
        triangles.push_back({geometry.add_vertex(at[0][0], at[0][1]),
                             geometry.add_vertex(at[1][0], at[1][1]),
                             geometry.add_vertex(at[2][0], at[2][1])});
    }
    void finish() {
        geometry.freeze_vertices();
        for (const PlanTriangle& t : triangles)
            polygons.add(triangle_outline(geometry, t));
    }
    std::vector<std::int32_t> candidates(const PlanGrid& grid, std::size_t polygon) const {
        const LocalArrangement local(geometry);
        Array<std::int32_t> found;
        grid.candidates(local, polygons[polygon], found);
        return {found.begin(), found.end()};
    }
};

TEST(PlanGrid, FindsAllPolygonsThatShareAnAreaOnceAndInOrder) {
    // small ones, needles across everything and one around all
    Triangles t;
    std::mt19937 random(1);
    const auto at = [&] { return static_cast<double>(random() % 1000) / 1000; };
    for (int i = 0; i < 300; ++i) {
        const double x = at(), y = at(), size = i % 10 == 0 ? 0.5 : 0.02;
        t.add({{{x, y}, {x + size, y}, {x, y + (i % 7 == 0 ? 1e-6 : size)}}});
    }
    t.add({{{-5, -5}, {5, -5}, {0, 5}}});
    t.finish();
    std::vector<std::uint8_t> is_inner(t.polygons.size(), 1);
    is_inner.back() = 0;
    const PlanGrid grid(t.geometry, t.polygons, is_inner, 100, {1, nullptr});
    LocalArrangement local(t.geometry);
    Clipper clipper(local);
    for (std::size_t i = 0; i < t.polygons.size(); ++i) {
        const auto found = t.candidates(grid, i);
        clipper.begin(t.polygons[i]);
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
        EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
        for (std::size_t j = 0; j < t.polygons.size(); ++j) {
            if (!clipper.overlaps(t.polygons[j])) continue;
            EXPECT_TRUE(
                std::binary_search(found.begin(), found.end(), static_cast<std::int32_t>(j)))
                << i << " shares an area with " << j;
        }
    }
}

TEST(PlanGrid, OffersNothingWhoseBoxLiesApart) {
    Triangles t;
    t.add({{{0, 0}, {1, 0}, {0, 1}}});
    t.add({{{2, 2}, {3, 2}, {2, 3}}});
    t.finish();
    const PlanGrid grid(t.geometry, t.polygons, {1, 1}, 1, {1, nullptr});
    EXPECT_EQ(t.candidates(grid, 0), (std::vector<std::int32_t>{0}));
    EXPECT_EQ(t.candidates(grid, 1), (std::vector<std::int32_t>{1}));
}

}  // namespace
}  // namespace realmodel::strata
