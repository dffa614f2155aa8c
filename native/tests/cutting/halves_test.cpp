// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../arrangement/small_polygons.hpp"
#include "../validation/small_complex.hpp"
#include "cutting/assembly.hpp"
#include "cutting/near_model.hpp"

namespace realmodel::cutting {
namespace {

/// Two cubes, one on the other, each in a half of its own: their faces are the pieces.
class TwoCubesApart : public testing::Test {
protected:
    explicit TwoCubesApart(std::array<std::int8_t, 2> sides = {kBelow, kAbove}) {
        for (std::int32_t f = 0; f < 11; ++f) {
            const auto& loop = cubes.loops[index(f)];
            const auto [first, second] = cubes.cells[index(f)];
            pieces.add(NodeLoop(loop.begin(), loop.end()),
                       {f,
                        {first, second},
                        {sides[index(first)], second < 0 ? kOn : sides[index(second)]},
                        f == 1,
                        {first, second}});
        }
        half_cells = {{0, sides[0]}, {1, sides[1]}};
    }
    Cut halves() {
        return assemble_halves(model, {}, WholePieces(CutPieces(pieces)), half_cells, {1, nullptr});
    }
    static std::vector<std::int32_t> face(const CellComplex& c, std::size_t f) {
        return {c.face_vertices.begin() + c.face_offsets[f],
                c.face_vertices.begin() + c.face_offsets[f + 1]};
    }

    validation::OwnedComplex cubes = validation::two_cubes();
    const ComplexView model = cubes.view();
    CutPieces pieces;
    std::vector<HalfCell> half_cells;
};

class TwoCubesUpsideDown : public TwoCubesApart {
protected:
    TwoCubesUpsideDown() : TwoCubesApart({kAbove, kBelow}) {}
};

TEST_F(TwoCubesApart, EachHalfHasItsCellItsFacesAndItsVolume) {
    const Cut cut = halves();
    EXPECT_EQ(cut.below.vertices.size(), 8U);
    EXPECT_EQ(cut.above.vertices.size(), 8U);
    EXPECT_EQ(cut.below.face_cells.size(), 6U);
    EXPECT_EQ(cut.above.face_cells.size(), 6U);
    EXPECT_EQ(cut.below_cells, std::vector<std::int32_t>{0});
    EXPECT_EQ(cut.above_cells, std::vector<std::int32_t>{1});
    EXPECT_EQ(cut.above.cell_block[0], 1);
    EXPECT_EQ(cut.below.volumes, (std::vector<double>{1, 0}));
    EXPECT_EQ(cut.above.volumes, (std::vector<double>{0, 1}));
}

TEST_F(TwoCubesApart, OnlyWhatTheyHadBetweenThemIsACutFace) {
    const Cut cut = halves();
    EXPECT_EQ(std::vector(cut.below.face_surface.begin(), cut.below.face_surface.end()),
              (std::vector<std::int32_t>{kBase, kCutFace, kWall, kWall, kWall, kWall}));
    EXPECT_EQ(std::vector(cut.above.face_surface.begin(), cut.above.face_surface.end()),
              (std::vector<std::int32_t>{kCutFace, 1, kWall, kWall, kWall, kWall}));
}

TEST_F(TwoCubesApart, AFaceTurnsOverForTheCellThatWasItsSecond) {
    const Cut cut = halves();
    EXPECT_EQ(cut.above.face_cells[0], (std::array<std::int32_t, 2>{0, -1}));
    std::vector<Position> corners;
    for (const std::int32_t v : face(cut.above, 0))
        corners.push_back(cut.above.vertices[index(v)]);
    EXPECT_EQ(polygon_normal(corners), (Position{0, 0, -2}));
}

TEST_F(TwoCubesApart, TheSectionIsSeenFromAbove) {
    const Section section = assemble_section(model, {}, pieces);
    EXPECT_EQ(section.cells, (std::vector<std::array<std::int32_t, 2>>{{0, 1}}));
    ASSERT_EQ(section.vertices.size(), 4U);
    EXPECT_EQ(polygon_normal(section.vertices), (Position{0, 0, 2}));
}

TEST_F(TwoCubesUpsideDown, TheSectionIsSeenFromTheHalfAbove) {
    const Section section = assemble_section(model, {}, pieces);
    EXPECT_EQ(section.cells, (std::vector<std::array<std::int32_t, 2>>{{1, 0}}));
    std::vector<Position> corners;
    for (const std::int32_t v : section.polygon_vertices)
        corners.push_back(section.vertices[index(v)]);
    EXPECT_EQ(polygon_normal(corners), (Position{0, 0, -2}));
}

TEST_F(TwoCubesApart, NodesAfterTheVerticesAreTheNewPositions) {
    pieces.polygons.nodes[8] = NodeId{12};  // a corner of the top
    const Cut cut = assemble_halves(model, {{0, 0, 3}}, WholePieces(CutPieces(pieces)), half_cells,
                                    {1, nullptr});
    EXPECT_EQ(std::ranges::count(cut.above.vertices, Position{0, 0, 3}), 1);
    EXPECT_EQ(std::ranges::count(cut.below.vertices, Position{0, 0, 3}), 0);
}

TEST_F(TwoCubesApart, APieceOfNoPartIsLeftOut) {
    pieces[2].parts = {-1, -1};
    EXPECT_EQ(halves().above.face_cells.size(), 5U);
}

}  // namespace
}  // namespace realmodel::cutting
