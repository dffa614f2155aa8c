// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/clean_cells.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::simulation {
namespace {

/// Boxes of 10 by 6, one above another, that share faces; each has a block of its own.
struct Tower {
    std::vector<double> vertices;
    std::vector<std::int64_t> offsets{0};
    std::vector<std::int32_t> corners, cells, surface, block;
    ComplexView view;

    explicit Tower(const std::vector<double>& heights) {
        const auto layers = static_cast<std::int32_t>(heights.size()) - 1;
        for (const double z : heights)
            vertices.insert(vertices.end(), {0, 0, z, 10, 0, z, 10, 6, z, 0, 6, z});
        add({3, 2, 1, 0}, 0, -1, -2);
        for (std::int32_t k = 0; k < layers; ++k) {
            const std::int32_t a = 4 * k, b = a + 4;
            for (std::int32_t i = 0; i < 4; ++i)
                add({a + i, a + (i + 1) % 4, b + (i + 1) % 4, b + i}, k, -1, -1);
            add({b, b + 1, b + 2, b + 3}, k, k + 1 < layers ? k + 1 : -1, k);
            block.push_back(k);
        }
        view = {.vertices = vertices,
                .face_offsets = offsets,
                .face_vertices = corners,
                .face_cells = cells,
                .face_surface = surface,
                .cell_block = block,
                .blocks = block.size(),
                .surfaces = layers};
    }
    void add(const std::array<std::int32_t, 4>& loop, std::int32_t first, std::int32_t second,
             std::int32_t on) {
        corners.insert(corners.end(), loop.begin(), loop.end());
        offsets.push_back(static_cast<std::int64_t>(corners.size()));
        cells.insert(cells.end(), {first, second});
        surface.push_back(on);
    }
    CleanedCells cleaned(double tolerance, const std::vector<std::int32_t>& kinds = {}) const {
        return clean_cells(view, kinds, tolerance, {1, nullptr});
    }
};

TEST(CleanCellsTest, AThinLayerVanishesAndItsNeighborsMeet) {
    const CleanedCells made = Tower({0, 5, 5.01, 9}).cleaned(0.02);
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
    const CleanedCells made = Tower({0, 5, 5.01}).cleaned(0.02);
    ASSERT_EQ(made.after.cells, 1u);
    EXPECT_NEAR(made.complex.volumes[0], 5.01 * 60, 1e-9);
    const ComplexView view = made.complex;
    for (std::size_t f = 0; f < view.face_count(); ++f)
        EXPECT_NE(view.face_surface[f], 0);  // what was between the two layers is gone
}

TEST(CleanCellsTest, AFaultKeepsItsNumberWhereALayerVanishes) {
    const CleanedCells made = Tower({0, 5, 5.01, 9}).cleaned(0.02, {1, 0, 0});
    ASSERT_EQ(made.after.cells, 2u);
    const ComplexView view = made.complex;
    for (std::size_t f = 0; f < view.face_count(); ++f) {
        if (view.cell(f, 1) >= 0) {
            EXPECT_EQ(view.face_surface[f], 0);
        }
    }
}

TEST(CleanCellsTest, CellsThickerThanTheToleranceStay) {
    const Tower tower({0, 5, 5.01, 9});
    const CleanedCells made = tower.cleaned(0.005);
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
        EXPECT_THROW(tower.cleaned(0.1), InputError);
    }
}

}  // namespace
}  // namespace realmodel::simulation
