// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::cutting {
namespace {

// a square with a corner in the middle of one side, and a triangle beside
const std::vector<double> kVertices = {0, 0, 5, 1, 0, 5, 2, 0, 5, 2, 2, 5, 0, 2, 5, 4, 1, 5};
const std::vector<std::int64_t> kOffsets = {0, 5, 8};
const std::vector<std::int32_t> kCorners = {0, 1, 2, 3, 4, 2, 5, 3};

TEST(FaceTriangles, AFaceWithCornersInOneLineHasTrianglesOfPositiveArea) {
    const FaceTriangles found = triangulate_faces(kVertices, kOffsets, kCorners, {1, nullptr});
    EXPECT_EQ(found.offsets, (std::vector<std::int64_t>{0, 3, 4}));
    double area = 0;
    for (const auto& t : found.triangles) {
        const auto at = [&](int k, int axis) {
            return kVertices[static_cast<std::size_t>(3 * t[static_cast<std::size_t>(k)] + axis)];
        };
        const double twice = (at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) -
                             (at(1, 1) - at(0, 1)) * (at(2, 0) - at(0, 0));
        EXPECT_GT(twice, 0);
        area += twice / 2;
    }
    EXPECT_EQ(area, 4 + 2);
}

TEST(FaceTriangles, CornersThatDoNotExistAreRefused) {
    std::vector<std::int32_t> corners = kCorners;
    corners[6] = 6;
    EXPECT_THROW(triangulate_faces(kVertices, kOffsets, corners, {1, nullptr}), InputError);
    const std::vector<std::int64_t> offsets = {0, 5, 9};
    EXPECT_THROW(triangulate_faces(kVertices, offsets, kCorners, {1, nullptr}), InputError);
    EXPECT_TRUE(triangulate_faces(kVertices, {}, kCorners, {1, nullptr}).triangles.empty());
}

}  // namespace
}  // namespace realmodel::cutting
