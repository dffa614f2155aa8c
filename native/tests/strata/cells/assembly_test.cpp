// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/assembly.hpp"

#include <gtest/gtest.h>

#include "../conform/small_faces.hpp"

namespace realmodel::strata {
namespace {

/// A triangle above a cell and one beneath it, as they are when they conform: of the lower one's
/// first edge a vertex is inserted, and another one was only tentative.
struct Conforming {
    SmallFaces small{{0, 1}};
    ConformedFaces conformed;
    std::vector<std::int32_t> surface_of_plane{8, 9};

    Conforming() {
        small.add(1, {0, 4, 1}, kOutsideCell, 0);
        small.add(0, {0, 4, 1}, 0, kOutsideCell);
        conformed.face_offsets = {0, 3, 7};
        conformed.vertices = {0, 1, 2, 3, -1, 4, 5};
        conformed.inserted = {{4, 6}};
        conformed.positions = {{0, 0, 1},   {1, 1.5, 1}, {0, 1, 1},     {0, 0, 0},
                               {1, 1.5, 0}, {0, 1, 0},   {0.5, 0.75, 0}};
    }
    CellComplex assembled(std::vector<WallBatch> walls = {}) {
        return assemble(small.faces, surface_of_plane, conformed, std::move(walls), {5},
                        {1, nullptr});
    }
    static std::vector<std::int32_t> face(const CellComplex& complex, std::size_t f) {
        return {complex.face_vertices.begin() + complex.face_offsets[f],
                complex.face_vertices.begin() + complex.face_offsets[f + 1]};
    }
};

TEST(Assembly, AFaceIsCounterClockwiseFromOutsideItsFirstCell) {
    const CellComplex complex = Conforming().assembled();
    ASSERT_EQ(complex.face_cells.size(), 2u);
    EXPECT_EQ(complex.face_cells[0], (std::array<std::int32_t, 2>{0, kOutsideCell}));
    EXPECT_EQ(Conforming::face(complex, 0), (std::vector<std::int32_t>{0, 1, 2}));
    // beneath the cell: seen from below
    EXPECT_EQ(complex.face_cells[1], (std::array<std::int32_t, 2>{0, kOutsideCell}));
    EXPECT_EQ(Conforming::face(complex, 1), (std::vector<std::int32_t>{5, 4, 6, 3}));
}

TEST(Assembly, TentativeVerticesAreLeftOutAndInsertedOnesFollowTheirEntry) {
    Conforming c;
    c.conformed.inserted = {{3, 6}};
    EXPECT_EQ(Conforming::face(c.assembled(), 1), (std::vector<std::int32_t>{5, 4, 6, 3}));
    c.conformed.inserted = {{6, 6}};
    EXPECT_EQ(Conforming::face(c.assembled(), 1), (std::vector<std::int32_t>{6, 5, 4, 3}));
    c.conformed.inserted = {};
    EXPECT_EQ(Conforming::face(c.assembled(), 1), (std::vector<std::int32_t>{5, 4, 3}));
}

TEST(Assembly, FacesNameTheSurfaceOfTheirPlaneAndCellsTheirBlock) {
    const CellComplex complex = Conforming().assembled();
    EXPECT_EQ(complex.face_surface, (Array<std::int32_t>{8, 9}));
    EXPECT_EQ(complex.cell_block, (Array<std::int32_t>{5}));
    EXPECT_EQ(complex.vertices.size(), 7u);
}

TEST(Assembly, WallsComeLastAndTurnToTheirCell) {
    WallBatch left{{4}, {0, 3, 5, 2}, {{0, -1}}}, right{{4, 3}, {0, 3, 4, 1, 1, 4, 2}, {}};
    right.cells = {{-1, 0}, {0, -1}};
    const CellComplex complex = Conforming().assembled({left, right});
    ASSERT_EQ(complex.face_cells.size(), 5u);
    EXPECT_EQ(Conforming::face(complex, 2), (std::vector<std::int32_t>{0, 3, 5, 2}));
    EXPECT_EQ(Conforming::face(complex, 3), (std::vector<std::int32_t>{1, 4, 3, 0}));
    EXPECT_EQ(Conforming::face(complex, 4), (std::vector<std::int32_t>{1, 4, 2}));
    for (std::size_t f = 2; f < 5; ++f) {
        EXPECT_EQ(complex.face_surface[f], kWall);
        EXPECT_EQ(complex.face_cells[f], (std::array<std::int32_t, 2>{0, kOutsideCell}));
    }
}

}  // namespace
}  // namespace realmodel::strata
