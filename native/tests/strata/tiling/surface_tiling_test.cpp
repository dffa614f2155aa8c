// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/surface_tiling.hpp"

#include <gtest/gtest.h>

#include "../scene.hpp"
#include "base/index.hpp"

namespace realmodel::strata {
namespace {

TEST(SurfaceTiling, CoversTheFrameWithTrianglesAndVoid) {
    Scene scene({one_triangle(1, 2, 3)});
    const SurfaceTiling tiling = scene.tiling(0);
    std::size_t with_plane = 0;
    double area = 0;
    for (std::size_t i = 0; i < tiling.polygons.size(); ++i) {
        with_plane += tiling.plane[i] == kVoid ? 0 : 1;
        const PolygonView polygon = tiling.polygons[i];
        const auto& p = scene.geometry().point(polygon[0].point);
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
            const auto &q = scene.geometry().point(polygon[k].point),
                       &r = scene.geometry().point(polygon[k + 1].point);
            area += ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / 2;
        }
    }
    EXPECT_EQ(with_plane, 1u);
    const auto& low = scene.geometry().point(scene.context->frame[0]);
    const auto& high = scene.geometry().point(scene.context->frame[2]);
    EXPECT_DOUBLE_EQ(area, (high.x - low.x) * (high.y - low.y));
}

TEST(SurfaceTiling, KnowsBetweenWhichHeightsATriangleLies) {
    Scene scene({one_triangle(1, 5, 3)});
    const SurfaceTiling tiling = scene.tiling(0);
    for (std::size_t i = 0; i < tiling.polygons.size(); ++i) {
        if (tiling.plane[i] == kVoid) continue;
        EXPECT_EQ(tiling.heights[i].low, 1);
        EXPECT_EQ(tiling.heights[i].high, 5);
    }
}

TEST(SurfaceTiling, RunsOnOnlyWhereAllNeighborsAreAtTheSameHeights) {
    const auto plane = [](double x, double) { return x; };
    Scene scene({grid(3, 3, 0, 0, 3, 3, plane)});
    const SurfaceTiling tiling = scene.tiling(0);
    std::size_t inner = 0;
    for (std::size_t i = 0; i < tiling.polygons.size(); ++i)
        inner += tiling.plane[i] != kVoid && tiling.runs_on[i] != 0 ? 1 : 0;
    EXPECT_EQ(inner, 8u);  // of 18 triangles 10 have an edge on the border
}

TEST(SurfaceTiling, TrianglesMeetInHeightWhereTheyShareBothCorners) {
    // two triangles of a square, and two that only meet in plan
    OwnedSurface torn;
    const auto a = torn.vertex(0, 0, 0), b = torn.vertex(1, 0, 0), c = torn.vertex(1, 1, 0),
               d = torn.vertex(0, 1, 0), raised = torn.vertex(1, 1, 1);
    torn.triangle(a, b, c);
    torn.triangle(a, raised, d);
    Scene scene({square(0), torn});
    auto& rocks = scene.context->rocks[0];
    const PlaneId whole = make_planes(scene.geometry(), rocks.surfaces[0], {1, nullptr});
    const PlaneId parted = make_planes(scene.geometry(), rocks.surfaces[1], {1, nullptr});
    const auto next = [](PlaneId plane) { return static_cast<PlaneId>(index(plane) + 1); };
    // the diagonal is the last edge of the first triangle
    EXPECT_TRUE(meet_in_height(scene.geometry(), whole, 2, next(whole)));
    EXPECT_FALSE(meet_in_height(scene.geometry(), parted, 2, next(parted)));
}

TEST(SurfaceTiling, TrianglesOverEachOtherAreRefusedWithAPosition) {
    OwnedSurface folded = one_triangle(0, 0, 0);
    const auto a = folded.vertex(0.1, 0.1, 1), b = folded.vertex(0.5, 0.1, 1),
               c = folded.vertex(0.1, 0.5, 1);
    folded.triangle(a, b, c);
    Scene scene({folded});
    EXPECT_FALSE(scene.context->is_single_valued);
    try {
        scene.tiling(0);
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "double_valued");
        EXPECT_EQ(error.items, (std::vector<std::int64_t>{0, 1}));
    }
}

}  // namespace
}  // namespace realmodel::strata
