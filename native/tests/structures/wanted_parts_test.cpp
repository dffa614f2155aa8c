// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/wanted_parts.hpp"

#include "faulted_cubes.hpp"

namespace realmodel::structures {
namespace {

using cutting::kAbove;
using cutting::kOn;

/// The cubes with a fault at x = 0.5, as cells of models.
struct Wanted : FaultedCubes {
    Wanted(std::vector<std::int32_t> models, std::vector<Sides> sides_of_models, std::uint8_t act)
        : FaultedCubes({upright(0.5)}, 1),
          model_of_cell(std::move(models)),
          model_sides(std::move(sides_of_models)),
          acts(model.blocks, act) {}

    std::vector<std::int32_t> model_of_cell;
    std::vector<Sides> model_sides;
    std::vector<std::uint8_t> acts;
    WantedParts wanted{overlay, winding, sides, model_of_cell, model_sides, acts};
};

TEST(WantedParts, OfACellItIsWhatLiesInThePartOfItsModel) {
    Wanted cut({0, 1}, {{-1}, {1}}, 1);
    cut.each_region(false, [&](std::size_t r) {
        const bool is_lower = cut.model.cell(cut.overlay.face_of(r), 0) == 0;
        EXPECT_EQ(cut.wanted.of_region(r, cut.overlay.face_of(r)),
                  (cut.inner(r)[0] < 0.5) == is_lower ? kAbove : kOn);
    });
    cut.each_region(true, [&](std::size_t r) {
        const std::int32_t cell = cut.inner(r)[2] < 1 ? 0 : 1;
        EXPECT_EQ(cut.wanted.of_cut_face(r, 0, cell), cell == 0 ? kAbove : kOn);
        EXPECT_EQ(cut.wanted.of_cut_face(r, 1, cell), cell == 0 ? kOn : kAbove);
        EXPECT_TRUE(cut.wanted.separates(r));
    });
}

TEST(WantedParts, ACapIsOnTheStructureThatActs) {
    Wanted cut({0, 0}, {{0}}, 1);
    cut.each_region(true, [&](std::size_t r) {
        const std::int32_t cell = cut.inner(r)[2] < 1 ? 0 : 1;
        EXPECT_TRUE(cut.wanted.separates(r));
        EXPECT_FALSE(cut.wanted.ends_at_outer_face(r, cell));
        EXPECT_EQ(WantedParts::surface_of_cut_face(cut.wanted.cut_face_number(r, cell, cell)),
                  cut.model.surfaces);
    });
}

TEST(WantedParts, WhereNothingActsBothSidesAreOneCell) {
    Wanted cut({0, 0}, {{0}}, 0);
    std::size_t count = 0;
    cut.each_region(true, [&](std::size_t r) {
        ++count;
        EXPECT_FALSE(cut.wanted.separates(r));
        const std::int32_t cell = cut.inner(r)[2] < 1 ? 0 : 1;
        EXPECT_EQ(WantedParts::surface_of_cut_face(cut.wanted.cut_face_number(r, cell, cell)),
                  kWall);
    });
    EXPECT_GT(count, 0U);
}

TEST(WantedParts, OfModelsThatAreInOnePartTheFirstCounts) {
    Wanted cut({0, 1}, {{0}, {-1}}, 1);
    cut.each_region(false, [&](std::size_t r) {
        const bool is_lower = cut.model.cell(cut.overlay.face_of(r), 0) == 0;
        EXPECT_EQ(cut.wanted.of_region(r, cut.overlay.face_of(r)), is_lower ? kAbove : kOn);
    });
}

}  // namespace
}  // namespace realmodel::structures
