// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/cell_components.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::strata {
namespace {

using Sides = std::array<std::int32_t, 2>;

TEST(CellComponents, AreCellsOfOneBlockThatShareFaces) {
    // 0 - 1 and 2 - 3 in one block, 4 of another one between 1 and 2
    const std::vector<Sides> faces{{0, 1}, {1, 4}, {4, 2}, {3, 2}, {0, -1}};
    const std::vector<std::int32_t> block{5, 5, 5, 5, 6};
    EXPECT_EQ(cell_components(faces, block, nullptr), (std::vector<std::int32_t>{0, 0, 2, 2, 4}));
}

TEST(CellComponents, AreNamedAfterTheirLowestCell) {
    const std::vector<Sides> faces{{3, 2}, {2, 1}, {1, 0}};
    EXPECT_EQ(cell_components(faces, std::vector<std::int32_t>(4, 0), nullptr),
              std::vector<std::int32_t>(4, 0));
}

TEST(CellComponents, RefuseCellsThatAreNotThere) {
    const std::vector<Sides> beyond{{0, -1}, {0, 2}};
    const std::vector<std::int32_t> block{0, 0};
    for (const auto& call :
         {+[](const std::vector<Sides>&faces, const std::vector<std::int32_t>&blocks) {
              cell_components(faces, blocks, nullptr);
          },
          +[](const std::vector<Sides>&faces, const std::vector<std::int32_t>&blocks) {
              faces_of_cells(faces, blocks.size(), nullptr);
          }}) {
        try {
            call(beyond, block);
            FAIL() << "accepted";
        } catch (const InputError& error) {
            EXPECT_EQ(error.kind, "bad_index");
            EXPECT_EQ(error.items, (std::vector<std::int64_t>{1}));
        }
    }
}

TEST(CellFaces, AreTheSidesOfFacesInOrder) {
    const std::vector<Sides> faces{{1, 0}, {0, -1}, {1, -1}};
    const CellFaces sides = faces_of_cells(faces, 2, nullptr);
    const auto same = [](const auto& found, const std::vector<std::uint32_t>& expected) {
        return std::ranges::equal(found, expected);
    };
    EXPECT_TRUE(same(sides.offsets, {0, 2, 4}));
    // a side is twice its face, and one more where the cell is the face's second
    EXPECT_TRUE(same(sides.faces, {1, 2, 0, 4}));
}

}  // namespace
}  // namespace realmodel::strata
