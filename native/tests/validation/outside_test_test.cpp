// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/outside_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

/// Two cubes that do not know of each other: the face between them is there for each.
OwnedComplex cubes_apart() {
    auto cubes = two_cubes();
    cubes.cells[1] = {0, -1};
    cubes.add_face({6, 5, 4, 7}, 1, -1, 0);
    return cubes;
}

TEST(OutsideTest, FacesBetweenTwoCellsAreNoOutside) {
    auto cubes = two_cubes();
    const Findings found = check_outside(cubes.view(), {1, nullptr});
    EXPECT_EQ(found.examined, 10);
    EXPECT_TRUE(found.passed());
}

TEST(OutsideTest, AFaceStoredTwiceIsFoundWhateverItsFirstCornerAndDirection) {
    auto cubes = cubes_apart();
    for (int turn = 0; turn < 4; ++turn) {
        const Findings found = check_outside(cubes.view(), {1, nullptr});
        ASSERT_EQ(found.failed, 1);
        EXPECT_EQ(found.first[0].text,
                  "face 11 has one cell, but face 1 of cell 0 lies at the same position");
        EXPECT_EQ(found.first[0].face, 11);
        EXPECT_EQ(found.first[0].cell, 1);
        std::rotate(cubes.loops[11].begin(), cubes.loops[11].begin() + 1, cubes.loops[11].end());
    }
    std::ranges::reverse(cubes.loops[11]);
    EXPECT_EQ(check_outside(cubes.view(), {1, nullptr}).failed, 1);
}

TEST(OutsideTest, FacesThatDifferInOneCornerAreTwo) {
    auto cubes = cubes_apart();
    cubes.vertices.push_back({0.5, 0.5, 1});
    cubes.loops[11] = {6, 5, 4, 12};
    EXPECT_TRUE(check_outside(cubes.view(), {1, nullptr}).passed());
    cubes.loops[11] = {6, 5, 4, 7, 12};
    EXPECT_TRUE(check_outside(cubes.view(), {1, nullptr}).passed());
}

}  // namespace
}  // namespace realmodel::validation
