// SPDX-License-Identifier: GPL-3.0-or-later
#include "faulted_cubes.hpp"
#include "realmodel/base/errors.hpp"
#include "structures/structure_cutter.hpp"

namespace realmodel::structures {
namespace {

/// The rectangle y = 0.5 between two values of x, far beyond the cubes in height.
strata::OwnedSurface across(double from, double to) {
    strata::OwnedSurface s;
    for (const double z : {-9, 9}) {
        for (const double x : {from, to})
            s.vertex(x, 0.5, z);
    }
    s.triangle(0, 1, 3);
    s.triangle(0, 3, 2);
    return s;
}

StructureCutter with_branch(const strata::OwnedSurface& branch) {
    const std::vector<strata::OwnedSurface> surfaces{FaultedCubes::upright(0.5), branch};
    auto structures = FaultedCubes::structures_of(surfaces, 2);
    structures[1].ends_at = {0};
    return structure_cutter(structures, FaultedCubes::around());
}

TEST(BranchSides, AreTheAreasOnBothSidesOfTheOther) {
    const BranchSides sides = branch_sides(with_branch(across(-2, 1)), 1, 0);
    EXPECT_TRUE(sides.meets);
    EXPECT_DOUBLE_EQ(std::max(sides.above, sides.below), 5 * std::min(sides.above, sides.below));
}

TEST(BranchSides, TheLargerPartIsKept) {
    const StructureCutter left = with_branch(across(-2, 1)), right = with_branch(across(0, 3));
    EXPECT_EQ(larger_side(left, 1, 0), -larger_side(right, 1, 0));
    const BranchSides sides = branch_sides(left, 1, 0);
    EXPECT_EQ(larger_side(left, 1, 0), sides.above > sides.below ? 1 : -1);
}

TEST(BranchSides, ABranchThatDoesNotMeetTheOtherIsRefused) {
    try {
        larger_side(with_branch(across(2, 3)), 1, 0);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(e.kind, "does_not_meet");
        EXPECT_EQ(e.surface, 1);
    }
}

TEST(BranchSides, ABranchThatIsCutInHalvesIsRefused) {
    for (const double beyond : {0.0, 1e-12}) {
        try {
            larger_side(with_branch(across(-1.5, 2.5 + beyond)), 1, 0);
            FAIL();
        } catch (const InputError& e) {
            EXPECT_EQ(e.kind, "equal_halves");
            EXPECT_EQ(e.surface, 1);
            EXPECT_EQ(e.items, std::vector<std::int64_t>{0});
        }
    }
}

}  // namespace
}  // namespace realmodel::structures
