// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_overlay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "../arrangement/small_polygons.hpp"
#include "../validation/small_complex.hpp"
#include "base/floating_point.hpp"
#include "exact/space_points.hpp"
#include "level_cutter.hpp"
#include "prism.hpp"

namespace realmodel::cutting {
namespace {

/// Two unit cubes, one on the other, and a triangle that reaches far beyond them.
struct Overlaid {
    explicit Overlaid(double height, bool upward = true) : surface(level_cutter(height, upward)) {}
    std::size_t regions_of_cutter() const {
        std::size_t count = 0;
        for (std::size_t r = 0; r < overlay.size(); ++r)
            count += overlay.of_cutter(r);
        return count;
    }
    bool on_cutter(int vertex) {
        const auto& t = surface.triangles[0];
        const auto at = [&](std::size_t i) {
            return overlay.points().add(surface.vertices[index(t[i])]);
        };
        return exact::orient3d(overlay.points(), at(0), at(1), at(2),
                               overlay.exact(NodeId{vertex})) == 0;
    }

    validation::OwnedComplex cubes = validation::two_cubes();
    ComplexView model = cubes.view();
    Cutter surface;
    CutterOverlay overlay{model, surface, {1, nullptr}};
};

TEST(CutterOverlay, OnlyFacesNearTheSurfaceHaveRegions) {
    Overlaid cut(0.5);
    EXPECT_EQ(cut.overlay.active_faces(), (std::vector<std::int32_t>{3, 4, 5, 6}));
    EXPECT_TRUE(cut.overlay.is_active(6));
    EXPECT_FALSE(cut.overlay.is_active(1));
    EXPECT_TRUE(Overlaid(5).overlay.active_faces().empty());
}

TEST(CutterOverlay, SurfaceAndWallsDivideOneAnother) {
    // it halves each wall, and has a region within and one around
    Overlaid cut(0.5);
    EXPECT_EQ(cut.overlay.size(), 4U * 2 + 2);
    EXPECT_EQ(cut.regions_of_cutter(), 2U);
    // new nodes: on four upright edges, and the surface's corners
    EXPECT_EQ(cut.overlay.new_positions().size(), 4U + 3);
    for (const Position& p : cut.overlay.new_positions())
        EXPECT_EQ(p[2], 0.5);
}

TEST(CutterOverlay, AFaceThatOneTrianglePassesIsInTwo) {
    // the ends of a prism have eight corners; two of its sides are passed as well
    auto owned = prism({{1, 0}, {2, 0}, {3, 1}, {3, 2}, {2, 3}, {1, 3}, {0, 2}, {0, 1}});
    const ComplexView model = owned.view();
    const Cutter surface = level_cutter(1.5);
    CutterOverlay overlay(model, surface, {1, nullptr});
    std::map<std::size_t, std::size_t> corners;
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (overlay.of_cutter(r)) continue;
        EXPECT_EQ(overlay.loops(r).size(), 1U);
        EXPECT_NE(overlay.points().rounded(overlay.inner_point(r))[2], 1.5);
        corners[overlay.face_of(r)] += overlay.loops(r)[0].size();
    }
    EXPECT_EQ(corners, (std::map<std::size_t, std::size_t>{{0, 12}, {1, 12}, {4, 8}, {8, 8}}));
    EXPECT_EQ(overlay.boxed_face(0).triangles.size(), 2U * 4);
    EXPECT_EQ(overlay.new_positions().size(), 4U + 3);
}

TEST(CutterOverlay, WhatIsBesideTheSurfaceStaysInOnePiece) {
    // Each end of eight corners is a strip of two triangles, which the surface halves, and a
    // polygon on either side of it. A triangle that is there twice is more than faces in two are
    // made for.
    auto owned = prism({{1, 0}, {2, 0}, {3, 1}, {3, 2}, {2, 3}, {1, 3}, {0, 2}, {0, 1}});
    const ComplexView model = owned.view();
    Cutter surface = level_cutter(1.5);
    surface.triangles.push_back(surface.triangles[0]);
    CutterOverlay overlay(model, surface, {1, nullptr});
    std::map<std::size_t, std::size_t> regions, polygons;
    std::map<std::array<NodeId, 2>, int> sum;
    const auto add = [&sum](std::span<const NodeId> loop) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const NodeId a = loop[i], b = loop[(i + 1) % loop.size()];
            sum[unordered(a, b)] += a < b ? 1 : -1;
        }
    };
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (overlay.of_cutter(r)) continue;
        const auto outline = overlay.loops(r)[0];
        ++regions[overlay.face_of(r)];
        polygons[overlay.face_of(r)] += std::ranges::all_of(
            outline, [&](NodeId v) { return index(v) < owned.vertices.size(); });
        add(outline);
        const auto inner = overlay.points().rounded(overlay.inner_point(r));
        EXPECT_NE(inner[2], 1.5);
    }
    EXPECT_EQ(regions, (std::map<std::size_t, std::size_t>{{0, 6}, {1, 6}, {4, 4}, {8, 4}}));
    EXPECT_EQ(polygons, (std::map<std::size_t, std::size_t>{{0, 2}, {1, 2}, {4, 0}, {8, 0}}));
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        if (!overlay.is_active(f)) add(model.face(f));
    }
    for (const auto& [edge, uses] : sum)
        EXPECT_EQ(uses, 0) << edge[0] << ' ' << edge[1];
}

TEST(CutterOverlay, AroundTheCubesTheSurfaceHasAHole) {
    Overlaid cut(0.5);
    std::size_t holes = 0;
    for (std::size_t r = 0; r < cut.overlay.size(); ++r) {
        if (cut.overlay.loops(r).size() == 1) continue;
        ++holes;
        EXPECT_TRUE(cut.overlay.of_cutter(r));
        EXPECT_EQ(cut.overlay.loops(r)[0].size(), 3U);
        EXPECT_EQ(cut.overlay.loops(r)[1].size(), 4U);
    }
    EXPECT_EQ(holes, 1U);
}

TEST(CutterOverlay, VerticesOnTheSurfaceButForRoundingAreTakenToLieOnIt) {
    for (const double height : {1.0, moved_by_ulps(1, 2), moved_by_ulps(1, -2)}) {
        Overlaid cut(height);
        EXPECT_TRUE(cut.on_cutter(4)) << height;
        EXPECT_FALSE(cut.on_cutter(0));
        EXPECT_EQ(cut.overlay.position(NodeId{4})[2], 1);  // where it is in the model
    }
    EXPECT_FALSE(Overlaid(moved_by_ulps(1, 64)).on_cutter(4));
}

TEST(CutterOverlay, AlongAFaceItsTrianglesDivideTheSurface) {
    Overlaid cut(1);
    std::vector<NodeLoop> of_cutter, of_face;
    for (std::size_t r = 0; r < cut.overlay.size(); ++r) {
        const NodeLoop outline = from_least(cut.overlay.loops(r)[0]);
        if (cut.overlay.of_cutter(r)) {
            of_cutter.push_back(outline);
        } else if (cut.overlay.face_of(r) == 1) {
            of_face.push_back(outline);
        }
    }
    EXPECT_EQ(of_face.size(), 2U);
    EXPECT_EQ(of_cutter.size(), 3U);
    for (const NodeLoop& region : of_face)
        EXPECT_EQ(std::ranges::count(of_cutter, region), 1);
}

TEST(CutterOverlay, AnInnerPointIsInItsRegionAndInNoHole) {
    for (const bool upward : {true, false}) {
        Overlaid cut(0.5, upward);
        int within = 0;
        for (std::size_t r = 0; r < cut.overlay.size(); ++r) {
            if (!cut.overlay.of_cutter(r)) continue;
            const exact::SpacePointId inner = cut.overlay.inner_point(r);
            const Position p = cut.overlay.points().rounded(inner);
            const bool in_cube = p[0] > 0 && p[0] < 1 && p[1] > 0 && p[1] < 1;
            EXPECT_EQ(in_cube, cut.overlay.loops(r).size() == 1);
            EXPECT_EQ(p[2], 0.5);
            within += in_cube;
        }
        EXPECT_EQ(within, 1);
    }
}

TEST(CutterOverlay, TheFanOfAnEdgeHasTheSurfaceAndTheWall) {
    Overlaid cut(0.5);
    // around the cut of a wall: the wall above, the wall below, the surface on two sides
    std::vector<arrangement::EdgeUse> uses;
    for (std::size_t r = 0; r < cut.overlay.size(); ++r)
        arrangement::for_each_edge(cut.overlay.loops(r), static_cast<std::int32_t>(r),
                                   [&](const arrangement::EdgeUse& use) { uses.push_back(use); });
    std::sort(uses.begin(), uses.end());
    std::size_t begin = 0;
    while (uses[begin].edge != uses[begin + 3].edge)
        ++begin;
    std::vector<arrangement::HalfPlane> scratch;
    arrangement::EdgeFan fan;
    cut.overlay.find_fan(std::span(uses).subspan(begin, 4), scratch, fan);
    ASSERT_EQ(fan.half_planes(), 4U);
    for (std::size_t b = 0; b < 4; ++b) {
        const auto of_cutter = [&](std::size_t half_plane) {
            return cut.overlay.of_cutter(
                index(uses[begin + fan.half_plane(half_plane % 4)[0]].item));
        };
        EXPECT_NE(of_cutter(b), of_cutter(b + 1));
    }
}

}  // namespace
}  // namespace realmodel::cutting
