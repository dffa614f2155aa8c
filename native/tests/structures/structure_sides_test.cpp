// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/structure_sides.hpp"

#include "faulted_cubes.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {
namespace {

TEST(StructureSides, FacesAndTheirRegionsAreOnTheSideOfTheirPlace) {
    FaultedCubes cut({FaultedCubes::upright(0.5)}, 1);
    EXPECT_EQ(cut.sides.compartments(), 2U);
    std::size_t count = 0;
    cut.each_region(false, [&](std::size_t r) {
        ++count;
        EXPECT_EQ(cut.sides.sides(cut.sides.compartment_of(r)),
                  Sides{cut.side(cut.inner(r)[0] > 0.5)});
    });
    EXPECT_GT(count, 0U);
    for (std::size_t f = 0; f < cut.model.face_count(); ++f) {
        if (cut.overlay.is_active(f)) continue;
        const std::int8_t side = cut.side(cut.model.vertex(cut.model.face(f)[0])[0] > 0.5);
        EXPECT_EQ(cut.sides.sides(cut.sides.compartment_of(cut.overlay.size() + f)), Sides{side});
    }
}

TEST(StructureSides, ARegionOfAFaultLiesBetweenItsTwoSides) {
    FaultedCubes cut({FaultedCubes::upright(0.5)}, 1);
    std::size_t count = 0;
    cut.each_region(true, [&](std::size_t r) {
        ++count;
        EXPECT_EQ(cut.sides.sides(cut.sides.compartment_at(r, 0)), Sides{-1});
        EXPECT_EQ(cut.sides.sides(cut.sides.compartment_at(r, 1)), Sides{1});
        ASSERT_EQ(cut.sides.structures_at(r).size(), 1U);
        EXPECT_EQ(cut.sides.structures_at(r)[0].structure, 0);
        EXPECT_TRUE(cut.sides.structures_at(r)[0].is_structure);
    });
    EXPECT_GT(count, 0U);
}

TEST(StructureSides, EachStructureHasASideOfItsOwn) {
    FaultedCubes cut({FaultedCubes::upright(0.5), strata::box({-1, -1, 1.5}, {0.25, 2, 3})}, 1);
    EXPECT_FALSE(cut.sides.is_body(0));
    EXPECT_TRUE(cut.sides.is_body(1));
    cut.each_region(false, [&](std::size_t r) {
        const Position p = cut.inner(r);
        const bool inside = p[0] < 0.25 && p[2] > 1.5;
        EXPECT_EQ(cut.sides.sides(cut.sides.compartment_of(r)),
                  (Sides{cut.side(p[0] > 0.5), cut.side(!inside)}));
    });
    // those beside the fault outside of the body, and the part within
    EXPECT_EQ(cut.sides.compartments(), 3U);
}

TEST(StructureSides, CellsAwayFromAllStructuresAreNotNear) {
    const FaultedCubes cut({strata::box({-1, -1, 1.5}, {0.25, 2, 3})}, 0);
    EXPECT_EQ(cut.sides.near_cells(), (std::vector<std::uint8_t>{0, 1}));
}

TEST(StructureSides, RefusesWithTheStructureAndAPlace) {
    FaultedCubes cut({FaultedCubes::upright(0.5)}, 1);
    cut.each_region(true, [&](std::size_t r) {
        try {
            cut.sides.refuse("ends_inside", "it ends", 0, r);
            FAIL();
        } catch (const InputError& error) {
            EXPECT_EQ(error.kind, "ends_inside");
            EXPECT_EQ(error.surface, 0);
            ASSERT_TRUE(error.place);
            EXPECT_DOUBLE_EQ((*error.place)[0], 0.5);
        }
    });
}

}  // namespace
}  // namespace realmodel::structures
