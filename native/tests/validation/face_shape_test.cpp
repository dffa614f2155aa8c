// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/face_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

using Position = std::array<double, 3>;
using Corners = std::vector<Position>;
constexpr std::int32_t kSurface = 0;

OwnedComplex face_of(const Corners& corners, std::int32_t on) {
    OwnedComplex complex;
    complex.vertices = corners;
    std::vector<std::int32_t> loop(corners.size());
    std::iota(loop.begin(), loop.end(), 0);
    complex.add_face(loop, 0, -1, on);
    complex.block = {0};
    complex.base = {0};
    return complex;
}

std::string fault(OwnedComplex complex) {
    const ComplexView model = complex.view();
    FaceShape shape(model);
    shape.load(0);
    return shape.fault().value_or("");
}
std::string fault(const Corners& corners, std::int32_t on) {
    return fault(face_of(corners, on));
}

/// As seen from above, on a slope; and as seen from negative y, upright.
Corners on_slope(const std::vector<std::array<double, 2>>& outline) {
    Corners corners;
    for (const auto& [x, y] : outline)
        corners.push_back({x, y, 2 * x - y});
    return corners;
}
Corners upright(const std::vector<std::array<double, 2>>& outline) {
    Corners corners;
    for (const auto& [x, z] : outline)
        corners.push_back({x, 3 * x, z});
    return corners;
}

const std::vector<std::array<double, 2>> kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}},
    kBowTie{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, kArrow{{0, 0}, {2, 1}, {0, 2}, {1, 1}},
    kU{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

TEST(FaceShape, OnASurfaceItIsConvexInPlan) {
    EXPECT_EQ(fault(on_slope(kSquare), kSurface), "");
    EXPECT_EQ(fault(on_slope(kArrow), kSurface), "is not convex");
    EXPECT_EQ(fault(on_slope(kBowTie), kSurface), "crosses itself");
    EXPECT_EQ(fault(on_slope({{0, 0}, {1, 0.75}, {2, 1}, {0, 3}}), kSurface), "is not convex");
    EXPECT_EQ(fault(on_slope({{0, 1}, {1, 1}, {1, 0}, {0, 0}}), kSurface), "");
    EXPECT_EQ(fault(on_slope({{0, 0}, {1, 0}, {2, 0}, {2, 2}}), kSurface), "");
}

TEST(FaceShape, ItsCornersLieInOnePlaneUpToRounding) {
    for (const double far : {0.0, 4.5e6}) {
        Corners corners = on_slope(kSquare);
        for (Position& p : corners)
            p[0] += far;
        const double step = last_place(far + 1);
        const double height = corners[2][2];
        corners[2][0] += 8 * step;
        EXPECT_EQ(fault(corners, kSurface), "") << far;
        corners[2][2] = height + 1000 * step;
        EXPECT_EQ(fault(corners, kSurface), "is bent: its corners lie in no plane") << far;
    }
}

TEST(FaceShape, ATriangleIsNeverBent) {
    EXPECT_EQ(fault({{0, 0, 0}, {1, 0, 0.1}, {0, 1, 0.3}}, kSurface), "");
}

TEST(FaceShape, AWallIsUprightAndNeedNotBeConvex) {
    EXPECT_EQ(fault(upright(kSquare), kWall), "");
    EXPECT_EQ(fault(upright(kU), kWall), "");
    EXPECT_EQ(fault(upright(kBowTie), kWall), "crosses itself");
    Corners leaning = upright(kSquare);
    leaning[2][1] += 1e-9;
    EXPECT_EQ(fault(leaning, kWall), "is a wall but is not vertical");
    EXPECT_EQ(fault({{1, 1, 0}, {1, 1, 1}, {1, 1, 2}}, kWall),
              "is a wall, but has no extent in plan");
}

TEST(FaceShape, AWallThatGoesBackAndForthMayCrossItselfToo) {
    // there, back over the start and down through the first edge
    EXPECT_EQ(fault(upright({{0, 0}, {3, 0}, {3, 2}, {1, 2}, {1, -1}, {2, 1}, {0, 1}}), kWall),
              "crosses itself");
}

TEST(FaceShape, TheBaseIsAtItsHeightAndOutside) {
    Corners level{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
    EXPECT_EQ(fault(level, kBase), "");
    auto complex = face_of(level, kBase);
    complex.base[0] = std::nan("");
    EXPECT_EQ(fault(complex), "names the flat base, but its block stands on none");
    complex = face_of(level, kBase);
    complex.cells[0][1] = 1;
    EXPECT_EQ(fault(complex), "names the flat base, but lies between two cells");
    level[3][2] = 5e-324;  // not even by rounding
    EXPECT_EQ(fault(level, kBase), "is not level with the flat base");
}

TEST(FaceShape, ACutFaceIsConvexAsItIsSeenBest) {
    EXPECT_EQ(fault(upright(kSquare), kCutFace), "");
    EXPECT_EQ(fault(upright(kU), kCutFace), "is not convex");
    EXPECT_EQ(fault(on_slope(kArrow), kCutFace), "is not convex");
}

TEST(FaceShape, ItsAreaPointsOutOfTheFirstCell) {
    auto cubes = two_cubes();
    const ComplexView model = cubes.view();
    FaceShape shape(model);
    shape.load(0);
    EXPECT_EQ(shape.doubled_area(), (Position{0, 0, -2}));
    shape.load(3);
    EXPECT_EQ(shape.doubled_area(), (Position{0, -2, 0}));
    EXPECT_EQ(shape.corner(2), (Position{1, 0, 1}));
}

}  // namespace
}  // namespace realmodel::validation
