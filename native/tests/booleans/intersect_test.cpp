// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/booleans/intersect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "small_meshes.hpp"

namespace realmodel::booleans {
namespace {

double volume_of(const Refinement& r, const std::vector<std::array<std::int32_t, 3>>& triangles) {
    double sum = 0;
    for (const auto& t : triangles) {
        std::array<const double*, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = &r.vertices[3 * static_cast<std::size_t>(t[k])];
        sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
               p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    return sum / 6;
}

bool is_closed(const std::vector<std::array<std::int32_t, 3>>& triangles) {
    std::map<std::array<std::int32_t, 2>, int> net;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            ++net[{t[k], t[(k + 1) % 3]}];
            --net[{t[(k + 1) % 3], t[k]}];
        }
    }
    return std::all_of(net.begin(), net.end(), [](const auto& edge) { return edge.second == 0; });
}

struct Volumes {
    double both, common, first_only, second_only;
};

Volumes volumes(const Refinement& r) {
    std::array<double, 4> found{};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto triangles = r.boundary(static_cast<Operation>(i));
        EXPECT_TRUE(is_closed(triangles)) << i;
        found[i] = volume_of(r, triangles);
    }
    return {found[0], found[1], found[2], found[3]};
}

TEST(Intersect, TwoCubesThatOverlap) {
    const Mesh a = cube({0, 0, 0}, 2), b = cube({1, 1, 1}, 2);
    const Refinement r = intersect(a.view(), b.view());
    const Volumes v = volumes(r);
    EXPECT_DOUBLE_EQ(v.both, 15);
    EXPECT_DOUBLE_EQ(v.common, 1);
    EXPECT_DOUBLE_EQ(v.first_only, 7);
    EXPECT_DOUBLE_EQ(v.second_only, 7);
    ASSERT_EQ(r.loops.size(), 1U);
    EXPECT_EQ(r.loops[0].kind, LoopKind::kHardClosed);
    EXPECT_EQ(r.sub_surfaces.size(), 4U);
    EXPECT_EQ(r.sub_blocks.size(), 3U);
    EXPECT_EQ(std::count_if(r.sub_surfaces.begin(), r.sub_surfaces.end(),
                            [](const SubSurface& s) { return s.is_public; }),
              2);
}

TEST(Intersect, ACubeInACube) {
    const Mesh a = cube({0, 0, 0}, 3), b = cube({1, 1, 1}, 1);
    const Refinement r = intersect(a.view(), b.view());
    const Volumes v = volumes(r);
    EXPECT_DOUBLE_EQ(v.both, 27);
    EXPECT_DOUBLE_EQ(v.common, 1);
    EXPECT_DOUBLE_EQ(v.first_only, 26);
    EXPECT_EQ(v.second_only, 0);
    EXPECT_TRUE(r.loops.empty());
    ASSERT_EQ(r.sub_blocks.size(), 2U);
    EXPECT_DOUBLE_EQ(r.volume(r.sub_blocks[0]), 26);
    EXPECT_EQ(r.sub_blocks[0].is_in, (std::array{true, false}));
    EXPECT_EQ(r.sub_blocks[1].is_in, (std::array{true, true}));
}

TEST(Intersect, CubesApart) {
    const Mesh a = cube({0, 0, 0}, 1), b = cube({5, 0, 0}, 1);
    const Refinement r = intersect(a.view(), b.view());
    EXPECT_DOUBLE_EQ(volumes(r).both, 2);
    EXPECT_EQ(volumes(r).common, 0);
    EXPECT_EQ(r.triangles.size(), 24U);
}

TEST(Intersect, CubesThatShareAFace) {
    const Mesh a = cube({0, 0, 0}, 1), b = cube({1, 0, 0}, 1);
    const Refinement r = intersect(a.view(), b.view());
    const Volumes v = volumes(r);
    EXPECT_DOUBLE_EQ(v.both, 2);
    EXPECT_EQ(v.common, 0);
    EXPECT_EQ(r.loops.size(), 1U);  // around the face
    EXPECT_EQ(r.sub_blocks.size(), 2U);
    // of each the shared face, and the rest
    EXPECT_EQ(r.sub_surfaces.size(), 4U);
    EXPECT_EQ(r.boundary(Operation::kUnion).size(), 20U);
}

TEST(Intersect, FacesThatLieInOnePlane) {
    const Mesh a = cube({0, 0, 0}, 2), b = cube({1, 1, 0}, 2);
    const Volumes v = volumes(intersect(a.view(), b.view()));
    EXPECT_DOUBLE_EQ(v.both, 14);
    EXPECT_DOUBLE_EQ(v.common, 2);
}

TEST(Intersect, ACubeWithItself) {
    const Mesh a = cube({0, 0, 0}, 1);
    const Refinement r = intersect(a.view(), a.view());
    const Volumes v = volumes(r);
    EXPECT_DOUBLE_EQ(v.both, 1);
    EXPECT_DOUBLE_EQ(v.common, 1);
    EXPECT_EQ(v.first_only, 0);
    EXPECT_TRUE(r.loops.empty());
    EXPECT_EQ(r.sub_blocks.size(), 1U);
    EXPECT_EQ(r.triangles.size(), 24U);
}

TEST(Intersect, ASheetDividesACube) {
    const Mesh a = cube({0, 0, 0}, 2), sheet = square({-1, -1, 0.5}, 4);
    const Refinement r = intersect(a.view(), sheet.view());
    ASSERT_EQ(r.sub_blocks.size(), 2U);
    std::multiset<double> found{r.volume(r.sub_blocks[0]), r.volume(r.sub_blocks[1])};
    EXPECT_EQ(found, (std::multiset<double>{2, 6}));
    for (const SubBlock& block : r.sub_blocks) {
        EXPECT_EQ(block.is_in, (std::array{true, false}));
        EXPECT_TRUE(is_closed(block.triangles));
    }
    EXPECT_EQ(r.loops.size(), 1U);
    EXPECT_EQ(r.sub_surfaces.size(), 4U);
    EXPECT_THROW(static_cast<void>(r.boundary(Operation::kUnion)), InputError);
}

TEST(Intersect, TwoSheetsThatCross) {
    const Mesh a = square({0, 0, 0}, 2), b = upright({0.5, -1, -1}, 4);
    const Refinement r = intersect(a.view(), b.view());
    ASSERT_EQ(r.loops.size(), 1U);
    EXPECT_EQ(r.loops[0].kind, LoopKind::kOpen);
    EXPECT_TRUE(r.sub_blocks.empty());
    EXPECT_EQ(r.sub_surfaces.size(), 3U);  // one is divided, the other one only slit
}

TEST(Intersect, ASurfaceThatCrossesItself) {
    Mesh a = cube({0, 0, 0}, 2);
    a.add(cube({1, 1, 1}, 2));
    const Mesh b = cube({10, 0, 0}, 1);
    const Refinement r = intersect(a.view(), b.view());
    EXPECT_DOUBLE_EQ(volumes(r).both, 16);
    EXPECT_TRUE(r.loops.empty());
}

/// Inside is where the winding number is not zero: what is covered twice is inside once, a part
/// that is turned inside out is solid by itself, and a hole in another part.
TEST(Intersect, WhatIsInsideOfASolidThatOverlapsItself) {
    const auto turned = [](Mesh mesh) {
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
            std::swap(mesh.triangles[t + 1], mesh.triangles[t + 2]);
        return mesh;
    };
    const auto volume_with = [](Mesh mesh, const Mesh& part) {
        mesh.add(part);
        const Mesh around = cube({-1, -1, -1}, 8);
        return volumes(intersect(mesh.view(), around.view())).common;
    };
    const Mesh a = cube({0, 0, 0}, 3);
    EXPECT_DOUBLE_EQ(volume_with(a, cube({2, 2, 2}, 3)), 27 + 27 - 1);          // parity: 52
    EXPECT_DOUBLE_EQ(volume_with(a, cube({1, 1, 1}, 1)), 27);                   // parity: 26
    EXPECT_DOUBLE_EQ(volume_with(a, turned(cube({1, 1, 1}, 1))), 26);           // a hole
    EXPECT_DOUBLE_EQ(volume_with(a, turned(cube({5, 5, 5}, 1))), 28);           // solid by itself
    EXPECT_DOUBLE_EQ(volume_with(a, turned(cube({2, 2, 2}, 3))), 27 + 27 - 2);  // cancels
    EXPECT_DOUBLE_EQ(volume_with(turned(a), turned(cube({2, 2, 2}, 3))), 53);
}

TEST(Intersect, TheSameForAnyNumberOfThreads) {
    const Mesh a = sphere({0, 0, 0}, 1, 24), b = sphere({0.3, 0.2, 0.1}, 0.9, 31);
    const Refinement one = intersect(a.view(), b.view(), {1}),
                     two = intersect(a.view(), b.view(), {2});
    EXPECT_EQ(one.vertices, two.vertices);
    EXPECT_EQ(one.triangles, two.triangles);
    const Volumes v = volumes(one);
    EXPECT_NEAR(v.both + v.common, a.volume() + b.volume(), 1e-12);
    EXPECT_NEAR(v.first_only + v.common, a.volume(), 1e-12);
}

TEST(Intersect, NothingIsFoundInTheResultAgain) {
    const Mesh a = sphere({0, 0, 0}, 1, 24), b = sphere({0.3, 0.2, 0.1}, 0.9, 31);
    const Refinement r = intersect(a.view(), b.view());
    Mesh result{r.vertices, {}};
    for (const auto& t : r.boundary(Operation::kUnion))
        result.triangles.insert(result.triangles.end(), t.begin(), t.end());
    const Mesh far = cube({50, 0, 0}, 1);
    const Refinement again = intersect(result.view(), far.view());
    EXPECT_EQ(again.triangles.size(), result.triangles.size() / 3 + 12);
}

TEST(Intersect, ASphereMovedByOneUnitInTheLastPlace) {
    const Mesh a = sphere({0, 0, 0}, 1, 16);
    Mesh b = a;
    for (double& x : b.vertices)
        x = std::nextafter(x, 10.0);
    const Refinement r = intersect(a.view(), b.view());
    const Volumes v = volumes(r);
    EXPECT_NEAR(v.both, a.volume(), 1e-12);
    EXPECT_NEAR(v.common, a.volume(), 1e-12);
    EXPECT_NEAR(v.first_only, 0, 1e-12);
}

TEST(Intersect, AnOperandThatReachesFarLeavesTheNearOneItsVolume) {
    for (const double far : {1e6, 1e10, 1e14, 1e15, 1e17, 1e20, 1e38}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Mesh near = cube({-1, -1, -1}, 2);
            Mesh half = cube({-1, -1, -1}, 2);  // all space below 0.25 along an axis
            for (std::size_t i = 0; i < half.vertices.size(); ++i)
                half.vertices[i] =
                    i % 3 == axis && half.vertices[i] > 0 ? 0.25 : far * half.vertices[i];
            const Refinement r = intersect(near.view(), half.view());
            const auto common = r.boundary(Operation::kIntersection);
            const auto rest = r.boundary(Operation::kDifference);
            EXPECT_TRUE(is_closed(common) && is_closed(rest)) << far;
            EXPECT_NEAR(volume_of(r, common), 5, 1e-12) << far;
            EXPECT_NEAR(volume_of(r, rest), 3, 1e-12) << far;
        }
    }
}

TEST(Intersect, RefusesWhatIsNoSurface) {
    const Mesh a = cube({0, 0, 0}, 1);
    Mesh b = a;
    b.triangles[5] = 99;
    try {
        intersect(a.view(), b.view());
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "bad_index");
        EXPECT_EQ(error.surface, 1);
        EXPECT_EQ(error.items, (std::vector<std::int64_t>{1}));
    }
}

}  // namespace
}  // namespace realmodel::booleans
