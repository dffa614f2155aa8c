// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/clean_cells.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "realmodel/base/errors.hpp"
#include "towers.hpp"

namespace realmodel::simulation {
namespace {

CleanedCells cleaned(const Tower& tower, double tolerance,
                     const std::vector<std::int32_t>& kinds = {}) {
    return clean_cells(tower.view, kinds, tolerance, {1, nullptr});
}

TEST(CleanCellsTest, AThinLayerVanishesAndItsNeighborsMeet) {
    const CleanedCells made = cleaned(Tower({0, 5, 5.01, 9}), 0.02);
    EXPECT_EQ(made.before.cells, 3u);
    EXPECT_EQ(made.after.cells, 2u);
    EXPECT_EQ(made.after.faces, 11u);
    EXPECT_EQ(made.after.edges, 20u);
    EXPECT_EQ(made.complex.vertices.size(), 12u);
    EXPECT_EQ(made.cell_origin[0], 0);
    EXPECT_EQ(made.cell_origin[1], 2);
    EXPECT_EQ(made.short_edges, 0u);
    EXPECT_NEAR(made.largest_move, 0.01, 1e-12);
    EXPECT_DOUBLE_EQ(made.complex.volumes[1], 0);
    EXPECT_NEAR(made.complex.volumes[0] + made.complex.volumes[2], 540, 1e-9);
    EXPECT_NEAR(made.volumes_before[1], 0.6, 1e-9);
}

TEST(CleanCellsTest, AThinLayerOnTopTakesNothingFromTheModel) {
    const CleanedCells made = cleaned(Tower({0, 5, 5.01}), 0.02);
    ASSERT_EQ(made.after.cells, 1u);
    EXPECT_NEAR(made.complex.volumes[0], 5.01 * 60, 1e-9);
    const ComplexView view = made.complex;
    for (std::size_t f = 0; f < view.face_count(); ++f)
        EXPECT_NE(view.face_surface[f], 0);  // what was between the two layers is gone
}

TEST(CleanCellsTest, AFaultKeepsItsNumberWhereALayerVanishes) {
    const CleanedCells made = cleaned(Tower({0, 5, 5.01, 9}), 0.02, {1, 0, 0});
    ASSERT_EQ(made.after.cells, 2u);
    const ComplexView view = made.complex;
    for (std::size_t f = 0; f < view.face_count(); ++f) {
        if (view.cell(f, 1) >= 0) {
            EXPECT_EQ(view.face_surface[f], 0);
        }
    }
}

TEST(CleanCellsTest, OfNothingNothingIsLeft) {
    const std::vector<std::int64_t> offsets{0};
    ComplexView nothing{};
    nothing.face_offsets = offsets;
    const CleanedCells made = clean_cells(nothing, {}, 0.1, {1, nullptr});
    EXPECT_EQ(made.after.cells, 0u);
    EXPECT_EQ(made.largest_move, 0);
}

TEST(CleanCellsTest, CellsThickerThanTheToleranceStay) {
    const Tower tower({0, 5, 5.01, 9});
    const CleanedCells made = cleaned(tower, 0.005);
    EXPECT_EQ(made.after.edges, made.before.edges);
    EXPECT_EQ(made.largest_move, 0);
}

TEST(CleanCellsTest, NumbersOfWhatIsNotThereAreRefused) {
    for (const auto& spoil :
         {+[](Tower& t) { t.corners[3] = 99; }, +[](Tower& t) { t.cells[0] = 7; },
          +[](Tower& t) { t.cells[0] = -1; }, +[](Tower& t) { t.block[0] = 5; },
          +[](Tower& t) { t.offsets[1] = 900; }}) {
        Tower tower({0, 5, 9});
        spoil(tower);
        EXPECT_THROW(cleaned(tower, 0.1), InputError);
    }
}

}  // namespace
}  // namespace realmodel::simulation
