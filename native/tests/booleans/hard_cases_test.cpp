// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "../sanitized.hpp"
#include "realmodel/booleans/intersect.hpp"
#include "refined_meshes.hpp"
#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

TEST(IntersectHard, FiftyOperationsOneAfterAnother) {
    Mesh solid = sphere({0, 0, 0}, 1, 8);
    double volume = solid.volume();
    for (int i = 0; i < (kSanitized ? 20 : 50); ++i) {
        Mesh tool = i % 3 == 0 ? cube({-0.2, -0.2, -0.2}, 0.4) : sphere({0, 0, 0}, 0.25, 4);
        rotate(tool, 0.7 * i, static_cast<std::size_t>(i) % 3);
        const double angle = 2.4 * i, height = 1 - 2 * (i + 0.5) / 50,
                     far = std::sqrt(1 - height * height);
        for (std::size_t k = 0; k < tool.vertices.size(); k += 3) {
            tool.vertices[k] += far * std::cos(angle);
            tool.vertices[k + 1] += far * std::sin(angle);
            tool.vertices[k + 2] += height;
        }
        const Refinement r = intersect(solid.view(), tool.view());
        expect_sums(r, volume, tool.volume(), 1e-9);
        solid = mesh_of(r, r.boundary(i % 2 == 0 ? Operation::kUnion : Operation::kDifference));
        volume = solid.volume();
    }
    EXPECT_GT(volume, 2);
    const Mesh far = cube({50, 0, 0}, 1);
    EXPECT_EQ(intersect(solid.view(), far.view()).triangles.size(),
              solid.triangles.size() / 3 + 12);
}

TEST(IntersectHard, ALatticeOfCubesAndOneMovedByHalf) {
    Mesh a, b;
    for (int i = 0; i < 27; ++i) {
        const std::array<double, 3> low{1.0 * (i % 3), 1.0 * (i / 3 % 3), 1.0 * (i / 9)};
        a.add(cube(low, 1));
        if (i % 2 == 0) b.add(cube({low[0] + 0.5, low[1] + 0.5, low[2]}, 1));
    }
    const Refinement r = intersect(a.view(), b.view());
    expect_sums(r, 27, 14, 1e-12);
    expect_settled(r);
    EXPECT_NEAR(mesh_of(r, r.boundary(Operation::kUnion)).volume(), 27 + 14 - 9.5, 3);
}

TEST(IntersectHard, CubesThatTouchInAnEdgeOrACorner) {
    for (const std::array<double, 3>& low :
         {std::array{1.0, 1.0, 0.0}, {1.0, 1.0, 1.0}, {1.0, 0.5, 0.0}, {1.0, 0.5, 0.25}}) {
        const Mesh a = cube({0, 0, 0}, 1), b = cube(low, 1);
        const Refinement r = intersect(a.view(), b.view());
        expect_sums(r, 1, 1, 1e-15);
        expect_settled(r);
        EXPECT_EQ(r.sub_blocks.size(), 2U);
    }
}

TEST(IntersectHard, ACubeTurnedInPlaceManyTimes) {
    for (int i = 1; i < 40; i += kSanitized ? 6 : 1) {
        const Mesh a = cube({-1, -1, -1}, 2);
        Mesh b = a;
        rotate(b, std::pow(0.4, i), 2);  // nearly in the planes of its top and bottom
        rotate(b, std::pow(0.3, 40 - i), 0);
        const Refinement r = intersect(a.view(), b.view());
        expect_sums(r, 8, b.volume(), 1e-9);
        expect_settled(r);
    }
}

TEST(IntersectHard, SpheresMovedByAFewUnits) {
    for (const int units : {1, 3, 20, 300}) {
        const Mesh a = sphere({5, 3, 1}, 1, 8);
        Mesh b = a;
        for (std::size_t k = 0; k < b.vertices.size(); ++k) {
            for (int i = 0; i < units; ++i)
                b.vertices[k] = std::nextafter(b.vertices[k], k % 2 == 0 ? 10.0 : -10.0);
        }
        const Refinement r = intersect(a.view(), b.view());
        expect_sums(r, a.volume(), b.volume(), 1e-9);
        expect_settled(r);
    }
}

/// A corner touches a triangle that another one divides. Once there are as many triangles as
/// pieces, which had been taken for "nothing is divided yet".
TEST(IntersectHard, TrianglesFarAwayChangeNothing) {
    const Mesh a{{0, 0, 0, 8, 0, 0, 0, 8, 0}, {0, 1, 2}};
    Mesh b{{1, 1, 0, 1, 1, 2, 1, 2, 2, 3, -1, -1, 3, -1, 1, 3, 9, 0}, {0, 1, 2, 3, 4, 5}};
    const std::size_t alone = intersect(a.view(), b.view()).triangles.size();
    for (std::size_t far = 1; far < 20; ++far) {
        const double x = 100.0 * static_cast<double>(far);
        b.add({{x, 0, 0, x, 1, 0, x, 0, 1}, {0, 1, 2}});
        EXPECT_EQ(intersect(a.view(), b.view()).triangles.size(), alone + far);
    }
}

TEST(IntersectHard, ASingleTriangleInACube) {
    const Mesh a = cube({0, 0, 0}, 2);
    const Mesh inside{{0.5, 0.5, 0.5, 1.5, 0.5, 0.5, 0.5, 1.5, 0.5}, {0, 1, 2}};
    const Refinement r = intersect(a.view(), inside.view());
    EXPECT_EQ(r.triangles.size(), 13U);
    EXPECT_TRUE(r.loops.empty());
    ASSERT_EQ(r.sub_blocks.size(), 1U);  // a sheet within a solid does not divide it
    EXPECT_DOUBLE_EQ(r.volume(r.sub_blocks[0]), 8);
    const Mesh across{{-1, -1, 1, 5, -1, 1, -1, 5, 1}, {0, 1, 2}};
    EXPECT_EQ(intersect(a.view(), across.view()).sub_blocks.size(), 2U);
    EXPECT_TRUE(intersect(inside.view(), across.view()).loops.empty());
}

TEST(IntersectHard, TwoCubesThatShareAnEdgeAreOneSurface) {
    Mesh a = cube({0, 0, 0}, 1);
    a.add(cube({1, 1, 0}, 1));
    const Mesh b = cube({0.5, 0.5, 0.25}, 1);
    expect_sums(intersect(a.view(), b.view()), 2, 1, 1e-12);
}

TEST(IntersectHard, LoopsOfTwoCylindersThatCross) {
    // their intersection edges meet in two vertices of four edges each
    const auto cylinder = [](bool upright) {
        constexpr int kAround = 16;
        Mesh mesh;
        for (int i = 0; i < kAround; ++i) {
            const double c = std::cos(2 * std::numbers::pi * i / kAround),
                         s = std::sin(2 * std::numbers::pi * i / kAround);
            for (const double end : {-3.0, 3.0}) {
                const std::array<double, 3> p =
                    upright ? std::array{c, s, end} : std::array{end, s, c};
                mesh.vertices.insert(mesh.vertices.end(), p.begin(), p.end());
            }
        }
        for (int i = 0; i < kAround; ++i) {
            const int a = 2 * i, b = 2 * ((i + 1) % kAround);
            mesh.triangles.insert(mesh.triangles.end(), {a, b, a + 1, b, b + 1, a + 1});
        }
        return mesh;
    };
    const Mesh a = cylinder(true), b = cylinder(false);
    const Refinement r = intersect(a.view(), b.view());
    expect_settled(r);
    EXPECT_FALSE(r.is_closed[0]);
    EXPECT_EQ(r.loops.size(), 4U);
    for (const IntersectionLoop& loop : r.loops)
        EXPECT_EQ(loop.kind, LoopKind::kSoftClosed);
    ASSERT_EQ(r.sub_blocks.size(), 1U);
    EXPECT_EQ(std::count_if(r.sub_surfaces.begin(), r.sub_surfaces.end(),
                            [](const SubSurface& s) { return s.is_public; }),
              0);
}

TEST(IntersectHard, SoftLoopsMeetInOneVertex) {
    // two tetrahedra with a common corner upon a square: their outlines there touch in that corner
    const Mesh a = square({-4, -4, 0}, 8);
    Mesh b;
    for (const double side : {-1.0, 1.0}) {
        const Mesh t{{0, 0, 0, side, 1, 0, side, -1, 0, side, 0, 1},
                     {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}};
        b.add(t);
    }
    const Refinement r = intersect(a.view(), b.view());
    ASSERT_EQ(r.loops.size(), 2U);
    for (const IntersectionLoop& loop : r.loops) {
        EXPECT_EQ(loop.kind, LoopKind::kSoftClosed);
        ASSERT_EQ(loop.vertices.size(), 4U);
        EXPECT_EQ(loop.vertices.front(), loop.vertices.back());
    }
}

TEST(IntersectHard, RefusesWhatHasNoPlace) {
    const Mesh a = cube({0, 0, 0}, 1);
    const auto kind_of = [&](const Mesh& b) -> std::string {
        try {
            intersect(a.view(), b.view());
        } catch (const InputError& error) {
            EXPECT_EQ(error.surface, 1);
            return error.kind;
        }
        return "";
    };
    Mesh b = a;
    b.vertices[4] = std::nan("");
    EXPECT_EQ(kind_of(b), "not_finite");
    b.vertices[4] = HUGE_VAL;
    EXPECT_EQ(kind_of(b), "not_finite");
    EXPECT_EQ(kind_of(Mesh{}), "no_triangles");
    b = a;
    b.triangles[0] = -1;
    EXPECT_EQ(kind_of(b), "bad_index");
}

}  // namespace
}  // namespace realmodel::booleans
