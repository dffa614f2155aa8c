// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/ear_clipping.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "plan_mesh_checks.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {
namespace {

std::vector<PlanPoint> corners_of(const std::vector<Ring>& rings) {
    std::vector<PlanPoint> corners;
    for (const Ring& ring : rings)
        corners.insert(corners.end(), ring.begin(), ring.end());
    return corners;
}

/// Triangulates a polygon, and checks it: upright, conforming, of the area that constrained
/// Delaunay triangulation gives, and constrained Delaunay itself.
PlanarMesh cut(const std::vector<Ring>& rings) {
    PlanarMesh mesh{corners_of(rings), triangulate_polygon(rings)};
    std::size_t turned = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        turned += orient2d(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) <= 0;
    EXPECT_EQ(turned, 0U);
    const PlanarMesh region = triangulate_rings(rings);
    EXPECT_NEAR(area_of(mesh), area_of(region), 1e-12 * area_of(region));
    EXPECT_EQ(mesh.triangles.size(), region.triangles.size());

    std::map<std::array<std::int32_t, 2>, std::int32_t> apex;
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i)
            EXPECT_TRUE(apex.insert({{t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]}).second);
    }
    for (const auto& [side, third] : apex) {
        const auto other = apex.find({side[1], side[0]});
        if (other == apex.end()) continue;
        EXPECT_LE(in_circle(mesh.vertices[side[0]], mesh.vertices[side[1]], mesh.vertices[third],
                            mesh.vertices[other->second]),
                  0);
    }
    return mesh;
}

Ring circle(double x, double y, double radius, int corners) {
    Ring ring;
    for (int i = 0; i < corners; ++i) {
        const double turn = 2 * std::numbers::pi * i / corners;
        ring.push_back({x + radius * std::cos(turn), y + radius * std::sin(turn)});
    }
    return ring;
}

TEST(EarClipping, TheOutlineGoesEitherWay) {
    Ring square = rectangle(0, 0, 1, 1);
    EXPECT_EQ(cut({square}).triangles.size(), 2U);
    std::reverse(square.begin(), square.end());
    EXPECT_EQ(cut({square}).triangles.size(), 2U);
}

TEST(EarClipping, CornersThatRepeatTheOneBeforeAreLeftOut) {
    const std::vector<Ring> rings{{{0, 0}, {0, 0}, {1, 0}, {1, 1}, {1, 1}, {1, 1}, {0, 1}, {0, 0}}};
    EXPECT_EQ(triangulate_polygon(rings).size(), 2U);
}

TEST(EarClipping, RunsInOneLineStay) {
    EXPECT_EQ(cut({{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {1.5, 3}, {0, 3}}}).triangles.size(),
              5U);
}

TEST(EarClipping, HolesAreJoined) {
    std::vector<Ring> rings{rectangle(0, 0, 100, 100)};
    for (int i = 0; i < 9; ++i)
        for (int k = 0; k < 9; ++k)
            rings.push_back(circle(10 + 10 * i, 10 + 10 * k + 0.1 * i, 4, 5 + (i + k) % 7));
    cut(rings);
}

TEST(EarClipping, HolesMayTouchInCorners) {
    cut({rectangle(0, 0, 10, 10), {{0, 0}, {2, 1}, {1, 2}}, {{2, 1}, {4, 1}, {3, 2}}});
    std::vector<Ring> chess{rectangle(0, 0, 10, 10)};
    for (int i = 1; i < 9; ++i)
        for (int k = 1; k < 9; ++k)
            if ((i + k) % 2 == 1) chess.push_back(rectangle(i, k, i + 1, k + 1));
    cut(chess);
}

TEST(EarClipping, AHoleThatTouchesAnEdgeIsLeftToTheRegion) {
    cut({rectangle(0, 0, 10, 10), {{5, 0}, {6, 2}, {4, 2}}});
    cut({rectangle(0, 0, 10, 10), {{0, 5}, {2, 4}, {2, 6}}});
}

TEST(EarClipping, ClustersAreFollowed) {
    // A coast of a thousandth of the outline's size in one corner of it.
    Ring coast{{1e5, 0}, {1e5, 1e5}, {0, 1e5}};
    for (int i = 0; i < 4000; ++i)
        coast.push_back({0.01 * i * (i % 2), 40 - 0.01 * i});
    cut({coast});
}

TEST(EarClipping, NastyOutlines) {
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    Ring bristles, comb{{0, -1}}, spiral;
    for (int i = 0; i < 3000; ++i) {
        const double turn = 2 * std::numbers::pi * i / 3000, radius = 50 + 50 * uniform();
        bristles.push_back({radius * std::cos(turn), radius * std::sin(turn)});
    }
    for (int i = 0; i < 1000; ++i) {
        const double x = i;
        comb.insert(comb.end(), {{x, 0}, {x + 1e-6, 20}, {x + 2e-6, 0}});
    }
    comb.push_back({1000, 0});
    comb.push_back({1000, -1});
    for (const double off : {0.0, 0.3}) {
        Ring arm;
        for (int i = 0; i < 2000; ++i) {
            const double turn = 3 + 0.05 * i;
            arm.push_back({(turn - off) * std::cos(turn), (turn - off) * std::sin(turn)});
        }
        if (off > 0) std::reverse(arm.begin(), arm.end());
        spiral.insert(spiral.end(), arm.begin(), arm.end());
    }
    cut({bristles});
    cut({comb});
    cut({spiral});
}

TEST(EarClipping, RefusesWhatBoundsNothing) {
    const auto refused = [](const std::vector<Ring>& rings) {
        return refusal([&] { triangulate_polygon(rings); }).kind;
    };
    EXPECT_EQ(refused({}), "no_outline");
    EXPECT_EQ(refused({{{0, 0}, {1, 0}}}), "outline_degenerate");
    EXPECT_EQ(refused({rectangle(0, 0, 9, 9), {{0, 0}, {1, 1}, {2, 2}}}), "outline_degenerate");
    EXPECT_EQ(refused({{{0, 0}, {1, 0}, {1, std::nan("")}}}), "not_finite");
}

TEST(EarClipping, StopsWhenAsked) {
    Progress progress;
    progress.cancel();
    const std::vector<Ring> rings{circle(0, 0, 1, 10'000)};
    EXPECT_THROW(triangulate_polygon(rings, &progress), Cancelled);
}

}  // namespace
}  // namespace realmodel::meshing
