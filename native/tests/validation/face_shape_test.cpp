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

OwnedComplex one_face(const Corners& corners, std::int32_t on) {
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
    return fault(one_face(corners, on));
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
    auto complex = one_face(level, kBase);
    complex.base[0] = std::nan("");
    EXPECT_EQ(fault(complex), "names the flat base, but its block stands on none");
    complex = one_face(level, kBase);
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

/// What the faces of each cell add up to.
std::vector<double> volumes(const ComplexView& model) {
    const FacesByCell sides(model, {1, nullptr});
    const FaceMeasures faces(model, sides, {1, nullptr});
    std::vector<double> sums(model.cell_count(), 0);
    for (std::size_t c = 0; c < sums.size(); ++c) {
        for (const OrientedFace side : sides[c])
            sums[c] += faces[face_of(side)].volume[is_reversed(side) ? 1 : 0];
    }
    return sums;
}

TEST(FaceMeasures, AddUpToTheVolumesOfCells) {
    auto cubes = two_cubes();
    for (auto& v : cubes.vertices) {
        if (v[2] == 2) v[2] = 4;
    }
    EXPECT_EQ(volumes(cubes.view()), (std::vector<double>{1, 3}));
}

TEST(FaceMeasures, AreMeasuredFromACornerOfEachCell) {
    auto cubes = two_cubes();
    for (auto& v : cubes.vertices)
        v[2] += 100;
    std::swap(cubes.loops[1], cubes.loops[2]);  // now the top comes first of the upper cube
    std::swap(cubes.cells[1], cubes.cells[2]);
    const ComplexView model = cubes.view();
    const FaceMeasures faces(model, FacesByCell(model, {1, nullptr}), {1, nullptr});
    EXPECT_EQ(faces[0].volume[0], 0);
    EXPECT_EQ(faces[1].volume[0], 0);
    EXPECT_DOUBLE_EQ(faces[2].volume[0], 1.0 / 3);  // above the base, and below the top
    EXPECT_DOUBLE_EQ(faces[2].volume[1], 1.0 / 3);
}

TEST(FaceMeasures, OfACellInsideOutAreNegative) {
    auto cubes = two_cubes();
    for (auto& loop : cubes.loops)
        std::reverse(loop.begin(), loop.end());
    EXPECT_EQ(volumes(cubes.view()), (std::vector<double>{-1, -1}));
}

TEST(FaceMeasures, RoundingIsWhatAStepOfEveryCornerSweeps) {
    auto cubes = two_cubes();
    const ComplexView model = cubes.view();
    const FaceMeasures faces(model, FacesByCell(model, {1, nullptr}), {1, nullptr});
    EXPECT_EQ(faces[0].rounding, 2 * 0x1p-52);  // an area of 1, heights up to 2
    EXPECT_EQ(faces[3].rounding, 0x1p-52);      // a wall along x, y up to 1
}

TEST(FaceMeasures, FaultsAreFoundUnderTheNumberOfTheFace) {
    auto cubes = two_cubes();
    cubes.loops[2] = {8, 9, 11, 10};
    const ComplexView model = cubes.view();
    FaceMeasures faces(model, FacesByCell(model, {1, nullptr}), {1, nullptr});
    EXPECT_EQ(faces.findings().examined, 11);
    ASSERT_EQ(faces.findings().failed, 1);
    EXPECT_EQ(faces.findings().first[0].text, "face 2 crosses itself");
    EXPECT_EQ(faces.findings().first[0].cell, 1);
    EXPECT_EQ(faces.findings().first[0].place, (std::array<double, 3>{0, 0, 2}));
}

}  // namespace
}  // namespace realmodel::validation
