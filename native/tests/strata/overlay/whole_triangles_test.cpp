// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/whole_triangles.hpp"

#include "../scene.hpp"

namespace realmodel::strata {
namespace {

/// Facets that are all triangles of one surface, and another one that is compared with them.
struct Comparing {
    Scene scene;
    TriangleLinks links;
    BlockTiling lower, upper;
    BorderEdges borders;
    WholeTriangleFilter filter;
    std::vector<Cover> cover;

    /// @param raised  also put the facets among the surface's own triangles
    Comparing(const OwnedSurface& below, const OwnedSurface& above, bool raised = false)
        : scene({below, above}),
          lower(scene.block_tiling(0, links)),
          upper(scene.block_tiling(1, links)),
          borders(scene.geometry(), PlanTiles({0, 0, 6, 6}, 36), links.border),
          filter(scene.geometry(), borders, 2, {1, nullptr}),
          cover(filter.tiles().size(), Cover::kFacets) {
        if (raised) lower = upper;
        lower.is_raised = raised;
        filter.begin(lower);
        filter.compare({upper.whole, {}, PolygonPool(), {}, {}, cover});
    }
    long triangles(HeightRelation relation) const {
        return std::count(filter.surface.begin(), filter.surface.end(), relation);
    }
    long facets(HeightRelation relation) const {
        return std::count(filter.facet.begin(), filter.facet.end(), relation);
    }
};

OwnedSurface level(double z, int n = 6, bool other = false) {
    return grid(
        n, n, 0, 0, 6, 6, [z](double, double) { return z; }, other);
}

/// In tiles of borders, the outer ones here, heights decide nothing, and a triangle whose middle is
/// near an edge is exact.
void expect_sorted(const Comparing& c, HeightRelation wanted) {
    for (std::size_t t = 0; t < c.lower.whole.size(); ++t) {
        const auto box = bounds_of(c.scene.context->geometry, c.lower.whole[t]).box;
        const bool is_inner =
            box.low_x > 0.5 && box.high_x < 4.5 && box.low_y > 0.5 && box.high_y < 4.5;
        if (is_inner || c.filter.surface[t] != HeightRelation::kExact) {
            EXPECT_EQ(c.filter.surface[t], wanted);
        }
    }
    const HeightRelation of_facets =
        wanted == HeightRelation::kBelow ? HeightRelation::kAbove : HeightRelation::kBelow;
    EXPECT_GT(c.facets(of_facets), 0);
    EXPECT_EQ(c.facets(of_facets) + c.facets(HeightRelation::kExact), 32);
}

TEST(WholeTriangles, FarBelowAreSorted) {
    expect_sorted(Comparing(level(0), level(1, 4, true)), HeightRelation::kBelow);
}

TEST(WholeTriangles, FarAboveAreSorted) {
    expect_sorted(Comparing(level(1), level(0, 4, true)), HeightRelation::kAbove);
}

TEST(WholeTriangles, EquallyHighOnesAreExact) {
    const Comparing c(level(1), level(1, 4, true));
    EXPECT_EQ(c.triangles(HeightRelation::kExact), 72);
    EXPECT_EQ(c.facets(HeightRelation::kExact), 32);
}

TEST(WholeTriangles, OnlyThoseBesideACrossingAreExact) {
    const auto slope = grid(6, 6, 0, 0, 6, 6, [](double x, double) { return x - 2.5; });
    const Comparing c(level(0), slope);
    // the crossing at x = 5/2 runs through the third column of squares
    EXPECT_GE(c.triangles(HeightRelation::kExact), 12);
    EXPECT_GT(c.triangles(HeightRelation::kAbove), 0);
    EXPECT_GE(c.triangles(HeightRelation::kBelow), 24);
    for (std::size_t t = 0; t < c.lower.whole.size(); ++t) {
        const auto box = bounds_of(c.scene.context->geometry, c.lower.whole[t]).box;
        const HeightRelation relation = c.filter.surface[t];
        if (box.low_x < 2.5 && box.high_x > 2.5) {
            EXPECT_EQ(relation, HeightRelation::kExact);
        } else if (relation != HeightRelation::kExact) {
            EXPECT_EQ(relation, box.low_x > 2.5 ? HeightRelation::kBelow : HeightRelation::kAbove);
        }
    }
}

TEST(WholeTriangles, AreDividedByABorder) {
    OwnedSurface holed = level(1, 2);
    holed.triangles.erase(holed.triangles.begin(), holed.triangles.begin() + 3);
    const Comparing c(level(0, 1), holed);
    // the hole lies beneath one half of the square
    EXPECT_EQ(c.triangles(HeightRelation::kExact), 1);
}

TEST(WholeTriangles, OfRaisedSurfacesMayBeTheFacetsThemselves) {
    const Comparing c(level(0), level(1), true);
    EXPECT_EQ(c.triangles(HeightRelation::kAbove), 72);  // not below: eroded there
    EXPECT_EQ(c.facets(HeightRelation::kBelow), 72);
}

TEST(TriangleLinks, AreSymmetricAndEndAtBorders) {
    Scene scene({level(0, 2)});
    TriangleLinks links;
    const BlockTiling tiling = scene.block_tiling(0, links);
    EXPECT_EQ(tiling.whole.size(), 8u);
    EXPECT_EQ(links.border.size(), 8u);  // two edges on each side of the square
    for (const PlaneId plane : tiling.whole) {
        for (const PlaneId n : links.of(plane)) {
            if (!n.has_value()) continue;
            const auto& back = links.of(n);
            EXPECT_EQ(std::count(back.begin(), back.end(), plane), 1);
        }
    }
}

}  // namespace
}  // namespace realmodel::strata
