// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/structures/merge_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "../strata/complex_checks.hpp"
#include "../validation/small_complex.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/strata/cell_volumes.hpp"

namespace realmodel::structures {
namespace {

/// Of columns, or parts of them, that are valid by themselves.
double volume(const CellComplex& c) {
    strata::expect_valid(c);
    double sum = 0;
    for (const double own : strata::cell_volumes(c.vertices, c.face_offsets, c.face_vertices,
                                                 c.face_cells, c.cell_block.size()))
        sum += own;
    return sum;
}

/// Three layers over one square, two columns each.
CellComplex layers() {
    std::vector<strata::OwnedSurface> surfaces;
    for (const double z : {0.0, 1.0, 3.0, 6.0})
        surfaces.push_back(strata::grid(1, 1, 0, 0, 1, 1, [z](double, double) { return z; }));
    return strata::build(surfaces);
}

TEST(MergeCells, WithTheirOwnNumbersCellsStayAsTheyAre) {
    const CellComplex all = layers();
    std::vector<std::int32_t> number(all.cell_block.size());
    for (std::size_t c = 0; c < number.size(); ++c)
        number[c] = static_cast<std::int32_t>(c);
    const CellComplex merged = merge_cells(all, number);
    EXPECT_TRUE(std::ranges::equal(merged.vertices, all.vertices));
    EXPECT_TRUE(std::ranges::equal(merged.face_offsets, all.face_offsets));
    EXPECT_TRUE(std::ranges::equal(merged.face_vertices, all.face_vertices));
    EXPECT_TRUE(std::ranges::equal(merged.face_cells, all.face_cells));
    EXPECT_TRUE(std::ranges::equal(merged.face_surface, all.face_surface));
    EXPECT_TRUE(std::ranges::equal(merged.cell_block, all.cell_block));
}

TEST(MergeCells, WithoutTheOthersEachBlockIsClosed) {
    const CellComplex all = layers();
    for (const std::int32_t kept : {1, 2, 3}) {
        std::vector<std::int32_t> number;
        std::int32_t next = 0;
        for (const std::int32_t block : all.cell_block)
            number.push_back(block == kept ? next++ : -1);
        const CellComplex merged = merge_cells(all, number);
        EXPECT_DOUBLE_EQ(volume(merged), kept);
        EXPECT_EQ(merged.cell_block.size(), 2U);
        EXPECT_EQ(merged.vertices.size(), 8U);
        EXPECT_TRUE(std::ranges::all_of(merged.cell_block, [&](auto b) { return b == kept; }));
    }
}

TEST(MergeCells, CellsOfOneNumberAreOne) {
    const CellComplex all = layers();
    const CellComplex merged = merge_cells(all, std::vector<std::int32_t>(6, 0));
    EXPECT_DOUBLE_EQ(volume(merged), 6);
    EXPECT_EQ(merged.cell_block.size(), 1U);
    EXPECT_EQ(merged.cell_block[0], all.cell_block[0]);
    EXPECT_EQ(merged.vertices.size(), all.vertices.size());  // walls go on through all layers
    for (const auto& cells : merged.face_cells)
        EXPECT_EQ(cells, (std::array{0, -1}));
}

TEST(MergeCells, WithoutAllCellsNothingIsLeft) {
    const CellComplex merged = merge_cells(layers(), std::vector<std::int32_t>(6, -1));
    EXPECT_TRUE(merged.cell_block.empty());
    EXPECT_TRUE(merged.vertices.empty());
    EXPECT_EQ(merged.face_offsets.size(), 1U);
}

TEST(MergeCells, OtherNumbersAreRefused) {
    const auto kind = [](const ComplexView& complex, const std::vector<std::int32_t>& number) {
        try {
            merge_cells(complex, number);
        } catch (const InputError& error) {
            return error.kind;
        }
        return std::string();
    };
    const CellComplex all = layers();
    EXPECT_EQ(kind(all, {0, 1, 2, 3, 4}), "bad_index");
    EXPECT_EQ(kind(all, {0, 2, 1, 3, 4, 5}), "bad_index");  // not in order
    EXPECT_EQ(kind(all, {0, 1, 2, 3, 4, -2}), "bad_index");
    ComplexView cut_off = all;
    cut_off.face_surface = cut_off.face_surface.first(3);
    EXPECT_EQ(kind(cut_off, {0, 1, 2, 3, 4, 5}), "bad_model");
}

}  // namespace
}  // namespace realmodel::structures
