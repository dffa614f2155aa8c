// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/structure_cutter.hpp"

#include "faulted_cubes.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {
namespace {

strata::OwnedSurface upright(double low, double high, double end = 9) {
    strata::OwnedSurface s;
    for (const double z : {low, high}) {
        for (const double y : {-9.0, end})
            s.vertex(0.5, y, z);
    }
    s.triangle(0, 1, 3);
    s.triangle(0, 3, 2);
    return s;
}

StructureCutter cutter_of(const strata::OwnedSurface& fault, bool dies_out = false) {
    const std::vector<strata::OwnedSurface> surfaces{fault};
    auto structures = FaultedCubes::structures_of(surfaces, 1);
    structures[0].dies_out = dies_out;
    return structure_cutter(structures, FaultedCubes::around());
}

std::size_t continuations(const StructureCutter& s) {
    return static_cast<std::size_t>(std::ranges::count(s.is_continuation, 1));
}

/// Whether a surface has a triangle beyond a height, or a y.
bool reaches(const StructureCutter& s, std::size_t axis, double value) {
    return std::ranges::any_of(s.combined.vertices,
                               [&](const Position& p) { return p[axis] >= value; });
}

TEST(StructureCutter, WhatDividesTheRockIsNotContinued) {
    const StructureCutter s = cutter_of(upright(-9, 9));
    EXPECT_EQ(continuations(s), 0U);
    EXPECT_EQ(s.structure, (std::vector<std::int32_t>{0, 0}));
    EXPECT_EQ(s.single.size(), 1U);
}

TEST(StructureCutter, AFaultThatEndsAtAHeightIsContinuedStraightUp) {
    const StructureCutter s = cutter_of(upright(-9, 1));
    EXPECT_GT(continuations(s), 0U);
    EXPECT_TRUE(reaches(s, 2, 2));  // above the rock
    for (const Position& p : s.combined.vertices)
        EXPECT_EQ(p[0], 0.5);
}

TEST(StructureCutter, AFaultThatEndsAsideIsContinuedInItsPlane) {
    const StructureCutter s = cutter_of(upright(-9, 9, 0.5));
    EXPECT_GT(continuations(s), 0U);
    EXPECT_TRUE(reaches(s, 1, 1));
    for (const Position& p : s.combined.vertices)
        EXPECT_EQ(p[0], 0.5);
}

TEST(StructureCutter, AnOpenBodyIsRefusedWithAPlace) {
    const std::vector<strata::OwnedSurface> surfaces{upright(-9, 9)};
    const auto structures = FaultedCubes::structures_of(surfaces, 0);
    try {
        structure_cutter(structures, FaultedCubes::around());
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "not_closed");
        EXPECT_TRUE(e.place.has_value());
    }
}

}  // namespace
}  // namespace realmodel::structures
